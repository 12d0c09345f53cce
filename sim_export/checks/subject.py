"""The package folder under test; data that checks share is parsed once, on demand.

Supports our packages and original PartNet-Mobility folders. All geometry is in metres in the object frame:
the frame of the URDF's root link with every joint at 0. Missing or invalid data raises `PackageError`, which
`run_checks` converts to a failed check.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike

from artigen.files.urdf import UrdfFile, UrdfLink, UrdfShape, rest_poses, tree_problems
from artigen.files.wavefront import ObjText
from artigen.transforms import transform_points
from artigen.types import Joint, PartLabel
from sim_export.errors import DegeneratePart, PackageError
from sim_export.files.foreign import parse_semantics, read_semantics
from sim_export.files.joints import place_joint
from sim_export.files.obj import parse_obj, parse_urdf
from sim_export.geometry.contacts import HullSet
from sim_export.geometry.hulls import convex_hull
from sim_export.geometry.primitives import primitive_mesh
from sim_export.geometry.triangles import bounds_of
from sim_export.motion.kinematics import driven_joints, led_joints, link_displacements
from sim_export.package import Hull, Link, Mesh, Requirement

MAIN_URDF = "mobility.urdf"
OWN_SIDECARS = ("annotations.json", "manifest.json", "physics.json", "provenance.json")


@dataclass(frozen=True, kw_only=True, eq=False)
class Shape:
    """The mesh of one visual or collision element, placed in the object frame at rest."""

    link: str
    name: str
    kind: str
    """``mesh``, or the URDF name of the primitive."""
    file: str
    """The mesh file, or the element's name for a primitive."""
    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    obj: ObjText

    @property
    def triangles(self) -> Float[np.ndarray, "F 3 3"]:
        """Corner coordinates of every face."""
        return self.vertices[self.faces]


class Subject:
    """A folder and the data read from it; read data never changes."""

    def __init__(
        self,
        folder: Path,
        meshes: Mapping[Path, ObjText] | None = None,
        texts: Mapping[str, str] | None = None,
    ) -> None:
        """
        Args:
            folder: The folder; where ``texts`` are given it need not exist.
            meshes: Meshes by path that need not be read.
            texts: The text files of the folder by name, which are not read then.
        """
        self.folder = Path(folder)
        self._meshes: dict[Path, ObjText] = dict(meshes or {})
        self._texts = texts

    @cached_property
    def files(self) -> tuple[str, ...]:
        """All files below the folder, relative, sorted."""
        if self._texts is not None:
            return tuple(sorted(self._texts))
        return tuple(
            sorted(p.relative_to(self.folder).as_posix() for p in self.folder.rglob("*") if p.is_file())
        )

    @cached_property
    def is_package(self) -> bool:
        """Whether the folder is one of our packages, even an incomplete one, and not a foreign URDF
        folder."""
        return any(self.has_file(name) for name in OWN_SIDECARS) or "format" in self.meta

    def has_file(self, name: str) -> bool:
        """Whether a file lies in the folder."""
        return (self.folder / name).is_file() if self._texts is None else name in self._texts

    @cached_property
    def meta(self) -> dict:
        """``meta.json``; empty if missing."""
        return self.read_json("meta.json") if self.has_file("meta.json") else {}

    @cached_property
    def has_own_visuals(self) -> bool:
        """Whether we made the visual meshes; others are copied from a source."""
        return self.meta.get("visual") in ("exact", "voxels")

    def read_json(self, name: str) -> dict:
        """A JSON object beside the URDF; raises `PackageError` for anything else."""
        try:
            known = None if self._texts is None else self._texts.get(name)
            value = json.loads((self.folder / name).read_text() if known is None else known)
        except OSError as err:
            raise PackageError(f"{name}: cannot be read ({err.strerror})") from err
        except ValueError as err:
            raise PackageError(f"{name}: not JSON ({err})") from err
        if not isinstance(value, dict):
            raise PackageError(f"{name}: holds a {type(value).__name__}, expected an object")
        return value

    @cached_property
    def urdf(self) -> UrdfFile:
        """``mobility.urdf`` as written."""
        return parse_urdf(self.folder / MAIN_URDF, None if self._texts is None else self._texts[MAIN_URDF])

    @cached_property
    def urdfs(self) -> dict[str, UrdfFile | PackageError]:
        """Every URDF of the folder, or the error of reading it; `mobility.urdf` is always included."""
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
        """Links by name; verified to form one tree."""
        problems = tree_problems(self.urdf)
        if problems:
            raise PackageError(f"{MAIN_URDF}: {problems[0][1]}")
        return {link.name: link for link in self.urdf.links}

    @cached_property
    def poses(self) -> dict[str, Float[np.ndarray, "4 4"]]:
        """Frame of every link in the object frame at rest, parents first."""
        return rest_poses(self.urdf) if self.links else {}

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """Joints in the object frame at rest, parents first; raises for a joint that cannot move."""
        order = list(self.poses)
        return tuple(
            place_joint(joint, self.poses, MAIN_URDF)
            for joint in sorted(self.urdf.joints, key=lambda joint: order.index(joint.child))
        )

    @cached_property
    def driven(self) -> tuple[Joint, ...]:
        """The joints with a coordinate of their own."""
        return driven_joints(self.joints)

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
        """``link`` and its descendants, sorted."""
        return tuple(sorted(name for name in self.links if name == link or link in self.ancestors(name)))

    def moved(self, joint: Joint) -> tuple[str, ...]:
        """Links that a driven joint moves, its followers' included, sorted."""
        led = led_joints(self.joints, joint)
        return tuple(sorted({name for one in led for name in self.carried(one.child)}))

    @cached_property
    def static_links(self) -> frozenset[str]:
        """Links that no joint moves."""
        moving = {joint.child for joint in self.joints if joint.type != "fixed"}
        return frozenset(n for n in self.links if n not in moving and not moving & set(self.ancestors(n)))

    @cached_property
    def _skeleton(self) -> tuple[Link, ...]:
        return tuple(Link(name=name) for name in self.links)

    def displacements(self, qpos: dict[str, ArrayLike]) -> dict[str, np.ndarray]:
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
        obj = self._mesh(shape) if shape.kind == "mesh" else as_text(primitive_mesh(shape.kind, shape.sizes))
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

    def _mesh(self, shape: UrdfShape) -> ObjText:
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
        """Convex hull of every collision shape, as an engine computes it; None if it is flat."""
        return tuple(_engine_hull(shape.vertices) for shape in self.collisions)

    @cached_property
    def carriers(self) -> frozenset[str]:
        """Intermediate links of screws, which have no surface."""
        turned = {joint.name: joint.child for joint in self.urdf.joints}
        between = {
            joint.parent for joint in self.urdf.joints if turned.get(joint.mimic or "") == joint.parent
        }
        return frozenset(name for name in between if name in self.links and not self.links[name].visuals)

    @cached_property
    def hull_sets(self) -> dict[str, HullSet]:
        """The hulls of every touchable link; the intermediate link of a screw is excluded, because it lies
        inside others.

        Shapes too flat for a hull are skipped; V102 reports them.
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
        return bounds_of(points)

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal (m)."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))

    @cached_property
    def labels(self) -> dict[str, PartLabel]:
        """Label of each link from ``semantics.txt``; links with unknown labels are missing."""
        if self._texts is not None:
            return parse_semantics(self._texts["semantics.txt"])
        return read_semantics(self.folder / "semantics.txt")

    @cached_property
    def annotations(self) -> dict:
        """``annotations.json``; empty for foreign folders."""
        return self.read_json("annotations.json") if self.is_package else {}

    @cached_property
    def requires_open(self) -> tuple[Requirement, ...]:
        """Joints that require another one to be open first."""
        try:
            return tuple(
                Requirement(joint=row["joint"], needs=row["needs"], fraction=float(row["fraction"]))
                for row in self.annotations.get("requires_open", [])
            )
        except (KeyError, TypeError, ValueError) as err:
            raise PackageError(
                f"annotations.json: requires_open is not a list of requirements ({err!r})"
            ) from err


def _engine_hull(vertices: np.ndarray) -> Hull | None:
    try:
        return convex_hull(vertices)
    except DegeneratePart:
        return None


def as_text(mesh: Mesh) -> ObjText:
    """A mesh as it would be read from its file, but for its texture and the precision of the file."""
    return ObjText(
        vertices=mesh.vertices,
        coords=np.zeros((0, 2)),
        faces=mesh.faces,
        uv_faces=np.full_like(mesh.faces, -1),
        names=("",),
        material_ids=np.zeros(len(mesh.faces), dtype=np.int64),
        libraries=(),
    )
