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
from artigen.datasets.usd_shapes import read_gprim
from artigen.errors import SourceError
from artigen.files.urdf import UrdfJoint
from artigen.transforms import inverse, shift

if TYPE_CHECKING:
    from pxr import Usd

SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
WORLD = "/"
"""Path of what belongs to no rigid body."""
SHAPES = ("Mesh", "Cube", "Sphere", "Cylinder", "Capsule", "Cone")
KINDS = {
    "PhysicsFixedJoint": "fixed",
    "PhysicsRevoluteJoint": "revolute",
    "PhysicsPrismaticJoint": "prismatic",
}
PHYSX_MIMIC = re.compile(r"(physxMimicJoint:\w+):referenceJoint")


@dataclass(frozen=True, kw_only=True, eq=False)
class _Edge:
    """A joint between two bodies, by path; the frame of the joint on each of them in the world."""

    path: str
    type: str
    bodies: tuple[str, str]
    T_world_joint: tuple[Float[np.ndarray, "4 4"], Float[np.ndarray, "4 4"]]
    axis: Float[np.ndarray, "3"]
    """In the frame of the joint on the first body."""
    limits: tuple[float, float]
    mimic: tuple[str, float, float] | None
    """Path of the leader, factor and offset."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Stage:
    """What a stage holds: shapes by body, joints, and numbers of what is not used."""

    path: Path
    stage: "Usd.Stage"
    """Keeps the prims valid."""
    T_zup_stage: Float[np.ndarray, "4 4"]
    shapes: dict[str, list["Usd.Prim"]]
    edges: tuple[_Edge, ...]
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
        raise SourceError(f"{path}: has no object {body!r}, expected one of {', '.join(objects)}")
    bodies = objects[chosen]
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
            shapes.setdefault(_body_of(prim), []).append(prim)
        elif "Light" in kind or kind in ("Camera", "PointInstancer", "BasisCurves", "Points", "Volume"):
            unused[{"BasisCurves": "curves"}.get(kind, f"{kind} prims")] += 1
    _, _, missing = UsdUtils.ComputeAllDependencies(str(path))
    notes = (
        []
        if UsdGeom.StageHasAuthoredMetersPerUnit(stage)
        else [f"no unit is stated: lengths are {metres:g} m"]
    )
    notes += [f"files that are missing: {', '.join(map(str, missing))}"] if missing else []
    edges = tuple(edge for prim in joints if (edge := _read_joint(prim, T, unused)) is not None)
    return _Stage(
        path=path, stage=stage, T_zup_stage=T, shapes=shapes, edges=edges, unused=unused, notes=notes
    )


def _body_of(prim: "Usd.Prim") -> str:
    """Path of the rigid body that a prim belongs to."""
    from pxr import UsdPhysics

    while prim and not prim.IsPseudoRoot():
        enabled = prim.GetAttribute("physics:rigidBodyEnabled").Get()
        if prim.HasAPI(UsdPhysics.RigidBodyAPI) and enabled is not False:
            return str(prim.GetPath())
        prim = prim.GetParent()
    return WORLD


def _world_pose(prim: "Usd.Prim") -> Float[np.ndarray, "4 4"]:
    """The map from a prim's coordinates to those of the stage."""
    from pxr import Usd, UsdGeom

    return np.array(UsdGeom.XformCache(Usd.TimeCode.Default()).GetLocalToWorldTransform(prim)).T


def _read_joint(prim: "Usd.Prim", T_zup_stage: np.ndarray, unused: Counter[str]) -> _Edge | None:
    """A joint; None and a count for one that binds nothing, or only keeps a distance."""
    from pxr import UsdPhysics

    joint, stage = UsdPhysics.Joint(prim), prim.GetStage()
    kind = prim.GetTypeName()
    if kind == "PhysicsDistanceJoint":
        unused["distance joints"] += 1
        return None
    bodies, frames = [], []
    for number, said in enumerate((joint.GetBody0Rel(), joint.GetBody1Rel())):
        targets = said.GetForwardedTargets()
        target = stage.GetPrimAtPath(targets[0]) if targets else stage.GetPseudoRoot()
        if not target:
            unused["joints of bodies that are not there"] += 1
            return None
        position = prim.GetAttribute(f"physics:localPos{number}").Get()
        turn = prim.GetAttribute(f"physics:localRot{number}").Get()
        w, (x, y, z) = turn.GetReal(), turn.GetImaginary()
        frames.append(
            _joint_frame(T_zup_stage @ _world_pose(target), np.array(position), np.array([w, x, y, z]))
        )
        bodies.append(_body_of(target))
    if bodies[0] == bodies[1]:
        unused["joints within one body"] += 1
        return None
    axis = (
        np.eye(3)["XYZ".index(prim.GetAttribute("physics:axis").Get() or "X")]
        if kind in KINDS
        else np.zeros(3)
    )
    unit = np.pi / 180.0 if kind == "PhysicsRevoluteJoint" else float(np.linalg.norm(T_zup_stage[:3, 0]))
    limits = (-np.inf, np.inf)
    if kind in ("PhysicsRevoluteJoint", "PhysicsPrismaticJoint"):
        low, high = (unit * prim.GetAttribute(f"physics:{side}Limit").Get() for side in ("lower", "upper"))
        limits = (float(low), float(high))
    return _Edge(
        path=str(prim.GetPath()),
        type=KINDS.get(kind, kind),
        bodies=(bodies[0], bodies[1]),
        T_world_joint=(frames[0], frames[1]),
        axis=axis,
        limits=limits,
        mimic=_read_mimic(prim),
    )


def _joint_frame(T: np.ndarray, position: np.ndarray, quat: np.ndarray) -> Float[np.ndarray, "4 4"]:
    """Rigid frame of a joint in the world, on a body whose map to the world may scale."""
    from artigen.transforms import matrix_from_quat

    frame = np.eye(4)
    lengths = np.linalg.norm(T[:3, :3], axis=0)
    frame[:3, :3] = (T[:3, :3] / lengths) @ matrix_from_quat(quat[None] / np.linalg.norm(quat))[0]
    frame[:3, 3] = T[:3, :3] @ position + T[:3, 3]
    return frame


def _read_mimic(prim: "Usd.Prim") -> tuple[str, float, float] | None:
    """The joint that a joint follows, factor and offset (rad, m), as MuJoCo or PhysX state it."""
    target = prim.GetRelationship("mjc:target")
    if target and target.GetTargets():
        values = [prim.GetAttribute(f"mjc:coef{k}").Get() for k in (0, 1)]
        return (
            str(target.GetTargets()[0]),
            float(1.0 if values[1] is None else values[1]),
            float(values[0] or 0.0),
        )
    for said in prim.GetRelationships():
        found = PHYSX_MIMIC.fullmatch(said.GetName())
        if found is None or not said.GetTargets():
            continue
        leader = prim.GetStage().GetPrimAtPath(said.GetTargets()[0])
        own, other = ("Revolute" in (one.GetTypeName() if one else "") for one in (prim, leader))
        degree = np.pi / 180.0
        gearing, offset = (
            prim.GetAttribute(f"{found[1]}:{name}").Get() or 0.0 for name in ("gearing", "offset")
        )
        factor = -gearing * (degree if own else 1.0) / (degree if other else 1.0)
        return str(said.GetTargets()[0]), float(factor), float(-offset * (degree if own else 1.0))
    return None


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


def _span(stage: _Stage, bodies: set[str]) -> list[tuple[_Edge, bool]]:
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


def _build(stage: _Stage, name: str, bodies: set[str], edges: list[tuple[_Edge, bool]]) -> Mechanism:
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
    joints = [_fix(links[root], links[body]) for body in still]
    for edge, back in edges:
        parent, child = edge.bodies[::-1] if back else edge.bodies
        origins[child] = edge.T_world_joint[0][:3, 3]
        joint = _make_joint(edge, names, stage.path, back=back)
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
            pieces = tuple(read_gprim(prim, stage.T_zup_stage @ _world_pose(prim)))
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


def _fix(parent: str, child: str) -> UrdfJoint:
    return UrdfJoint(
        name=f"{child}_fixed",
        type="fixed",
        parent=parent,
        child=child,
        T_parent_joint=np.eye(4),
        axis=np.array([1.0, 0.0, 0.0]),
        lower=None,
        upper=None,
        mimic=None,
        mimic_multiplier=1.0,
        mimic_offset=0.0,
    )


def _make_joint(edge: _Edge, names: dict[str, str], path: Path, *, back: bool) -> UrdfJoint:
    """The joint with a coordinate that is 0 where the stage has it; parent, child and place are still open.

    Raises:
        SourceError: If the joint is neither fixed, revolute nor prismatic, or slides without limits.
    """
    joint = replace(_fix("", ""), name=names[edge.path], type=edge.type)
    if edge.type == "fixed":
        return joint
    if edge.type not in KINDS.values():
        allowed = ", ".join(KINDS)
        raise SourceError(f"{path}: joint {edge.path} is a {edge.type}, expected one of {allowed}")
    first, second = edge.T_world_joint
    between, sign = inverse(first) @ second, -1.0 if back else 1.0
    if edge.type == "prismatic":
        value = float(between[:3, 3] @ edge.axis)
    else:
        k = int(np.argmax(edge.axis))
        i, j = (k + 1) % 3, (k + 2) % 3
        value = float(np.arctan2(between[j, i] - between[i, j], between[i, i] + between[j, j]))
    lower, upper = (end - value for end in edge.limits)
    endless = not np.isfinite([lower, upper]).all()
    mimic = edge.mimic if edge.mimic is not None and edge.mimic[0] in names else None
    if edge.type == "prismatic" and endless and mimic is None:
        raise SourceError(
            f"{path}: joint {edge.path} slides without limits, expected physics:lowerLimit and upperLimit"
        )
    joint = replace(
        joint,
        type="continuous" if endless and edge.type == "revolute" else edge.type,
        axis=sign * first[:3, :3] @ edge.axis,
        lower=None if endless else lower,
        upper=None if endless else upper,
    )
    if mimic is None:
        return joint
    leader, factor, offset = mimic
    return replace(joint, mimic=names[leader], mimic_multiplier=factor, mimic_offset=offset)
