"""Reads MJCF as MuJoCo compiles it: poses of the world, defaults, includes, meshes, colours and constraints.

Masses are not read, so that a file without them is as good. Links have the axes of the world, in which an
object stands as the file stands it. What is drawn is decided for each moving link (`find_drawn`).
"""

# mujoco is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

import math
import re
import warnings
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import numpy as np
from jaxtyping import Float

from artigen.datasets.mechanism import Mechanism, Solid, make_mechanism, say_dropped, shift_zero, unique_names
from artigen.datasets.mjcf_geoms import find_drawn, geom_pose, read_geom
from artigen.datasets.mjcf_repair import repair
from artigen.datasets.mjcf_scene import choose_object, list_roots, name_root
from artigen.errors import SourceError
from artigen.files.safe_xml import read_xml
from artigen.files.urdf import UrdfJoint, weld
from artigen.transforms import shift
from artigen.types import FULL_TURN

if TYPE_CHECKING:
    import mujoco

STATED = re.compile(r"""<compiler\b[^>]*\bangle\s*=""")
"""A compiler element that states the unit of angles."""
INCLUDED = re.compile(r"""<include\b[^>]*\bfile\s*=\s*["']([^"']+)["']""")
EULER = re.compile(r"""\beuler\s*=\s*["']([-+.\deE\s]+)["']""")
ROUND = 1e-3
COPIES = re.compile(r"""<(?:replicate|composite|flexcomp)\b[^>]*?\bcount\s*=\s*["']([\d\s]+)["']""")
MOST_COPIES = 1_000_000
MOST_REPAIRS = 50
MOST = 5_000
"""A file with more bodies or geoms is a fault of a script."""
HANDLE = "handle_"
"""Names of sites that packages place at their handles begin so."""
LEAST_MASS = 1e-3
LEAST_INERTIA = 1e-6
"""Mass (kg) and inertia (kg m^2) with which a body without them compiles."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Link:
    """Link of the mechanism: its name and the place of its origin in the world."""

    name: str
    origin: Float[np.ndarray, "3"]


@dataclass(frozen=True, kw_only=True)
class _Coupling:
    """``q = factor * q_leader + offset``; without a leader, ``q`` is ``offset``."""

    leader: str | None
    factor: float
    offset: float


def is_mjcf(path: Path) -> bool:
    """Whether a file is XML with the root element ``mujoco``."""
    if path.suffix.lower() not in (".xml", ".mjcf"):
        return False
    from defusedxml.ElementTree import iterparse

    try:
        return next(iterparse(path, events=("start",)))[1].tag == "mujoco"
    except (ET.ParseError, ValueError, StopIteration, OSError):
        return False


def list_mjcf_objects(path: Path) -> tuple[str, ...]:
    """Names of the bodies that are objects of their own in a file with several; none in a file with one.

    Raises:
        SourceError: If MuJoCo cannot compile the file.
    """
    model, _ = compile_mjcf(path, outline=True)
    roots = list_roots(model)
    return tuple(name_root(model, root) for root in roots) if len(roots) > 1 else ()


def read_mjcf(path: Path, body: str | None = None) -> Mechanism:
    """Reads one object of an MJCF.

    Bodies keep their names; a body with several joints becomes several links.

    Args:
        body: The body that is the object, with all that hangs from it; None where the file holds one object.

    Raises:
        SourceError: If MuJoCo cannot compile the file, it holds several objects, a slide has no range, or a
            body has a ball joint or, inside the tree, a free one.
    """
    import mujoco

    model, notes = compile_mjcf(path)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    chosen = choose_object(model, path, body)
    drawn, spare = find_drawn(model, data, chosen.geoms)
    root, *others = chosen.bodies
    bodies = unique_names((model.body(index).name for index in range(model.nbody)), "body")
    names = unique_names((model.joint(index).name for index in range(model.njnt)), "joint")
    couplings, unused = _list_couplings(model, names)
    links = {root: _Link(name=bodies[root], origin=np.array(data.xpos[root]))}
    made, joints = [bodies[root]], list[UrdfJoint]()
    notes += [
        f"joint {names[move]!r} moves the whole object; it is fixed where it stands"
        for move in _joints_of(model, root)
    ]
    for index in others:
        at, moves = links[int(model.body_parentid[index])], _list_joints(model, index, path)
        inner = [f"{bodies[index]}_{number}" for number in range(len(moves) - 1)]
        for name, move in zip([*inner, bodies[index]], moves or [None], strict=True):
            link = unique_names([*bodies, *made, name], "link")[-1] if name in inner else name
            origin = at.origin if move is None else np.array(data.xanchor[move])
            joint = _make_joint(model, data, move, link, names)
            joint = replace(joint, parent=at.name, T_parent_joint=shift(origin - at.origin))
            joints.append(_couple(joint, couplings.get(joint.name), path))
            made.append(link)
            at = _Link(name=link, origin=origin)
        links[index] = at
    solids = []
    for geom in drawn:
        link, mesh = links[int(model.geom_bodyid[geom])], read_geom(model, geom)
        spare["height fields"] += mesh is None
        T_link_shape = shift(-link.origin) @ geom_pose(data, geom)
        name = model.geom(geom).name
        if mesh is not None:
            solids.append(Solid(link=link.name, name=name, T_link_shape=T_link_shape, pieces=(mesh,)))
    return make_mechanism(
        path,
        path.stem,
        made,
        _keep_leaders(joints),
        visuals=solids,
        notes=(*chosen.notes, *notes, *say_dropped({**spare, **unused, **_count_rest(model)})),
    )


def compile_mjcf(path: Path, *, outline: bool = False) -> tuple["mujoco.MjModel", list[str]]:
    """The model of a file, whatever its masses, the orientation of its meshes and missing images; and notes.

    Args:
        outline: Compile balls in place of meshes, without images: bodies, joints and colours stay.

    Raises:
        SourceError: If MuJoCo cannot compile the file.
    """
    import mujoco

    _check_text(path)
    try:
        return _compile(mujoco.MjSpec.from_file(str(path)), path, outline=outline)
    except (ValueError, mujoco.FatalError) as err:
        error = err
    root, notes = read_xml(path)[0], list[str]()
    while len(notes) < MOST_REPAIRS and (said := repair(root, " ".join(str(error).split()))):
        notes.append(said)
        try:
            spec = mujoco.MjSpec.from_string(ET.tostring(root, "unicode"), include=_read_includes(path))
            spec.modelfiledir = str(path.parent.absolute())
            model, more = _compile(spec, path, outline=outline)
        except (ValueError, mujoco.FatalError) as err:
            error = err
        else:
            return model, [*notes, *more]
    said = " ".join(str(error).split())
    raise SourceError(f"{path}: MuJoCo cannot read it: {said}") from error


def _check_count(bodies: int, geoms: int, path: Path) -> None:
    if max(bodies, geoms) > MOST:
        raise SourceError(
            f"{path}: holds {bodies:,} bodies and {geoms:,} geoms, at most {MOST:,} of each are read"
        )


def _check_text(path: Path) -> None:
    """Refuses what would take MuJoCo minutes to parse, or to multiply."""
    text = path.read_text(errors="replace")
    _check_count(text.count("<body"), text.count("<geom"), path)
    copies = math.prod(int(number) for counts in COPIES.findall(text) for number in counts.split())
    if copies > MOST_COPIES:
        raise SourceError(f"{path}: asks for {copies:,} copies of elements, at most {MOST_COPIES:,} are made")


def _read_includes(path: Path) -> dict[str, bytes]:
    """Files that a file includes, directly or through others, by name."""
    found: dict[str, bytes] = {}
    waiting = [path]
    while waiting:
        for name in INCLUDED.findall(waiting.pop().read_text(errors="replace")):
            file = path.parent / name
            if name not in found and file.is_file():
                found[name] = file.read_bytes()
                waiting.append(file)
    return found


def _compile(spec: "mujoco.MjSpec", path: Path, *, outline: bool) -> tuple["mujoco.MjModel", list[str]]:
    import mujoco

    _check_count(len(spec.bodies), len(spec.geoms), path)
    spec.compiler.boundmass = max(spec.compiler.boundmass, LEAST_MASS)
    spec.compiler.boundinertia = max(spec.compiler.boundinertia, LEAST_INERTIA)
    spec.compiler.balanceinertia = True
    spec.compiler.discardvisual = spec.compiler.fusestatic = False
    for mesh in spec.meshes:
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    notes = [*_replace_images(spec, path), *_guess_angles(spec, path), *_keep_ranges(spec)]
    if outline:
        _outline(spec)
    with warnings.catch_warnings():  # of masses, which are not used
        warnings.simplefilter("ignore", UserWarning)
        return spec.compile(), notes


def _outline(spec: "mujoco.MjSpec") -> None:
    """Puts balls in the place of meshes and plain colours in that of images."""
    import mujoco

    for geom in spec.geoms:
        if geom.meshname:
            geom.type, geom.meshname, geom.size = mujoco.mjtGeom.mjGEOM_SPHERE, "", np.full(3, 0.01)
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    spare = (*spec.sensors, *spec.actuators, *spec.tendons, *spec.equalities, *spec.keys, *spec.sites)
    for element in (*spare, *spec.skins, *spec.meshes, *spec.textures):
        spec.delete(element)


def _replace_images(spec: "mujoco.MjSpec", path: Path) -> list[str]:
    """Makes textures white whose images are missing, and says so."""
    import mujoco

    folder = path.parent / (spec.compiler.texturedir or "")
    missing = []
    for texture in spec.textures:
        name = Path(texture.file).name if spec.strippath else texture.file
        if texture.file and not (folder / name).is_file() and name not in spec.assets:
            missing.append(texture.file)
            texture.file, texture.builtin = "", mujoco.mjtBuiltin.mjBUILTIN_FLAT
            texture.rgb1, texture.width, texture.height = np.ones(3), 1, 1
    return [f"images that are missing, plain colours instead: {', '.join(missing)}"] if missing else []


def _keep_ranges(spec: "mujoco.MjSpec") -> list[str]:
    """Limits joints to the ranges that they state, also where they say that these do not count: a part that
    needs no limit in its scene, since it meets what is around it, needs one in a package."""
    import mujoco

    moving = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
    free = mujoco.mjtLimited.mjLIMITED_FALSE
    kept = [
        joint
        for joint in spec.joints
        if joint.type in moving and joint.limited == free and joint.range[0] < joint.range[1]
    ]
    for joint in kept:
        joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
    names = ", ".join(repr(joint.name) for joint in kept)
    return [f"joints that state ranges without being limited keep to them: {names}"] if kept else []


def _guess_angles(spec: "mujoco.MjSpec", path: Path) -> list[str]:
    """Takes angles for radians where the file leaves their unit open and no hinge would turn by more than
    a full turn in radians: files that are parts of a scene rely on its settings."""
    import mujoco

    hinges = [joint.range for joint in spec.joints if joint.type == mujoco.mjtJoint.mjJNT_HINGE]
    largest = max((float(np.abs(limits).max()) for limits in hinges), default=0.0)
    texts = [path.read_text(errors="replace")]
    if not spec.compiler.degree or not 0.0 < largest <= FULL_TURN + ROUND or STATED.search(texts[0]):
        return []
    for name in INCLUDED.findall(texts[0]):
        file = path.parent / name
        if file.is_file() and STATED.search(file.read_text(errors="replace")):
            return []
    if any(abs(float(word)) > FULL_TURN for text in EULER.findall(texts[0]) for word in text.split()):
        return []
    spec.compiler.degree = False
    return [f"angles are read as radians: in degrees, no hinge would turn by more than {largest:.3g} degrees"]


def _joints_of(model: "mujoco.MjModel", body: int) -> range:
    """Joints of a body, in the order in which they move it."""
    first = int(model.body_jntadr[body])
    return range(first, first + int(model.body_jntnum[body]))


def _list_joints(model: "mujoco.MjModel", body: int, path: Path) -> list[int]:
    """Hinges and slides of a body."""
    import mujoco

    allowed = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    joints = list(_joints_of(model, body))
    if any(model.jnt_type[joint] not in allowed for joint in joints):
        raise SourceError(
            f"{path}: body {name_root(model, body)!r} has a free or ball joint, expected hinges and slides"
        )
    return joints


def _make_joint(
    model: "mujoco.MjModel", data: "mujoco.MjData", move: int | None, link: str, names: list[str]
) -> UrdfJoint:
    """The joint that moves a link, or fixes it; parent and place are still those of the root."""
    import mujoco

    joint = weld(f"{link}_fixed", child=link)
    if move is None:
        return joint
    turns, limited = model.jnt_type[move] == mujoco.mjtJoint.mjJNT_HINGE, bool(model.jnt_limited[move])
    kind = "prismatic" if not turns else "revolute" if limited else "continuous"
    # The pose of the file is that at the reference coordinate.
    low, high = model.jnt_range[move] - model.qpos0[model.jnt_qposadr[move]] if limited else (None, None)
    joint = replace(joint, name=names[move], type=kind, axis=np.array(data.xaxis[move]))
    return replace(
        joint, lower=None if low is None else float(low), upper=None if high is None else float(high)
    )


def _list_couplings(model: "mujoco.MjModel", names: list[str]) -> tuple[dict[str, _Coupling], dict[str, int]]:
    """The first active equality in proportion of every joint, and the numbers of all other constraints."""
    import mujoco

    found: dict[str, _Coupling] = {}
    dropped, idle = Counter[str](), 0
    for row in range(model.neq):
        kind, active = mujoco.mjtEq(int(model.eq_type[row])), bool(model.eq_active0[row])
        one, other = int(model.eq_obj1id[row]), int(model.eq_obj2id[row])
        offset, factor, *higher = (float(value) for value in model.eq_data[row][:5])
        if not active:
            idle += 1
        elif kind != mujoco.mjtEq.mjEQ_JOINT:
            dropped[f"{kind.name.removeprefix('mjEQ_').lower()} equalities"] += 1
        elif (other >= 0 and any(higher)) or names[one] in found:
            dropped["joint equalities that are no proportion"] += 1
        else:
            still = other < 0 or factor == 0.0
            found[names[one]] = _Coupling(
                leader=None if still else names[other], factor=factor, offset=offset
            )
    return found, {**dropped, "inactive equalities": idle}


def _couple(joint: UrdfJoint, coupling: _Coupling | None, path: Path) -> UrdfJoint:
    """The joint as follower, or fixed where an equality holds it.

    Raises:
        SourceError: If a joint slides without end.
    """
    if joint.type == "prismatic" and joint.lower is None and coupling is None:
        raise SourceError(
            f'{path}: joint {joint.name!r} slides without limits, expected a range, such as "0 0.3"'
        )
    if coupling is None:
        return joint
    if coupling.leader is None:
        return replace(shift_zero(joint, coupling.offset), type="fixed")
    return replace(
        joint, mimic=coupling.leader, mimic_multiplier=coupling.factor, mimic_offset=coupling.offset
    )


def _keep_leaders(joints: list[UrdfJoint]) -> list[UrdfJoint]:
    """The joints without mimics of joints that another object has."""
    names = {joint.name for joint in joints}
    return [joint if joint.mimic in names else replace(joint, mimic=None) for joint in joints]


def _count_rest(model: "mujoco.MjModel") -> dict[str, int]:
    """Numbers of elements of the file that no package has; sites of handles are placed anew."""
    return {
        "actuators": model.nu,
        "sensors": model.nsensor,
        "tendons": model.ntendon,
        "sites": sum(not model.site(at).name.startswith(HANDLE) for at in range(model.nsite)),
        "cameras": model.ncam,
        "lights": model.nlight,
        "skins": model.nskin,
        "flexes": model.nflex,
        "keyframes": model.nkey,
    }
