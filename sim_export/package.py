"""The simulation package as a value, which `write_package` writes and `read_package` reads.

Units are metres, kilograms, seconds and radians. Geometry, joint origins and inertia are given in the *object
frame* at rest (z up, front -x). Only the writers convert them to link frames, whose origin is the joint's and
whose axes are the object's.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.brief import Brief
from artigen.shapes.surfaces.physical import PLAIN, Material
from artigen.types import Gaussians, Joint, PartLabel, freeze_field

UrdfJointType = Literal["fixed", "revolute", "prismatic", "continuous"]
VisualSource = Literal["exact", "voxels", "source"]
"""What visual meshes show: the object's own primitives, its voxels, or the meshes of its source."""
VisualFormat = Literal["obj", "glb"]
"""Files of visuals: OBJ with MTL, or these and one GLB per link, with a URDF of their own."""
URDF_JOINT_TYPES: tuple[UrdfJointType, ...] = ("fixed", "revolute", "prismatic", "continuous")


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """Triangles with shared vertices, optionally textured by per-corner coordinates.

    ``uv`` has its origin at the lower left of ``texture``, whose rows run top to bottom; an optional fourth
    channel is the opacity. Coordinates outside [0, 1] repeat the texture. ``color`` is the RGB in [0, 1] of a
    mesh without a texture. ``normal_map`` holds unit normals: right, up and outwards with respect to ``uv``,
    from -1 at 0 to 1 at 255. Meshes of one ``material`` with a name have the same images or colour.
    """

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    uv: Float[np.ndarray, "F 3 2"] | None = None
    texture: UInt8[np.ndarray, "H W C"] | None = None
    normal_map: UInt8[np.ndarray, "H W 3"] | None = None
    color: tuple[float, float, float] = (0.7, 0.7, 0.7)
    material: Material = PLAIN

    def __post_init__(self) -> None:
        vertices = freeze_field(self, "vertices", np.float64, (None, 3), "mesh vertices")
        faces = freeze_field(self, "faces", np.int64, (None, 3), "mesh faces")
        if len(faces) and (faces.min() < 0 or faces.max() >= len(vertices)):
            raise ValueError(
                f"mesh faces index {faces.min()}..{faces.max()}, vertices are 0..{len(vertices) - 1}"
            )
        if self.uv is None and (self.texture is not None or self.normal_map is not None):
            raise ValueError("a mesh with a texture or a normal map needs texture coordinates")
        if self.uv is not None:
            freeze_field(self, "uv", np.float64, (len(faces), 3, 2), "mesh uv")
        if self.texture is not None:
            texture = freeze_field(self, "texture", np.uint8, (None, None, None), "texture")
            if texture.shape[2] not in (3, 4):
                raise ValueError(f"a texture with {texture.shape[2]} channels, expected RGB or RGBA")
        if self.normal_map is not None:
            freeze_field(self, "normal_map", np.uint8, (None, None, 3), "normal map")


@dataclass(frozen=True, kw_only=True, eq=False)
class SourceMesh:
    """A mesh file that is copied into the package unchanged: OBJ with its MTL and images.

    ``T_object_file`` is the rigid placement and ``scale`` the uniform factor to metres.
    """

    path: Path
    T_object_file: Float[np.ndarray, "4 4"]
    scale: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Visual:
    """One visual element of a link, with the part it belongs to.

    ``finish`` is the role of its surface in the object (front, handle), as in
    `artigen.shapes.surfaces.palette`; "" where that is unknown. The visuals of a part are closed together.
    """

    name: str
    part: str
    label: PartLabel
    mesh: Mesh | SourceMesh
    finish: str = ""

    @property
    def look(self) -> str:
        """Name of its material: what it is, or the visual's own where that is unknown."""
        named = isinstance(self.mesh, Mesh) and self.mesh.material.name
        return named or self.name


@dataclass(frozen=True, kw_only=True, eq=False)
class Hull:
    """A closed convex polyhedron, faces counter-clockwise from outside."""

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]

    def __post_init__(self) -> None:
        freeze_field(self, "vertices", np.float64, (None, 3), "hull vertices")
        freeze_field(self, "faces", np.int64, (None, 3), "hull faces")


@dataclass(frozen=True, kw_only=True, eq=False)
class Inertial:
    """Mass (kg), centre of mass (m) and inertia about it (kg m^2), in object axes."""

    mass: float
    com: Float[np.ndarray, "3"]
    inertia: Float[np.ndarray, "3 3"]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Link(Brief):
    """A rigid body: a movable part together with everything fixed to it.

    ``label`` and ``parts`` (names, the movable part first) come from the asset. In a foreign package,
    ``label`` is None if its semantics name no known label. ``splats`` are the optional Gaussians of the link;
    their part ids are indices of the package's links. ``visual_error`` is the largest distance (m) between
    bodies of the visuals and the exact solids that they show, measured from either; None where there are no
    such solids.
    """

    name: str
    label: PartLabel | None = None
    parts: tuple[str, ...] = ()
    visuals: tuple[Visual, ...] = ()
    hulls: tuple[Hull, ...] = ()
    inertial: Inertial | None = None
    splats: Gaussians | None = None
    visual_error: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class HandleAnnotation:
    """Grasp of a link for a hand or gripper; object frame at rest, metres.

    ``corners`` are the eight corners of the handle's box, ``normal`` points away from the panel that carries
    it, ``grasp_line`` is the segment that closing fingers straddle, ``width`` is the extent between the
    fingers, ``clearance`` is the free depth behind the handle (0 for a knob on a plate), and
    ``opening_direction`` is the handle's velocity as the joint starts to open.
    """

    link: str
    part: str
    corners: Float[np.ndarray, "8 3"]
    normal: Float[np.ndarray, "3"]
    grasp_line: Float[np.ndarray, "2 3"]
    width: float
    clearance: float
    opening_direction: Float[np.ndarray, "3"]
    gapart: str


@dataclass(frozen=True, kw_only=True)
class Proof:
    """How far a gripper that held a grasp took its joint in an engine, as a share of the grasp's stroke, and
    whether both fingers still touched the link then. A loose object is lifted by a height instead."""

    engine: str
    opened: float
    held: bool

    @property
    def passed(self) -> bool:
        """Held, and moved by `PROVEN` of the stroke."""
        return self.held and self.opened >= PROVEN


PROVEN = 0.9
"""Share of its stroke by which a proven grasp moves a joint."""
WHOLE = (0.0, 1.0)
"""The stroke of a grasp that opens a joint in one go."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Grasp:
    """Place where a parallel gripper holds a link.

    ``pose`` is that of the point between the middles of the finger pads, in the object frame at rest: z is
    the direction of approach, y that in which the fingers close. ``width`` is the distance (m) of the pads
    as they touch, ``score`` lies in [0, 1]. ``part`` is what is held, ``joint`` what opens as the gripper
    moves with the link, "" for a loose object, which is lifted. ``stroke`` are the shares of that joint's
    range at which the gripper takes hold and lets go; another grasp takes over from there.
    """

    link: str
    part: str
    joint: str
    gripper: str
    pose: Float[np.ndarray, "4 4"]
    width: float
    score: float
    stroke: tuple[float, float] = WHOLE
    proofs: tuple[Proof, ...] = ()

    @property
    def proven(self) -> bool:
        """Tried, and passed in every engine that tried it; engines stop at the first failure."""
        return bool(self.proofs) and all(proof.passed for proof in self.proofs)


@dataclass(frozen=True, kw_only=True, eq=False)
class Requirement:
    """``joint`` moves freely only after ``needs`` has been opened to at least ``fraction`` of its range."""

    joint: str
    needs: str
    fraction: float


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SimPackage(Brief):
    """An object ready for simulation: links, joints, handles, opening order, materials, provenance.

    The first of the ``links`` is the root; ``joints`` are in the order of their child links. ``records``
    lists what each stage repaired or omitted, one sentence each.
    """

    name: str
    category: str
    visual: VisualSource
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    handles: tuple[HandleAnnotation, ...] = ()
    requires_open: tuple[Requirement, ...] = ()
    grasps: tuple[Grasp, ...] = ()
    materials: tuple[tuple[str, str], ...] = ()
    provenance: tuple[tuple[str, str], ...] = ()
    records: tuple[str, ...] = ()
    visual_format: VisualFormat = "obj"
