"""Reads a folder as a package: one of ours, or any folder laid out like PartNet-Mobility.

Links and joints come from the URDF; in our own packages, JSON files add what a URDF cannot express. Foreign
folders are interpreted as by a simulator: one convex hull per `<collision>`, no mass where none is given, and
everything transformed into the frame of the root link, which removes a rotation in the fixed base joint.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from artigen.errors import SourceError
from artigen.files.urdf import UrdfFile, UrdfInertial, UrdfLink, UrdfShape, rest_poses, tree_problems
from artigen.splats.motion import transform_gaussians
from artigen.splats.ply import read_ply
from artigen.transforms import transform_points
from artigen.types import JOINT_TYPES, Gaussians, Joint, PartLabel
from sim_export.errors import DegeneratePart, PackageError
from sim_export.files.foreign import label_of, read_semantics, thicken
from sim_export.files.grasp_values import grasps_from_json
from sim_export.files.joints import place_joint
from sim_export.files.obj import parse_obj, parse_urdf, read_mesh
from sim_export.files.sidecars import FORMAT, VERSION, handles_from_json
from sim_export.files.urdf import GLB_URDF, splats_path
from sim_export.geometry.hulls import convex_hull
from sim_export.geometry.primitives import primitive_mesh
from sim_export.package import Hull, Inertial, Link, Mesh, SimPackage, SourceMesh, Visual


@dataclass(frozen=True, kw_only=True, eq=False)
class _Foreign:
    """Data about a foreign folder besides its URDF."""

    folder: Path
    poses: dict[str, Float[np.ndarray, "4 4"]]
    labels: dict[str, PartLabel]
    records: list[str]


def read_package(folder: Path, *, appearance: bool = True) -> SimPackage:
    """Reads our own package, or any folder with a `mobility.urdf` in PartNet-Mobility's layout.

    Labels of a foreign folder come from `semantics.txt` if the word is known. Its visuals remain files
    (`SourceMesh`), and it has no handles, materials or provenance.

    Args:
        folder: The folder.
        appearance: Read visuals and splats; without them, reading is much faster.

    Raises:
        PackageError: If something is missing or invalid; the message names the file, the element and the
            value.
    """
    folder = Path(folder)
    try:
        return _read_package(folder, appearance=appearance)
    except PackageError as err:
        said = str(err)
        raise PackageError(said if said.startswith(str(folder)) else f"{folder}: {said}") from err


def _read_package(folder: Path, *, appearance: bool) -> SimPackage:
    urdf = parse_urdf(folder / "mobility.urdf")
    problems = tree_problems(urdf)
    if problems:
        raise PackageError(f"{urdf.path}: {problems[0][1]}")
    poses = rest_poses(urdf)
    meta = _json(folder / "meta.json") if (folder / "meta.json").is_file() else {}
    if isinstance(meta, dict) and meta.get("format") == FORMAT:
        return _read_own(folder, urdf, poses, meta, appearance=appearance)
    package = _read_foreign(folder, urdf, poses, meta if isinstance(meta, dict) else {})
    if appearance:
        return package
    return replace(package, links=tuple(replace(link, visuals=()) for link in package.links))


def _json(path: Path) -> object:
    try:
        return json.loads(path.read_text())
    except OSError as err:
        raise PackageError(f"{path}: cannot be read ({err.strerror})") from err
    except ValueError as err:
        raise PackageError(f"{path}: not JSON ({err})") from err


def _object(path: Path) -> dict:
    value = _json(path)
    if not isinstance(value, dict):
        raise PackageError(f"{path}: holds a {type(value).__name__}, expected an object")
    return value


def package_file(folder: Path, name: str, owner: str) -> Path:
    """Path of a file named in a URDF; raises `PackageError` unless it exists inside the folder."""
    path = folder / name
    if not name or Path(name).is_absolute() or "://" in name:
        raise PackageError(f"{owner}: mesh file {name!r}, expected a path relative to the URDF")
    if not path.resolve().is_relative_to(folder.resolve()):
        raise PackageError(f"{owner}: mesh file {name!r} is outside of the folder")
    if not path.is_file():
        raise PackageError(f"{owner}: mesh file {name!r} is missing")
    return path


def _inertial(inertial: UrdfInertial | None, T: Float[np.ndarray, "4 4"], owner: str) -> Inertial | None:
    """Mass properties in object axes; a mass of 0 means none, as in SAPIEN."""
    if inertial is None or (inertial.mass == 0.0 and not inertial.inertia.any()):
        return None
    if not np.isfinite([inertial.mass, *inertial.com, *inertial.inertia.ravel()]).all():
        raise PackageError(f"{owner}: <inertial> holds NaN or infinite values")
    R = T[:3, :3]
    com = transform_points(T, inertial.com[None])[0]
    return Inertial(mass=inertial.mass, com=com, inertia=R @ inertial.inertia @ R.T)


def _read_own(
    folder: Path, urdf: UrdfFile, poses: dict[str, Float[np.ndarray, "4 4"]], meta: dict, *, appearance: bool
) -> SimPackage:
    """Our own package with exact meshes and hulls, labels and handles."""
    if meta.get("version") != VERSION:
        raise PackageError(
            f"{folder / 'meta.json'}: format version {meta.get('version')}, this reads {VERSION}"
        )
    physics = _object(folder / "physics.json")
    notes = _object(folder / "annotations.json")
    handles, needs = handles_from_json(notes)
    provenance = _object(folder / "provenance.json")
    wrong = next((key for key, value in provenance.items() if not isinstance(value, str)), None)
    if wrong is not None:
        raise PackageError(
            f"{folder / 'provenance.json'}: {wrong!r} is {provenance[wrong]!r}, expected a text"
        )
    try:
        facts = {entry["name"]: entry for entry in meta["links"]}
        motion = {entry["name"]: entry for entry in physics["joints"]}
        links = tuple(
            _own_link(folder, urdf, index, poses[link.name], facts[link.name], appearance=appearance)
            for index, link in enumerate(urdf.links)
        )
        joints = tuple(
            _own_joint(place_joint(joint, poses, str(urdf.path)), motion.get(joint.name))
            for joint in urdf.joints
        )
        return SimPackage(
            name=meta["model_id"],
            category=meta["model_cat"],
            visual=meta["visual"],
            links=links,
            joints=joints,
            handles=handles,
            requires_open=needs,
            grasps=grasps_from_json(notes, poses),
            materials=tuple(physics["materials"].items()),
            provenance=tuple(provenance.items()),
            records=tuple(meta["records"]),
            visual_format="glb" if (folder / GLB_URDF).is_file() else "obj",
        )
    except (KeyError, TypeError, ValueError, AttributeError) as err:
        raise PackageError(
            f"{folder}: meta.json or physics.json does not have the expected structure ({err!r})"
        ) from err


def _own_joint(joint: Joint, motion: dict | None) -> Joint:
    """Adds the joint kind, and the range of continuous joints, which a URDF cannot express."""
    if motion is None:
        return joint
    if motion["kind"] not in JOINT_TYPES:
        raise PackageError(f"physics.json: joint {joint.name!r} has kind {motion['kind']!r}")
    if joint.type == "continuous":
        joint = replace(joint, lower=float(motion["lower"]), upper=float(motion["upper"]))
    return replace(joint, of_screw=motion["kind"] == "screw", spring=float(motion.get("spring", 0.0)))


def _own_link(
    folder: Path, urdf: UrdfFile, index: int, T: Float[np.ndarray, "4 4"], facts: dict, *, appearance: bool
) -> Link:
    link = urdf.links[index]
    owner = f"{urdf.path}: link {link.name!r}"
    visual_facts = {entry["name"]: entry for entry in facts["visuals"]}
    splats = folder / splats_path(link.name)
    visuals = []
    for shape in link.visuals if appearance else ():
        entry = visual_facts[shape.name]
        path = package_file(folder, shape.file, owner)
        mesh = _source_mesh(path, shape, T, owner) if entry["source"] else read_mesh(path)
        visuals.append(
            Visual(
                name=shape.name,
                part=entry["part"],
                label=entry["label"],
                mesh=mesh,
                finish=entry.get("finish", ""),
            )
        )
    hulls = tuple(_own_hull(folder, shape, T, owner) for shape in link.collisions)
    return Link(
        name=link.name,
        label=facts["label"],
        parts=tuple(facts["parts"]),
        visuals=tuple(visuals),
        hulls=hulls,
        inertial=_inertial(link.inertial, T, owner),
        splats=_own_splats(splats, T, index) if appearance and splats.is_file() else None,
        visual_error=facts.get("visual_error"),
    )


def _own_hull(folder: Path, shape: UrdfShape, T: Float[np.ndarray, "4 4"], owner: str) -> Hull:
    """Hull of a collision element; our meshes are in the object frame, primitives in the link's."""
    if shape.kind == "mesh":
        data = parse_obj(package_file(folder, shape.file, owner))
        return Hull(vertices=data.vertices, faces=data.faces)
    mesh = _place_primitive(shape, T)
    return Hull(vertices=mesh.vertices, faces=mesh.faces)


def _own_splats(path: Path, T: Float[np.ndarray, "4 4"], index: int) -> Gaussians:
    """The Gaussians of a link, transformed to the object frame."""
    try:
        return transform_gaussians(read_ply(path, part_id=index), T)
    except SourceError as err:
        raise PackageError(str(err)) from err


def _source_mesh(path: Path, shape: UrdfShape, T: Float[np.ndarray, "4 4"], owner: str) -> SourceMesh:
    scale = shape.scale[0]
    if scale <= 0 or max(abs(other - scale) for other in shape.scale) > 1e-9 * scale:
        raise PackageError(f"{owner}: mesh scale {list(shape.scale)}, expected one positive number thrice")
    return SourceMesh(path=path, T_object_file=T @ shape.T_link_shape, scale=scale)


def _read_foreign(
    folder: Path, urdf: UrdfFile, poses: dict[str, Float[np.ndarray, "4 4"]], meta: dict
) -> SimPackage:
    """A foreign folder, interpreted as by a simulator."""
    foreign = _Foreign(
        folder=folder, poses=poses, labels=read_semantics(folder / "semantics.txt"), records=[]
    )
    links = tuple(_foreign_link(foreign, urdf, link) for link in urdf.links)
    return SimPackage(
        name=folder.resolve().name,
        category=str(meta.get("model_cat", "")),
        visual="source",
        links=links,
        joints=tuple(place_joint(joint, poses, str(urdf.path)) for joint in urdf.joints),
        records=tuple(foreign.records),
    )


def _foreign_link(foreign: _Foreign, urdf: UrdfFile, link: UrdfLink) -> Link:
    owner = f"{urdf.path}: link {link.name!r}"
    T = foreign.poses[link.name]
    label = foreign.labels.get(link.name)
    visuals = []
    for index, shape in enumerate(link.visuals):
        name = shape.name or f"visual_{index}"
        own = label_of(name)
        visuals.append(
            Visual(
                name=name,
                part=name,
                label=own if own in ("handle", "knob") else label or "base",
                mesh=_foreign_visual(foreign.folder, shape, T, owner),
            )
        )
    hulls = tuple(_foreign_hull(foreign, shape, T, owner) for shape in link.collisions)
    return Link(
        name=link.name,
        label=label,
        parts=tuple(dict.fromkeys(visual.part for visual in visuals)),
        visuals=tuple(visuals),
        hulls=hulls,
        inertial=_inertial(link.inertial, T, owner),
    )


def _foreign_visual(
    folder: Path, shape: UrdfShape, T: Float[np.ndarray, "4 4"], owner: str
) -> Mesh | SourceMesh:
    if shape.kind == "mesh":
        return _source_mesh(package_file(folder, shape.file, owner), shape, T, owner)
    return _place_primitive(shape, T)


def _place_primitive(shape: UrdfShape, T: Float[np.ndarray, "4 4"]) -> Mesh:
    """Surface mesh of a box, cylinder or sphere in a link with frame ``T``."""
    mesh = primitive_mesh(shape.kind, shape.sizes)
    return Mesh(vertices=transform_points(T @ shape.T_link_shape, mesh.vertices), faces=mesh.faces)


def _foreign_hull(foreign: _Foreign, shape: UrdfShape, T: Float[np.ndarray, "4 4"], owner: str) -> Hull:
    """Convex hull of a collision shape; a flat shape becomes a thin plate, as in an engine, and is
    recorded."""
    if shape.kind == "mesh":
        data = parse_obj(package_file(foreign.folder, shape.file, owner))
        points = data.vertices[np.unique(data.faces)] * shape.scale
    else:
        points = primitive_mesh(shape.kind, shape.sizes).vertices
    if not len(points):
        raise PackageError(f"{owner}: collision mesh {shape.file!r} has no faces")
    points = transform_points(T @ shape.T_link_shape, points)
    try:
        return convex_hull(points)
    except DegeneratePart:
        foreign.records.append(
            f"link {shape.link!r}: collision {shape.file or shape.kind} is flat, read as a plate of 1 mm"
        )
        return convex_hull(thicken(points))
