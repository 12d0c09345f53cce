"""Reads OpenUSD stages with UsdPhysics: rigid bodies, joints with their limits, meshes and materials.

Bodies that joints connect are an object; what is still and connected to nothing is the scene around it. All
is turned to z up and scaled to metres. Joints stand where the stage has them, and are at 0 there.
"""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

import re
from collections import Counter, deque
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.datasets.mechanism import Mechanism, Solid, make_mechanism, say_dropped, unique_names
from artigen.datasets.usd_joints import (
    WORLD,
    Edge,
    body_of,
    make_joint,
    read_joint,
    world_pose,
)
from artigen.datasets.usd_shapes import read_gprim
from artigen.errors import SourceError, name_options
from artigen.files.urdf import weld
from artigen.transforms import shift

if TYPE_CHECKING:
    from pxr import Usd

SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
MOST = 5_000
"""A stage with more joints or shapes is a fault of a script."""
SHAPES = ("Mesh", "Cube", "Sphere", "Cylinder", "Capsule", "Cone")


@dataclass(frozen=True, kw_only=True, eq=False)
class _Stage:
    """What a stage holds: shapes by body, joints, and numbers of what is not used."""

    path: Path
    stage: "Usd.Stage"
    """Keeps the prims valid."""
    T_zup_stage: Float[np.ndarray, "4 4"]
    shapes: dict[str, list["Usd.Prim"]]
    edges: tuple[Edge, ...]
    unused: Counter[str]
    notes: list[str] = field(default_factory=list)


def list_usd_objects(path: Path) -> tuple[str, ...]:
    """Names of the objects in a stage that holds several; none where it holds one.

    Raises:
        SourceError: If the stage cannot be opened.
    """
    names = tuple(_find_objects(_open(path)))
    return names if len(names) > 1 else ()


def read_usd(path: Path, body: str | None = None) -> Mechanism:
    """Reads one object of a stage.

    Args:
        body: Name of the object, or path of a prim in it; None where the stage holds one object.

    Raises:
        SourceError: If usd-core is not installed, the stage cannot be opened, it holds several objects, or a
            part hangs from a joint that is neither fixed, revolute nor prismatic.
    """
    stage = _open(path)
    objects = _find_objects(stage)
    if body is None and len(objects) > 1:
        raise SourceError(
            f"{path}: holds {len(objects)} objects ({', '.join(objects)}), expected one: "
            "choose it with --body NAME"
        )
    chosen = next((name for name, paths in objects.items() if body in (None, name) or body in paths), None)
    if chosen is None:
        raise SourceError(f"{path}: has no object {body!r}, expected {name_options(str(body), objects)}")
    bodies = objects[chosen]
    if not bodies:
        raise SourceError(f"{path}: holds neither shapes nor joints, expected an object")
    edges = _span(stage, bodies)
    try:
        return _build(stage, chosen, bodies, edges)
    except ValueError as err:
        raise SourceError(f"{path}: {err}") from err


def _open(path: Path) -> _Stage:
    try:
        from pxr import Tf, Usd, UsdGeom, UsdPhysics, UsdUtils
    except ImportError as err:
        raise SourceError(f"{path}: OpenUSD needs the package usd-core: pip install 'artigen[usd]'") from err
    try:
        stage = Usd.Stage.Open(str(path))
    except Tf.ErrorException as err:
        at = re.search(r":(\d+):\d+: ", str(err))
        where = f" in line {at[1]}" if at else ""
        raise SourceError(f"{path}: OpenUSD cannot open it: missing, or no valid stage{where}") from err
    metres = UsdGeom.GetStageMetersPerUnit(stage)
    T = np.diag([metres, metres, metres, 1.0])
    if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y:
        T = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]) @ T
    shapes: dict[str, list[Usd.Prim]] = {}
    unused: Counter[str] = Counter()
    joints: list[Usd.Prim] = []
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        kind = prim.GetTypeName()
        if prim.IsA(UsdPhysics.Joint):
            enabled = prim.GetAttribute("physics:jointEnabled").Get()
            unused["disabled joints"] += enabled is False
            joints += [prim] if enabled is not False else []
        elif kind in SHAPES:
            shapes.setdefault(body_of(prim), []).append(prim)
        elif "Light" in kind or kind in ("Camera", "PointInstancer", "BasisCurves", "Points", "Volume"):
            unused[{"BasisCurves": "curves"}.get(kind, f"{kind} prims")] += 1
    count = sum(map(len, shapes.values()))
    if max(count, len(joints)) > MOST:
        raise SourceError(
            f"{path}: holds {len(joints):,} joints and {count:,} shapes, at most {MOST:,} of each are read"
        )
    _, _, missing = UsdUtils.ComputeAllDependencies(str(path))
    notes = (
        []
        if UsdGeom.StageHasAuthoredMetersPerUnit(stage)
        else [f"no unit is stated: lengths are {metres:g} m"]
    )
    notes += [f"files that are missing: {', '.join(map(str, missing))}"] if missing else []
    edges = tuple(edge for prim in joints if (edge := read_joint(prim, T, unused)) is not None)
    return _Stage(
        path=path, stage=stage, T_zup_stage=T, shapes=shapes, edges=edges, unused=unused, notes=notes
    )


def _find_objects(stage: _Stage) -> dict[str, set[str]]:
    """Bodies of each object by its name: those that joints connect, without the world unless something moves
    against it; all shapes where nothing moves."""
    moving = [edge for edge in stage.edges if edge.type != "fixed"]
    framed = any(WORLD in edge.bodies for edge in moving) and WORLD in stage.shapes
    groups: list[set[str]] = []
    for edge in stage.edges:
        ends = {end for end in edge.bodies if end != WORLD or (framed and edge.type != "fixed")}
        touching = [group for group in groups if group & ends]
        groups = [group for group in groups if group not in touching]
        groups.append(ends.union(*touching))
    alive = [
        group
        for group in groups
        if any(set(edge.bodies) <= group | {WORLD} and set(edge.bodies) & group for edge in moving)
    ]
    if not alive:
        alive = [set(stage.shapes) | {end for edge in stage.edges for end in edge.bodies if end != WORLD}]
    names = unique_names((_common_name(group) for group in alive), "object")
    return dict(zip(names, alive, strict=True))


def _common_name(bodies: Iterable[str]) -> str:
    """Name of the prim that holds all bodies, or of the only one."""
    split = [body.strip("/").split("/") for body in bodies if body != WORLD]
    shared = []
    for names in zip(*split, strict=False):
        if len(set(names)) > 1:
            break
        shared.append(names[0])
    return shared[-1] if shared else "world"


def _span(stage: _Stage, bodies: set[str]) -> list[tuple[Edge, bool]]:
    """Joints from the root outwards, parents first, each with whether it is taken backwards.

    The root is the world, else a body that is fixed to it, else one that is the root of an articulation, else
    the body from which most joints lead away.
    """
    edges = [edge for edge in stage.edges if set(edge.bodies) <= bodies]
    held = [end for edge in stage.edges if WORLD in edge.bodies for end in edge.bodies if end in bodies]
    leads = Counter(edge.bodies[0] for edge in edges)
    leads.subtract(Counter(edge.bodies[1] for edge in edges))
    rooted = [body for body in bodies if _is_articulation_root(stage.stage.GetPrimAtPath(body))]
    ranked = sorted(
        bodies, key=lambda body: (body != WORLD, body not in held, body not in rooted, -leads[body], body)
    )
    order, seen, waiting = [], {ranked[0]}, deque([ranked[0]])
    while waiting:
        at = waiting.popleft()
        for edge in edges:
            if at in edge.bodies and not set(edge.bodies) <= seen:
                other = edge.bodies[1] if edge.bodies[0] == at else edge.bodies[0]
                order.append((edge, edge.bodies[1] == at))
                seen.add(other)
                waiting.append(other)
    stage.unused["joints that close a loop"] += len(edges) - len(order)
    return order


def _is_articulation_root(prim: "Usd.Prim") -> bool:
    from pxr import UsdPhysics

    return bool(prim) and prim.HasAPI(UsdPhysics.ArticulationRootAPI)


def _build(stage: _Stage, name: str, bodies: set[str], edges: list[tuple[Edge, bool]]) -> Mechanism:
    reached = [edge.bodies[0] if back else edge.bodies[1] for edge, back in edges]
    root = next(iter(bodies - set(reached))) if edges else min(bodies)
    still = sorted(bodies - {root, *reached})  # no joint leads there
    order = [root, *still, *reached]
    links = dict(
        zip(order, unique_names((body.rpartition("/")[2] or "world" for body in order), "body"), strict=True)
    )
    titles = unique_names((edge.path.rpartition("/")[2] for edge, _ in edges), "joint")
    names = dict(zip((edge.path for edge, _ in edges), titles, strict=True))
    origins = {root: np.zeros(3), **dict.fromkeys(still, np.zeros(3))}
    joints = [weld(f"{links[body]}_fixed", links[root], links[body]) for body in still]
    for edge, back in edges:
        parent, child = edge.bodies[::-1] if back else edge.bodies
        origins[child] = edge.T_world_joint[0][:3, 3]
        joint = make_joint(edge, names, stage.path, back=back)
        joints.append(
            replace(
                joint,
                parent=links[parent],
                child=links[child],
                T_parent_joint=shift(origins[child] - origins[parent]),
            )
        )
    drawn, solid = [], []
    for body in order:
        shown = [prim for prim in stage.shapes.get(body, ()) if _is_drawn(prim)]
        for prim in stage.shapes.get(body, ()):
            pieces = tuple(read_gprim(prim, stage.T_zup_stage @ world_pose(prim)))
            shape = Solid(
                link=links[body], name=prim.GetName(), T_link_shape=shift(-origins[body]), pieces=pieces
            )
            (drawn if prim in shown else solid).append(shape)
    around = [body for body in stage.shapes if body not in bodies]
    left = (
        [f"around {name!r} in the stage, left out: {', '.join(_name_scene(around, stage))}"] if around else []
    )
    stage.unused["collision shapes"] = len(solid)
    return make_mechanism(
        stage.path,
        name,
        links.values(),
        joints,
        visuals=drawn,
        collisions=solid,
        notes=(*stage.notes, *left, *say_dropped(stage.unused)),
    )


def _name_scene(bodies: list[str], stage: _Stage) -> list[str]:
    loose = [body.rpartition("/")[2] for body in bodies if body != WORLD]
    return [*loose, *(prim.GetName() for prim in stage.shapes.get(WORLD, ()) if WORLD in bodies)][:12]


def _is_drawn(prim: "Usd.Prim") -> bool:
    """Whether a renderer shows a shape."""
    from pxr import UsdGeom

    image = UsdGeom.Imageable(prim)
    visible = image.ComputeVisibility() != UsdGeom.Tokens.invisible
    return visible and image.ComputePurpose() in (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)
