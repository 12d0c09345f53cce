"""The package folder under test; what checks share is parsed once, on demand.

Works on our packages and on original PartNet-Mobility folders. All geometry comes out in metres in
the object frame: the frame of the URDF's root link with every joint at 0. What cannot be had raises
`PackageError`, which `run_checks` turns into a failed check.
"""

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from artigen.transforms import transform_points
from artigen.types import PART_LABELS, PartLabel
from sim_export.checks.urdf_file import UrdfFile, UrdfJoint, UrdfLink, UrdfShape, parse_urdf, tree_problems
from sim_export.collision.contacts import HullSet
from sim_export.collision.hulls import convex_hull
from sim_export.collision.motion import MOVING_TYPES, link_displacements
from sim_export.errors import DegeneratePart, PackageError
from sim_export.files.obj import ObjData, ObjGroup, parse_obj
from sim_export.geometry.primitives import primitive_mesh
from sim_export.package import URDF_JOINT_TYPES, Hull, Link, PackageJoint, Requirement, UrdfJointType

MAIN_URDF = "mobility.urdf"
OWN_SIDECARS = ("annotations.json", "manifest.json", "physics.json", "provenance.json")


@dataclass(frozen=True, kw_only=True, eq=False)
class Shape:
    """The mesh of one visual or collision element, placed in the object frame at rest."""

    link: str
    name: str
    kind: str
    """``mesh``, or what URDF calls the primitive."""
    file: str
    """The mesh's, or the element's name."""
    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    obj: ObjData

    @property
    def triangles(self) -> Float[np.ndarray, "F 3 3"]:
        """Corner coordinates of every face."""
        return self.vertices[self.faces]


class Subject:
    """A folder and what was read from it so far; nothing in it changes once read."""

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder)
        self._meshes: dict[Path, ObjData] = {}

    @cached_property
    def files(self) -> tuple[str, ...]:
        """All files below the folder, relative, sorted."""
        return tuple(
            sorted(p.relative_to(self.folder).as_posix() for p in self.folder.rglob("*") if p.is_file())
        )

    @cached_property
    def is_package(self) -> bool:
        """Whether this is one of our packages, or what is left of one, rather than somebody's URDF folder."""
        return any((self.folder / name).exists() for name in OWN_SIDECARS) or "format" in self.meta

    @cached_property
    def meta(self) -> dict:
        """``meta.json``; empty where there is none."""
        return self.read_json("meta.json") if (self.folder / "meta.json").is_file() else {}

    @cached_property
    def visual_source(self) -> str:
        """``voxels`` where the visual meshes are ours, else ``source``: somebody's artwork kept as it is."""
        return "voxels" if self.meta.get("visual") == "voxels" else "source"

    def read_json(self, name: str) -> dict:
        """A JSON object beside the URDF; raises `PackageError` where it is anything else."""
        try:
            value = json.loads((self.folder / name).read_text())
        except OSError as err:
            raise PackageError(f"{name}: cannot be read ({err.strerror})") from err
        except ValueError as err:
            raise PackageError(f"{name}: not JSON ({err})") from err
        if not isinstance(value, dict):
            raise PackageError(f"{name}: holds a {type(value).__name__}, expected an object")
        return value

    @cached_property
    def urdf(self) -> UrdfFile:
        """``mobility.urdf`` as it stands."""
        return parse_urdf(self.folder / MAIN_URDF)

    @cached_property
    def urdfs(self) -> dict[str, UrdfFile | PackageError]:
        """Every URDF of the folder, or why it cannot be read; `mobility.urdf` is always among them."""
        names = {MAIN_URDF, *(name for name in self.files if name.endswith(".urdf") and "/" not in name)}
        found: dict[str, UrdfFile | PackageError] = {}
        for name in sorted(names):
            try:
                found[name] = self.urdf if name == MAIN_URDF else parse_urdf(self.folder / name)
            except PackageError as err:
                found[name] = err
        return found

    @cached_property
    def links(self) -> dict[str, UrdfLink]:
        """Links by name, once it is certain that they form one tree."""
        problems = tree_problems(self.urdf)
        if problems:
            raise PackageError(f"{MAIN_URDF}: {problems[0][1]}")
        return {link.name: link for link in self.urdf.links}

    @cached_property
    def poses(self) -> dict[str, Float[np.ndarray, "4 4"]]:
        """Every link's frame in the object frame at rest."""
        poses = {name: np.eye(4) for name in self.links}
        for joint in self._parents_first:
            poses[joint.child] = poses[joint.parent] @ joint.T_parent_joint
        return poses

    @cached_property
    def _parents_first(self) -> tuple[UrdfJoint, ...]:
        links = self.links
        depth = dict.fromkeys(links, 0)
        parents = {joint.child: joint.parent for joint in self.urdf.joints}
        for name in links:
            at = name
            while at in parents:
                depth[name] += 1
                at = parents[at]
        return tuple(sorted(self.urdf.joints, key=lambda joint: depth[joint.child]))

    @cached_property
    def joints(self) -> tuple[PackageJoint, ...]:
        """Joints in the object frame at rest, parents first; raises where one cannot move at all."""
        return tuple(self._joint(joint) for joint in self._parents_first)

    def _joint(self, joint: UrdfJoint) -> PackageJoint:
        type_: UrdfJointType | None = next((known for known in URDF_JOINT_TYPES if known == joint.type), None)
        if type_ is None:
            raise PackageError(
                f"{MAIN_URDF}: joint {joint.name!r} has type {joint.type!r}, which cannot be moved"
            )
        T = self.poses[joint.child]
        length = float(np.linalg.norm(joint.axis))
        lower, upper = joint.lower or 0.0, joint.upper or 0.0
        if type_ == "continuous":
            lower, upper = 0.0, 2.0 * np.pi
        if type_ != "fixed" and not (
            np.isfinite([length, lower, upper]).all() and length > 0.0 and lower <= upper
        ):
            raise PackageError(
                f"{MAIN_URDF}: joint {joint.name!r} cannot be moved: axis {joint.axis.tolist()}, "
                f"limits [{lower}, {upper}]"
            )
        return PackageJoint(
            name=joint.name,
            type=type_,
            kind=type_,
            parent=joint.parent,
            child=joint.child,
            origin=T[:3, 3],
            axis=T[:3, :3] @ (joint.axis / length if length > 0.0 else joint.axis),
            lower=lower,
            upper=upper,
            mimic=joint.mimic,
            mimic_multiplier=joint.mimic_multiplier,
        )

    @cached_property
    def driven(self) -> tuple[PackageJoint, ...]:
        """The joints with a coordinate of their own."""
        return tuple(j for j in self.joints if j.type in MOVING_TYPES and j.mimic is None)

    @cached_property
    def parents(self) -> dict[str, str]:
        """Parent link of every link but the root."""
        return {joint.child: joint.parent for joint in self.urdf.joints if self.links}

    def ancestors(self, link: str) -> tuple[str, ...]:
        """The links that carry ``link``, nearest first."""
        chain = []
        while link in self.parents:
            link = self.parents[link]
            chain.append(link)
        return tuple(chain)

    def carried(self, link: str) -> tuple[str, ...]:
        """``link`` and everything that moves with it, sorted."""
        return tuple(sorted(name for name in self.links if name == link or link in self.ancestors(name)))

    def moved(self, joint: PackageJoint) -> tuple[str, ...]:
        """What a driven joint moves: what it carries, and what joints carry that follow it, sorted."""
        moving = [joint.child, *(other.child for other in self.joints if other.mimic == joint.name)]
        return tuple(sorted({name for link in moving for name in self.carried(link)}))

    @cached_property
    def static_links(self) -> frozenset[str]:
        """Links that no joint can move."""
        moving = {joint.child for joint in self.joints if joint.type != "fixed"}
        return frozenset(n for n in self.links if n not in moving and not moving & set(self.ancestors(n)))

    @cached_property
    def _skeleton(self) -> tuple[Link, ...]:
        bare = {"label": None, "parts": (), "visuals": (), "hulls": (), "inertial": None}
        return tuple(Link(name=name, **bare) for name in self.links)

    def displacements(self, qpos: dict[str, object]) -> dict[str, np.ndarray]:
        """Displacement from rest of every link at joint coordinates, each ``4 4`` or ``P 4 4``."""
        T = link_displacements(self._skeleton, self.joints, qpos)
        return {link.name: T[..., index, :, :] for index, link in enumerate(self._skeleton)}

    @cached_property
    def visuals(self) -> tuple[Shape, ...]:
        """Every visual mesh, in file order."""
        return tuple(self._shape(link, s) for link in self.links.values() for s in link.visuals)

    @cached_property
    def collisions(self) -> tuple[Shape, ...]:
        """Every collision mesh, in file order."""
        return tuple(self._shape(link, s) for link in self.links.values() for s in link.collisions)

    def _shape(self, link: UrdfLink, shape: UrdfShape) -> Shape:
        obj = self._mesh(shape) if shape.kind == "mesh" else _primitive(shape)
        T = self.poses[link.name] @ shape.T_link_shape
        vertices = transform_points(T, obj.vertices * shape.scale)
        faces = obj.faces if np.prod(shape.scale) > 0 else obj.faces[:, ::-1]
        return Shape(
            link=link.name,
            name=shape.name,
            kind=shape.kind,
            file=shape.file or f"{shape.kind} {shape.name!r}",
            vertices=vertices,
            faces=faces,
            obj=obj,
        )

    def _mesh(self, shape: UrdfShape) -> ObjData:
        path = self.folder / shape.file
        if path not in self._meshes:
            if path.suffix.lower() != ".obj":
                raise PackageError(
                    f"{shape.file}: a {path.suffix or 'nameless'} mesh, these checks read OBJ only"
                )
            self._meshes[path] = parse_obj(path)
        return self._meshes[path]

    @cached_property
    def hulls(self) -> tuple[Hull | None, ...]:
        """For every collision shape the convex hull an engine makes of it; None where it is flat."""
        return tuple(_engine_hull(shape.vertices) for shape in self.collisions)

    @cached_property
    def carriers(self) -> frozenset[str]:
        """Links without a surface between the two joints of a screw."""
        turned = {joint.name: joint.child for joint in self.urdf.joints}
        between = {
            joint.parent for joint in self.urdf.joints if turned.get(joint.mimic or "") == joint.parent
        }
        return frozenset(name for name in between if name in self.links and not self.links[name].visuals)

    @cached_property
    def hull_sets(self) -> dict[str, HullSet]:
        """The hulls of every link that can be touched: not of a screw's carrier, which is inside of others.

        Shapes too flat for a hull are left out (V102 names them).
        """
        found: dict[str, list[Hull]] = {name: [] for name in self.links}
        for shape, hull in zip(self.collisions, self.hulls, strict=True):
            if hull is not None and shape.link not in self.carriers:
                found[shape.link].append(hull)
        return {name: HullSet(hulls=tuple(hulls)) for name, hulls in found.items()}

    def points(self, link: str) -> Float[np.ndarray, "N 3"]:
        """All visual and collision vertices of a link."""
        chunks = [s.vertices for s in (*self.visuals, *self.collisions) if s.link == link]
        return np.concatenate([np.zeros((0, 3)), *chunks])

    @cached_property
    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest corner of all geometry at rest."""
        points = np.concatenate([np.zeros((0, 3)), *(s.vertices for s in (*self.visuals, *self.collisions))])
        if not len(points):
            raise PackageError(f"{MAIN_URDF}: no link has any geometry")
        return np.stack([points.min(axis=0), points.max(axis=0)])

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal (m)."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))

    @cached_property
    def labels(self) -> dict[str, PartLabel]:
        """What each link is, from ``semantics.txt``; links it does not know are missing."""
        path = self.folder / "semantics.txt"
        if not path.is_file():
            return {}
        rows = [line.split() for line in path.read_text(errors="replace").splitlines()]
        known: dict[str, PartLabel] = {}
        for row in rows:
            label = _label(row[1], row[2]) if len(row) >= 3 else None
            if label is not None:
                known[row[0]] = label
        return known

    @cached_property
    def annotations(self) -> dict:
        """``annotations.json``; empty for a folder that is not ours."""
        return self.read_json("annotations.json") if self.is_package else {}

    @cached_property
    def requires_open(self) -> tuple[Requirement, ...]:
        """Which joints need another one open first."""
        try:
            return tuple(
                Requirement(joint=row["joint"], needs=row["needs"], fraction=float(row["fraction"]))
                for row in self.annotations.get("requires_open", [])
            )
        except (KeyError, TypeError, ValueError) as err:
            raise PackageError(
                f"annotations.json: requires_open is not a list of requirements ({err!r})"
            ) from err


def _label(kind: str, name: str) -> PartLabel | None:
    """Our label for a line of ``semantics.txt``, ours or PartNet-Mobility's."""
    word = name.lower()
    if kind in ("heavy", "static", "free") and not word.startswith("caster"):
        return "base"
    for label in PART_LABELS:
        if label != "base" and word.split("_")[-1] == label:
            return label
    if word.split("_")[-1] == "lid" and kind == "hinge":
        return "door"
    if word in ("button", "switch", "toggle_button"):
        return "knob"
    return "wheel" if word == "caster" else None


def _engine_hull(vertices: np.ndarray) -> Hull | None:
    try:
        return convex_hull(vertices)
    except DegeneratePart:
        return None


def _primitive(shape: UrdfShape) -> ObjData:
    """A URDF box, cylinder or sphere as triangles."""
    mesh = primitive_mesh(shape.kind, shape.sizes)
    group = ObjGroup(material=None, faces=mesh.faces, uv_faces=np.full_like(mesh.faces, -1))
    return ObjData(vertices=mesh.vertices, uv=np.zeros((0, 2)), groups=(group,), mtllib=None)
