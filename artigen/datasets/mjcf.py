"""Reads MJCF (MuJoCo, RoboCasa) by way of a URDF with the same links, joints and visible geometry.

MuJoCo compiles the file, so that defaults, includes and mesh formats mean what they mean there. Masses are
not read, so that a file without them is as good. Visible are the geoms that MuJoCo renders by default (groups
0 to 2), without the groups of collision shapes: those in which all geoms collide, where other groups do not.
"""

# mujoco is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import numpy as np
from jaxtyping import Float

from artigen.errors import SourceError
from artigen.transforms import inverse, matrix_from_quat, rpy_from_matrix

if TYPE_CHECKING:
    import mujoco
    from trimesh import Trimesh

VISIBLE_GROUPS = 3
"""Groups that MuJoCo's viewer shows, from 0."""
PLAIN = (0.5, 0.5, 0.5, 1.0)
"""Colour of a geom that states none; its material's counts then."""
SECTIONS = 48
LEAST_MASS = 1e-3
LEAST_INERTIA = 1e-6
"""Mass (kg) and inertia (kg m^2) with which a body without them compiles."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Frame:
    """A link of the URDF: the body that it is and where its frame lies in that of the body."""

    name: str
    T_body_link: Float[np.ndarray, "4 4"]


def is_mjcf(path: Path) -> bool:
    """Whether a file is XML with the root element ``mujoco``."""
    if path.suffix.lower() not in (".xml", ".mjcf"):
        return False
    from defusedxml.ElementTree import iterparse

    try:
        return next(iterparse(path, events=("start",)))[1].tag == "mujoco"
    except (ET.ParseError, ValueError, StopIteration, OSError):
        return False


def write_urdf(path: Path, scratch: Path) -> Path:
    """Writes a URDF with the links, joints and visible geometry of an MJCF into ``scratch``.

    Bodies keep their names; a body with several joints becomes several links. A body without joint and
    without geometry is left out, and what hangs from it hangs from its parent.

    Raises:
        SourceError: If MuJoCo cannot compile the file, a slide has no range, or a body has a ball joint or,
            inside the tree, a free one.
    """
    model = _compile(path)
    folder = scratch / f"{path.stem}_urdf"
    folder.mkdir(parents=True, exist_ok=True)
    robot = ET.Element("robot", name=path.stem)
    geoms = _visible_geoms(model)
    frames: dict[int, _Frame] = {}
    root = _find_root(model, geoms)
    for body in range(root, model.nbody):
        above = _nearest(model, frames, body)
        if body != root and above is None:
            continue
        moves = [] if body == root else _list_joints(model, body, path)
        if body != root and not moves and not geoms.get(body):
            continue
        frames[body] = _add_links(robot, model, body, above, frames, moves, path)
        link = next(one for one in robot.iter("link") if one.get("name") == frames[body].name)
        for number, geom in enumerate(geoms.get(body, ())):
            file = folder / f"geom_{geom}.glb"
            if _write_geom(model, geom, file):
                visual = ET.SubElement(link, "visual", name=_name(model, "geom", geom, f"visual_{number}"))
                T_body_geom = _pose(model.geom_pos[geom], model.geom_quat[geom])
                _add_origin(visual, inverse(frames[body].T_body_link) @ T_body_geom)
                ET.SubElement(ET.SubElement(visual, "geometry"), "mesh", filename=file.name)
    target = folder / f"{path.stem}.urdf"
    ET.ElementTree(robot).write(target)
    return target


def _compile(path: Path) -> "mujoco.MjModel":
    """The model of a file, whatever its masses.

    Raises:
        SourceError: If MuJoCo cannot compile the file.
    """
    import mujoco

    try:
        spec = mujoco.MjSpec.from_file(str(path))
        spec.compiler.boundmass = max(spec.compiler.boundmass, LEAST_MASS)
        spec.compiler.boundinertia = max(spec.compiler.boundinertia, LEAST_INERTIA)
        spec.compiler.balanceinertia = True
        return spec.compile()
    except ValueError as err:
        raise SourceError(f"{path}: MuJoCo cannot read it: {err}") from err


def _visible_geoms(model: "mujoco.MjModel") -> dict[int, list[int]]:
    """Geoms that are rendered, by body."""
    import mujoco

    shown = (
        (np.asarray(model.geom_group) < VISIBLE_GROUPS)
        & (np.asarray(model.geom_rgba)[:, 3] > 0)
        & (np.asarray(model.geom_type) != int(mujoco.mjtGeom.mjGEOM_PLANE))
    )
    silent = (np.asarray(model.geom_contype) == 0) & (np.asarray(model.geom_conaffinity) == 0)
    groups = np.asarray(model.geom_group)
    drawn = set(groups[shown & silent].tolist())
    if drawn:
        shown &= np.isin(groups, list(drawn))
    found: dict[int, list[int]] = {}
    for geom in np.flatnonzero(shown).tolist():
        found.setdefault(int(model.geom_bodyid[geom]), []).append(geom)
    return found


def _find_root(model: "mujoco.MjModel", geoms: dict[int, list[int]]) -> int:
    """The body that carries all others: the world if it is drawn or carries several, else the first drawn."""
    import mujoco

    at = 0
    while not geoms.get(at):
        below = [body for body in range(at + 1, model.nbody) if model.body_parentid[body] == at]
        types = [int(model.jnt_type[joint]) for joint in _joints_of(model, below[0])] if below else []
        if len(below) != 1 or any(kind != int(mujoco.mjtJoint.mjJNT_FREE) for kind in types):
            break
        at = below[0]
    return at


def _joints_of(model: "mujoco.MjModel", body: int) -> range:
    """Joints of a body, in the order in which they move it."""
    first = int(model.body_jntadr[body])
    return range(first, first + int(model.body_jntnum[body]))


def _nearest(model: "mujoco.MjModel", frames: dict[int, _Frame], body: int) -> int | None:
    """The nearest ancestor that is a link."""
    at = body
    while at != 0:
        at = int(model.body_parentid[at])
        if at in frames:
            return at
    return None


def _list_joints(model: "mujoco.MjModel", body: int, path: Path) -> list[int]:
    """Hinges and slides of a body."""
    import mujoco

    allowed = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    joints = list(_joints_of(model, body))
    if any(model.jnt_type[joint] not in allowed for joint in joints):
        name = _name(model, "body", body, f"body_{body}")
        raise SourceError(f"{path}: body {name!r} has a free or ball joint, expected hinges and slides")
    return joints


def _add_links(
    robot: ET.Element,
    model: "mujoco.MjModel",
    body: int,
    above: int | None,
    frames: dict[int, _Frame],
    moves: list[int],
    path: Path,
) -> _Frame:
    """Adds the links of a body, one per joint, and their joints; returns the last.

    The root link has the axes of the world, so that an object stands as the file stands it.
    """
    name = _name(model, "body", body, "base" if above is None else f"body_{body}")
    if above is None:
        ET.SubElement(robot, "link", name=name)
        turned = _pose_below(model, 0, body)
        turned[:3, 3] = 0.0
        return _Frame(name=name, T_body_link=inverse(turned))
    T = inverse(frames[above].T_body_link) @ _pose_below(model, above, body)
    parent, T_body_link = frames[above].name, np.eye(4)
    for number, move in enumerate(moves or [None]):
        last = number == max(len(moves), 1) - 1
        link = name if last else f"{name}_{number}"
        T_body_next = np.eye(4)
        if move is not None:
            T_body_next[:3, 3] = model.jnt_pos[move]
        ET.SubElement(robot, "link", name=link)
        joint = _add_joint(robot, model, move, parent, link, path)
        _add_origin(joint, T @ T_body_next if number == 0 else inverse(T_body_link) @ T_body_next)
        parent, T_body_link = link, T_body_next
    return _Frame(name=name, T_body_link=T_body_link)


def _add_joint(
    robot: ET.Element, model: "mujoco.MjModel", move: int | None, parent: str, child: str, path: Path
) -> ET.Element:
    import mujoco

    name, kind, limited = f"{child}_fixed", "fixed", False
    if move is not None:
        turns = int(model.jnt_type[move]) == int(mujoco.mjtJoint.mjJNT_HINGE)
        limited = bool(model.jnt_limited[move])
        kind = "continuous" if turns and not limited else "revolute" if turns else "prismatic"
        name = _name(model, "joint", move, f"{child}_joint")
    joint = ET.SubElement(robot, "joint", name=name, type=kind)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    if move is None:
        return joint
    ET.SubElement(joint, "axis", xyz=_numbers(model.jnt_axis[move]))
    if limited:  # the pose of the file is that at the reference coordinate
        low, high = model.jnt_range[move] - model.qpos0[model.jnt_qposadr[move]]
        ET.SubElement(joint, "limit", lower=f"{low:.9g}", upper=f"{high:.9g}", effort="1", velocity="1")
    leaders = list(_list_leaders(model, move))
    if kind == "prismatic" and not (limited or leaders):
        raise SourceError(f'{path}: joint {name!r} slides without limits, expected a range, such as "0 0.3"')
    for leader, multiplier, offset in leaders:
        ET.SubElement(joint, "mimic", joint=leader, multiplier=f"{multiplier:.9g}", offset=f"{offset:.9g}")
    return joint


def _list_leaders(model: "mujoco.MjModel", move: int) -> Iterator[tuple[str, float, float]]:
    """The joint that a joint follows in proportion (an active equality constraint), factor and offset."""
    import mujoco

    for row in range(model.neq):
        one, other = int(model.eq_obj1id[row]), int(model.eq_obj2id[row])
        if int(model.eq_type[row]) != int(mujoco.mjtEq.mjEQ_JOINT) or one != move or other < 0:
            continue
        if not model.eq_active0[row]:
            continue
        offset, factor, *higher = (float(value) for value in model.eq_data[row][:5])
        if not any(higher):
            yield _name(model, "joint", other, f"joint_{other}"), factor, offset
            return


def _pose_below(model: "mujoco.MjModel", above: int, body: int) -> Float[np.ndarray, "4 4"]:
    """Pose of a body in the frame of one of its ancestors, or of the world (0)."""
    T, at = np.eye(4), body
    while at != above:
        T = _pose(model.body_pos[at], model.body_quat[at]) @ T
        at = int(model.body_parentid[at])
    return T


def _pose(position: np.ndarray, quat: np.ndarray) -> Float[np.ndarray, "4 4"]:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = matrix_from_quat(np.asarray(quat)[None])[0], position
    return T


def _add_origin(element: ET.Element, T: Float[np.ndarray, "4 4"]) -> None:
    ET.SubElement(element, "origin", xyz=_numbers(T[:3, 3]), rpy=_numbers(rpy_from_matrix(T[:3, :3])))


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)


def _name(model: "mujoco.MjModel", kind: str, index: int, default: str) -> str:
    return getattr(model, kind)(index).name or default


def _write_geom(model: "mujoco.MjModel", geom: int, file: Path) -> bool:
    """Writes the triangles of a geom with their colour or image; False if it has none."""
    mesh = _read_geom(model, geom)
    if mesh is None:
        return False
    mesh.export(file)
    return True


def _read_geom(model: "mujoco.MjModel", geom: int) -> "Trimesh | None":
    import mujoco
    from trimesh import Trimesh, creation
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    size, kinds = model.geom_size[geom], mujoco.mjtGeom
    uv, kind = None, mujoco.mjtGeom(int(model.geom_type[geom]))
    match kind:
        case kinds.mjGEOM_MESH:
            mesh, uv = _read_mesh(model, int(model.geom_dataid[geom]))
        case kinds.mjGEOM_BOX:
            mesh = creation.box(2.0 * size)
        case kinds.mjGEOM_CYLINDER:
            mesh = creation.cylinder(radius=size[0], height=2.0 * size[1], sections=SECTIONS)
        case kinds.mjGEOM_CAPSULE:
            mesh = creation.capsule(radius=size[0], height=2.0 * size[1], count=(24, SECTIONS))
            mesh.apply_translation(-mesh.bounds.mean(axis=0))
        case kinds.mjGEOM_SPHERE | kinds.mjGEOM_ELLIPSOID:
            radii = size if kind == kinds.mjGEOM_ELLIPSOID else np.full(3, size[0])
            mesh = creation.icosphere(subdivisions=3)
            mesh.apply_scale(radii)
        case _:
            return None
    color, image = _read_look(model, geom)
    if image is not None and uv is None:  # a primitive shows the image's mean colour
        color[:3] *= np.asarray(image).reshape(-1, 3).mean(axis=0) / 255.0
    material = PBRMaterial(
        baseColorFactor=color,
        baseColorTexture=image if uv is not None else None,
        alphaMode="OPAQUE" if color[3] == 1.0 else "BLEND",
    )
    return Trimesh(mesh.vertices, mesh.faces, process=False, visual=TextureVisuals(uv=uv, material=material))


def _read_mesh(model: "mujoco.MjModel", mesh: int) -> "tuple[Trimesh, Float[np.ndarray, 'V 2'] | None]":
    """A mesh with a vertex for every corner of a face, and texture coordinates if it has any."""
    from trimesh import Trimesh

    first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    start = int(model.mesh_vertadr[mesh])
    corners = np.asarray(model.mesh_vert)[start + np.asarray(model.mesh_face)[first : first + count].ravel()]
    uv = None
    if model.mesh_texcoordadr[mesh] >= 0:
        rows = int(model.mesh_texcoordadr[mesh]) + np.asarray(model.mesh_facetexcoord)[first : first + count]
        uv = np.asarray(model.mesh_texcoord)[rows.ravel()] * [1.0, -1.0] + [0.0, 1.0]
    return Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False), uv


def _read_look(model: "mujoco.MjModel", geom: int):
    """Colour (RGBA in 0 to 1) and image, if there is one, of a geom."""
    import mujoco
    from PIL import Image

    color, image = np.array(model.geom_rgba[geom], dtype=float), None
    material = int(model.geom_matid[geom])
    if material < 0:
        return color, None
    if np.allclose(color, PLAIN):
        color = np.array(model.mat_rgba[material], dtype=float)
    texture = int(np.max(model.mat_texid[material]))
    if texture >= 0 and int(model.tex_type[texture]) == int(mujoco.mjtTexture.mjTEXTURE_2D):
        shape = (model.tex_height[texture], model.tex_width[texture], model.tex_nchannel[texture])
        start = int(model.tex_adr[texture])
        pixels = np.asarray(model.tex_data)[start : start + int(np.prod(shape))].reshape(shape)
        image = Image.fromarray(np.ascontiguousarray(pixels[..., :3]))
    return color, image
