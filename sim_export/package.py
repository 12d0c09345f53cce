"""The simulation package as a value: what `write_package` writes and `read_package` reads.

Metres, kilograms, seconds, radians. Geometry, joint origins and inertia are all given in the
*object frame* at rest (z up, front -x); only the writers shift them into link frames, whose
origin is the joint's and whose axes are the object's.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.types import Gaussians, JointType, PartLabel, frozen_array

UrdfJointType = Literal["fixed", "revolute", "prismatic", "continuous"]
VisualSource = Literal["voxels", "source"]
URDF_JOINT_TYPES: tuple[UrdfJointType, ...] = ("fixed", "revolute", "prismatic", "continuous")


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """Triangles with shared vertices, optionally textured by per-corner coordinates.

    ``uv`` has its origin at the lower left of ``texture``, whose rows run top to bottom; a fourth channel
    says how opaque the surface is. ``color`` is the plain RGB in [0, 1] used where there is no texture.
    """

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    uv: Float[np.ndarray, "F 3 2"] | None = None
    texture: UInt8[np.ndarray, "H W C"] | None = None
    color: tuple[float, float, float] = (0.7, 0.7, 0.7)

    def __post_init__(self) -> None:
        vertices = frozen_array(self.vertices, np.float64, (None, 3), "mesh vertices")
        faces = frozen_array(self.faces, np.int64, (None, 3), "mesh faces")
        if len(faces) and (faces.min() < 0 or faces.max() >= len(vertices)):
            raise ValueError(
                f"mesh faces index {faces.min()}..{faces.max()}, vertices are 0..{len(vertices) - 1}"
            )
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)
        if (self.uv is None) != (self.texture is None):
            raise ValueError("a mesh has texture coordinates and a texture, or neither")
        if self.uv is not None:
            object.__setattr__(self, "uv", frozen_array(self.uv, np.float64, (len(faces), 3, 2), "mesh uv"))
            texture = frozen_array(self.texture, np.uint8, (None, None, None), "texture")
            if texture.shape[2] not in (3, 4):
                raise ValueError(f"a texture of {texture.shape[2]} channels, expected RGB or RGBA")
            object.__setattr__(self, "texture", texture)


@dataclass(frozen=True, kw_only=True, eq=False)
class SourceMesh:
    """A mesh file kept as it is: OBJ with its MTL and images, copied into the package.

    ``T_object_file`` is the rigid placement and ``scale`` the uniform factor to metres.
    """

    path: Path
    T_object_file: Float[np.ndarray, "4 4"]
    scale: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Visual:
    """One drawable piece of a link, with the part it came from."""

    name: str
    part: str
    label: PartLabel
    mesh: Mesh | SourceMesh


@dataclass(frozen=True, kw_only=True, eq=False)
class Hull:
    """A closed convex polyhedron, faces counter-clockwise from outside."""

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "vertices", frozen_array(self.vertices, np.float64, (None, 3), "hull vertices")
        )
        object.__setattr__(self, "faces", frozen_array(self.faces, np.int64, (None, 3), "hull faces"))


@dataclass(frozen=True, kw_only=True, eq=False)
class Inertial:
    """Mass (kg), centre of mass (m) and inertia about it (kg m^2), in object axes."""

    mass: float
    com: Float[np.ndarray, "3"]
    inertia: Float[np.ndarray, "3 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Link:
    """A rigid body: a movable part together with everything fixed to it.

    ``label`` and ``parts`` (names, the movable part first) come from the asset; a package that
    somebody else wrote has label ``None`` where its semantics say nothing we know. ``splats`` are the
    Gaussians that show the link, if there are any; their part ids count the package's links.
    """

    name: str
    label: PartLabel | None
    parts: tuple[str, ...]
    visuals: tuple[Visual, ...]
    hulls: tuple[Hull, ...]
    inertial: Inertial | None
    splats: Gaussians | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class PackageJoint:
    """A URDF joint, in the object frame at rest.

    ``friction`` is a force (N) or torque (N m), ``damping`` N s/m or N m s/rad. ``kind`` keeps the
    asset's joint type; a screw is two joints in a row, the second a prismatic one that mimics the
    first by ``mimic_multiplier`` (metres per radian). A part that follows another one (a lid its pedal)
    mimics that one's joint in the same way. ``spring`` is a force (N) or torque (N m) that closes the joint,
    twice as large at the upper limit as at 0.
    """

    name: str
    type: UrdfJointType
    kind: JointType
    parent: str
    child: str
    origin: Float[np.ndarray, "3"]
    axis: Float[np.ndarray, "3"]
    lower: float = 0.0
    upper: float = 0.0
    effort: float = 100.0
    velocity: float = 1.0
    friction: float = 0.0
    damping: float = 0.0
    mimic: str | None = None
    mimic_multiplier: float = 0.0
    spring: float = 0.0

    @property
    def is_travel(self) -> bool:
        """Whether this is the second joint of a screw."""
        return self.mimic is not None and self.kind == "screw"

    @property
    def stiffness(self) -> float:
        """Of the spring, N/m or N m/rad; it is relaxed at minus the upper limit."""
        return self.spring / self.upper if self.spring > 0.0 else 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class HandleAnnotation:
    """Where and how a hand or gripper takes hold of a link; object frame at rest, metres.

    ``corners`` are the eight corners of the handle's box, ``normal`` points away from the panel
    that carries it, ``grasp_line`` is the segment that closing fingers should straddle, ``width``
    the extent between the fingers, ``clearance`` the free depth behind the handle (0 for a knob on
    a plate), ``opening_direction`` the handle's velocity as the joint starts to open.
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Requirement:
    """``joint`` moves freely only once ``needs`` has been opened to at least ``fraction`` of its range."""

    joint: str
    needs: str
    fraction: float


@dataclass(frozen=True, kw_only=True, eq=False)
class SimPackage:
    """An object ready for simulation: links, joints, handles, opening order, materials, provenance.

    The root of the ``links`` is the body; ``joints`` are in the order of their child links.
    ``records`` lists what each stage repaired or omitted, one sentence each.
    """

    name: str
    category: str
    visual: VisualSource
    links: tuple[Link, ...]
    joints: tuple[PackageJoint, ...]
    handles: tuple[HandleAnnotation, ...] = ()
    requires_open: tuple[Requirement, ...] = ()
    materials: tuple[tuple[str, str], ...] = ()
    provenance: tuple[tuple[str, str], ...] = ()
    records: tuple[str, ...] = ()
