"""The values that travel between stages: parts, joints, voxels, surface samples, assets.

Everything is a frozen dataclass over read-only numpy arrays, checked on construction, in the
conventions of CONVENTIONS.md: z up, front faces -x, unit cube [-0.5, 0.5]^3, radians, and
``q = 0`` the closed rest pose. Lengths inside an `Asset` are unit-cube lengths;
``Asset.scale`` (metres per unit) is the only place where metres enter.
"""

from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

PartLabel = Literal["base", "drawer", "door", "handle", "knob", "tray", "shelf", "wheel"]
JointType = Literal["fixed", "revolute", "prismatic", "continuous", "screw"]
RoomKind = Literal["kitchen", "office", "bedroom", "bathroom", "workshop", "living_room", "hall", "laundry"]
SceneKind = Literal[RoomKind, "flat"]
Clutter = Literal["none", "tidy", "lived", "messy"]
"""Amount of loose things on furniture."""

PART_LABELS: tuple[PartLabel, ...] = get_args(PartLabel)
JOINT_TYPES: tuple[JointType, ...] = get_args(JointType)
FULL_TURN = 2.0 * np.pi
ENDLESS: tuple[JointType, ...] = ("continuous", "screw")
"""Joints without limits in a simulation."""


def frozen_array(value: object, dtype: type, shape: tuple[int | None, ...], name: str):
    """Copies ``value`` into a read-only array; raises `ValueError` on a wrong shape or NaN."""
    array = np.array(value, dtype=dtype)
    fits = array.ndim == len(shape) and all(
        want is None or have == want for have, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        wanted = " x ".join("any" if want is None else str(want) for want in shape)
        raise ValueError(f"{name}: shape {array.shape}, expected {wanted}")
    if np.issubdtype(array.dtype, np.floating) and not np.isfinite(array).all():
        raise ValueError(f"{name}: holds NaN or infinite values")
    array.setflags(write=False)
    return array


def freeze_field(owner: object, name: str, dtype: type, shape: tuple[int | None, ...], what: str):
    """Replaces a field of a frozen dataclass by its `frozen_array`, and returns that."""
    array = frozen_array(getattr(owner, name), dtype, shape, what)
    object.__setattr__(owner, name, array)
    return array


@dataclass(frozen=True, kw_only=True, eq=False)
class Joint:
    """Motion of a part or link relative to the one that carries it, in the object frame at rest.

    The coordinate ``q`` is an angle in radians for revolute, continuous and screw joints and a
    length for prismatic ones, in the unit of the object: metres, or those of the unit cube in an
    `Asset`. ``q = 0`` is closed and positive ``q`` opens. A continuous joint states ``[0, 2 pi]``
    but is not limited by it. A screw rotates by ``q`` and at the same time travels ``pitch * q``
    along its axis; in a package it consists of two joints in a row (``of_screw``), of which the
    second one is prismatic and follows the first.

    ``follows`` names what drives this joint, as a pedal does a lid: a part of a shape, a joint of a
    package. The coordinate is ``ratio`` times that of the leader, plus ``offset`` (m or rad).
    ``spring`` is a force (N) or torque (N m) that closes the joint, twice as large at the upper limit
    as at 0; a negative one, as in the hinges of heavy lids, opens it, a third as large at the upper
    limit as at 0. ``stays`` is for hinges that hold the part wherever it is left, by friction or a
    counterbalance. ``friction`` is a force (N) or torque (N m), ``damping`` is in N s/m or N m s/rad.
    Parts of an `Asset` have none of these. ``name``, ``parent`` and ``child`` are those of a package:
    the joint and its links.
    """

    type: JointType
    axis: Float[np.ndarray, "3"]
    origin: Float[np.ndarray, "3"] = field(default_factory=lambda: np.zeros(3))
    lower: float = 0.0
    upper: float = 0.0
    pitch: float = 0.0
    follows: str | None = None
    ratio: float = 0.0
    offset: float = 0.0
    spring: float = 0.0
    stays: bool = False
    friction: float = 0.0
    damping: float = 0.0
    effort: float = 100.0
    velocity: float = 1.0
    of_screw: bool = False
    name: str = ""
    parent: str = ""
    child: str = ""

    def __post_init__(self) -> None:
        if self.type not in JOINT_TYPES:
            raise ValueError(f"joint type {self.type!r} is not one of {', '.join(JOINT_TYPES)}")
        axis = freeze_field(self, "axis", np.float64, (3,), "joint axis")
        if abs(np.linalg.norm(axis) - 1.0) > 1e-6:
            raise ValueError(f"joint axis {axis.tolist()} has length {np.linalg.norm(axis):.9g}, expected 1")
        freeze_field(self, "origin", np.float64, (3,), "joint origin")
        if not np.isfinite([self.lower, self.upper, self.pitch]).all():
            raise ValueError(f"joint limits [{self.lower}, {self.upper}], pitch {self.pitch}: must be finite")
        if not np.isfinite([self.friction, self.damping, self.spring, self.ratio, self.offset]).all():
            raise ValueError(
                f"joint friction {self.friction}, damping {self.damping}, spring {self.spring}, ratio "
                f"{self.ratio}, offset {self.offset}: must be finite"
            )
        if self.lower > self.upper:
            raise ValueError(f"joint limits: lower {self.lower} is above upper {self.upper}")
        if self.type == "fixed" and (self.lower, self.upper) != (0.0, 0.0):
            raise ValueError(f"a fixed joint has limits [{self.lower}, {self.upper}], expected [0, 0]")
        if self.pitch != 0.0 and self.type != "screw":
            raise ValueError(f"a {self.type} joint has pitch {self.pitch}; only screws have one")
        if self.stays and self.type != "revolute":
            raise ValueError(f"a {self.type} joint stays; only hinges with limits do")

    def __eq__(self, other: object) -> bool:
        """Whether all values are equal."""
        return isinstance(other, Joint) and _list_values(self) == _list_values(other)

    def __hash__(self) -> int:
        return hash(_list_values(self))

    @property
    def kind(self) -> JointType:
        """Type of the object's joint: ``screw`` for both joints of a package's screw."""
        return "screw" if self.of_screw else self.type

    @property
    def is_travel(self) -> bool:
        """Whether this is the second joint of a package's screw."""
        return self.of_screw and self.follows is not None

    def follow(self, q: Any) -> Any:
        """Coordinate of a follower (m or rad) where that of its leader is ``q``, a number or an array."""
        return self.ratio * q + self.offset

    def pull(self, q: Any) -> Any:
        """Effort of the spring (N or N m) at the coordinate ``q``, a number or an array; > 0 opens."""
        return -(self.spring + self.stiffness * q)

    @property
    def stiffness(self) -> float:
        """Stiffness of the spring, N/m or N m/rad."""
        return -self.spring / self.relaxed if self.spring != 0.0 else 0.0

    @property
    def relaxed(self) -> float:
        """Coordinate (m or rad) at which the spring is relaxed."""
        return -self.upper if self.spring >= 0.0 else 1.5 * self.upper


def _list_values(joint: Joint) -> tuple[object, ...]:
    return tuple(tuple(v.tolist()) if isinstance(v, np.ndarray) else v for v in vars(joint).values())


FIXED = Joint(type="fixed", axis=np.array([0.0, 0.0, 1.0]))


@dataclass(frozen=True, kw_only=True, eq=False)
class Part:
    """One rigid piece with a label: a drawer, its handle, a shelf.

    ``parent`` indexes ``Asset.parts`` (-1 for the one root). ``box`` is (centre, size) of the
    part's own geometry at rest, children excluded, in unit-cube lengths.
    """

    name: str
    label: PartLabel
    parent: int
    joint: Joint
    box: Float[np.ndarray, "2 3"]

    def __post_init__(self) -> None:
        if self.label not in PART_LABELS:
            raise ValueError(
                f"part {self.name!r}: label {self.label!r} is not one of {', '.join(PART_LABELS)}"
            )
        box = freeze_field(self, "box", np.float64, (2, 3), f"part {self.name!r}: box")
        if (box[1] < 0).any():
            raise ValueError(f"part {self.name!r}: box size {box[1].tolist()} is negative")
        if self.joint.follows is not None or self.joint.spring != 0.0 or self.joint.stays:
            raise ValueError(
                f"part {self.name!r}: a joint of an asset follows nothing and has no spring or stay"
            )


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelGrid:
    """Occupied surface cells at rest; cell (i, j, k) covers [i, i+1] / resolution - 0.5."""

    resolution: int
    coords: Int[np.ndarray, "N 3"]
    part_ids: Int[np.ndarray, "N"]

    def __post_init__(self) -> None:
        coords = freeze_field(self, "coords", np.int16, (None, 3), "voxel coords")
        freeze_field(self, "part_ids", np.int16, (len(coords),), "voxel part ids")
        if len(coords) and (coords.min() < 0 or coords.max() >= self.resolution):
            raise ValueError(
                f"voxel coords span {coords.min()}..{coords.max()}, grid is 0..{self.resolution - 1}"
            )

    def occupied(self) -> Bool[np.ndarray, "X Y Z"]:
        """Dense mask of the occupied cells."""
        cells = np.zeros((self.resolution,) * 3, dtype=bool)
        cells[tuple(self.coords.T)] = True
        return cells

    def part_grid(self) -> Int[np.ndarray, "X Y Z"]:
        """Part of every cell; -1 where there is none."""
        parts = np.full((self.resolution,) * 3, -1)
        parts[tuple(self.coords.T)] = self.part_ids
        return parts

    def centers(self) -> Float[np.ndarray, "N 3"]:
        """Cell centres in the unit cube."""
        return (self.coords + 0.5) / self.resolution - 0.5


@dataclass(frozen=True, kw_only=True, eq=False)
class SurfaceSamples:
    """Points drawn uniformly by area from a coloured surface, with the part they lie on.

    Every point stands for the same area, so counting points measures area. Samples stand in for a
    source mesh wherever its colours or positions are needed: voxel labels by majority, texture
    baking, distances.
    """

    points: Float[np.ndarray, "N 3"]
    normals: Float[np.ndarray, "N 3"]
    colors: UInt8[np.ndarray, "N 3"]
    part_ids: Int[np.ndarray, "N"]

    def __post_init__(self) -> None:
        n = len(freeze_field(self, "points", np.float32, (None, 3), "surface points"))
        freeze_field(self, "normals", np.float32, (n, 3), "surface normals")
        freeze_field(self, "colors", np.uint8, (n, 3), "surface colors")
        freeze_field(self, "part_ids", np.int16, (n,), "surface part ids")


@dataclass(frozen=True, kw_only=True, eq=False)
class Gaussians:
    """3D Gaussians in the unit cube, as physical values, not as encodings.

    ``scales`` are standard deviations in unit-cube lengths, ``opacities`` lie in [0, 1],
    ``quats`` are wxyz and unit, ``colors`` linear RGB in [0, 1] (degree-0 harmonics).
    """

    means: Float[np.ndarray, "N 3"]
    quats: Float[np.ndarray, "N 4"]
    scales: Float[np.ndarray, "N 3"]
    opacities: Float[np.ndarray, "N"]
    colors: Float[np.ndarray, "N 3"]
    part_ids: Int[np.ndarray, "N"]

    def __post_init__(self) -> None:
        n = len(freeze_field(self, "means", np.float32, (None, 3), "Gaussian means"))
        for name, width in (("quats", 4), ("scales", 3), ("colors", 3)):
            freeze_field(self, name, np.float32, (n, width), f"Gaussian {name}")
        freeze_field(self, "opacities", np.float32, (n,), "Gaussian opacities")
        freeze_field(self, "part_ids", np.int16, (n,), "Gaussian part ids")
        lengths = np.linalg.norm(self.quats, axis=1)
        if n and np.abs(lengths - 1.0).max() > 1e-4:
            raise ValueError(
                f"Gaussian quats: lengths span {lengths.min():.6g}..{lengths.max():.6g}, expected 1"
            )


@dataclass(frozen=True, kw_only=True, eq=False)
class Asset:
    """An articulated object: parts in a tree, and the geometry that stages have produced so far.

    ``scale`` is metres per unit-cube length. ``notes`` lists everything that earlier stages repaired,
    snapped or dropped, one sentence each.
    """

    name: str
    category: str
    scale: float
    parts: tuple[Part, ...]
    voxels: VoxelGrid | None = None
    surface: SurfaceSamples | None = None
    gaussians: Gaussians | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.parts:
            raise ValueError(f"asset {self.name!r} has no parts")
        if not (np.isfinite(self.scale) and self.scale > 0):
            raise ValueError(f"asset {self.name!r}: scale {self.scale} metres per unit, expected > 0")
        check_tree(self.name, [part.name for part in self.parts], [part.parent for part in self.parts])
        for label, holder in (
            ("voxel", self.voxels),
            ("surface", self.surface),
            ("Gaussian", self.gaussians),
        ):
            ids = None if holder is None else holder.part_ids
            if ids is not None and len(ids) and (ids.min() < 0 or ids.max() >= len(self.parts)):
                raise ValueError(
                    f"asset {self.name!r}: {label} part ids span {ids.min()}..{ids.max()}, "
                    f"parts are 0..{len(self.parts) - 1}"
                )

    @property
    def root(self) -> int:
        """Index of the one part without a parent."""
        return next(index for index, part in enumerate(self.parts) if part.parent == -1)


def check_tree(owner: str, names: list[str], parents: list[int]) -> None:
    """Raises `ValueError` unless ``parents`` describe one tree over unique ``names``."""
    if len(set(names)) != len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise ValueError(f"asset {owner!r}: part names occur twice: {', '.join(twice)}")
    roots = [name for name, parent in zip(names, parents, strict=True) if parent == -1]
    if len(roots) != 1:
        raise ValueError(f"asset {owner!r}: {len(roots)} roots ({', '.join(roots) or 'none'}), expected one")
    for index, name in enumerate(names):
        seen = {index}
        at = parents[index]
        while at != -1:
            if not 0 <= at < len(names):
                raise ValueError(
                    f"asset {owner!r}: part {name!r} has parent {at}, parts are 0..{len(names) - 1}"
                )
            if at in seen:
                raise ValueError(f"asset {owner!r}: part {name!r} is its own ancestor")
            seen.add(at)
            at = parents[at]
