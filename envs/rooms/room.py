"""A furnished room as a value: placed objects and walls, in metres.

The room's frame has its origin in a corner of the floor; x runs along the front wall, y to the back, z up. A
wall is named by its side: ``front`` (y = 0), ``back``, ``left`` (x = 0), ``right``. Objects keep the frame of
their packages (front -x) and, against a wall, face the room.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.transforms import matrix_from_quat, quat_from_matrix
from artigen.types import RoomKind, SceneKind

from .patterns import Pattern

Side = Literal["front", "back", "left", "right"]
SIDES: tuple[Side, ...] = ("front", "back", "left", "right")
YAWS: dict[Side, float] = {"front": -np.pi / 2, "back": np.pi / 2, "left": np.pi, "right": 0.0}
"""Rotation about z (radians) that places an object's back against the wall."""
ROBOT_HEIGHT = 1.1
"""Height (m) of the space in which a robot stands."""
FLOOR_COLORS: dict[Pattern, tuple[float, float, float]] = {
    "plain": (0.63, 0.53, 0.43), "planks": (0.70, 0.55, 0.40), "tiles": (0.74, 0.72, 0.69),
    "stone": (0.60, 0.59, 0.57),
}  # fmt: skip
"""Colours of floors by what they are laid with."""
THICKNESS = 0.1
"""Thickness of walls and floor, metres."""


@dataclass(frozen=True, kw_only=True)
class Fixture:
    """A static box, or an upright cylinder in one: wall, floor, bed or trim. ``color`` is sRGB in [0, 1],
    ``pattern`` says its cover."""

    name: str
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    color: tuple[float, float, float]
    pattern: Pattern = "plain"
    shape: Literal["box", "cylinder"] = "box"


@dataclass(frozen=True, kw_only=True)
class Opening:
    """A rectangular hole in a wall; ``start`` is its nearer edge along x or y, ``bottom`` above the floor."""

    side: Side
    start: float
    width: float
    height: float
    bottom: float = 0.0

    @property
    def stop(self) -> float:
        """Its farther edge along x or y."""
        return self.start + self.width

    @property
    def top(self) -> float:
        """Height of its upper edge above the floor."""
        return self.bottom + self.height


@dataclass(frozen=True, kw_only=True)
class Placement:
    """An object in the room: ``position`` and ``quat`` (wxyz) map its package's frame to the room's.

    ``joints`` are coordinates (rad or m) of joints that are not at 0, ``standing`` the places (x, y) from
    which a robot opens its doors and drawers, ``support`` the id of the object or worktop below it, if any,
    and ``provenance`` that of its package.
    """

    id: str
    role: str
    category: str
    package: Path
    position: tuple[float, float, float]
    quat: tuple[float, float, float, float]
    size: tuple[float, float, float]
    joints: tuple[tuple[str, float], ...] = ()
    standing: tuple[tuple[float, float], ...] = ()
    support: str | None = None
    provenance: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, kw_only=True)
class Item:
    """A loose thing (`envs.rooms.things`) in a drawer or cupboard, on furniture or on the floor.

    ``position`` and ``quat`` (wxyz) place it in the frame of the object ``holder`` with all joints at 0; it
    moves with the holder's ``link``. Without a holder it stands on a fixture, in the frame of the room, and
    has an empty link.
    ``size`` are its extents before it is turned, ``mass`` is in kg, and ``colors`` (sRGB in [0, 1]) are those
    of its parts.
    """

    id: str
    thing: str
    holder: str | None
    link: str
    position: tuple[float, float, float]
    quat: tuple[float, float, float, float]
    size: tuple[float, float, float]
    mass: float
    colors: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True, kw_only=True)
class Zone:
    """A room of a flat: the corners (x, y) of its floor, metres,."""

    name: str
    kind: RoomKind
    low: tuple[float, float]
    high: tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Room:
    """A furnished room, or a flat, whose ``zones`` are its rooms.

    ``size`` is width (x), depth (y) and height. ``openings`` are those of the walls besides the entrance.
    ``standing_radius`` is that of the robot's free space, 0 if disabled. ``attempt`` counts the arrangements
    that were rejected before this one. ``contents`` lie in the drawers and cupboards.
    """

    kind: SceneKind
    seed: int
    attempt: int
    size: tuple[float, float, float]
    entrance: Opening
    standing_radius: float
    fixtures: tuple[Fixture, ...]
    placements: tuple[Placement, ...]
    provenance: tuple[tuple[str, str], ...] = ()
    contents: tuple[Item, ...] = ()
    openings: tuple[Opening, ...] = ()
    zones: tuple[Zone, ...] = ()

    @property
    def doorways(self) -> tuple[Opening, ...]:
        """Openings to the neighbours in a flat, whose doors are theirs; all other openings are windows."""
        return tuple(hole for hole in self.openings if hole.bottom == 0.0)

    @property
    def windows(self) -> tuple[Opening, ...]:
        """Openings that do not reach the floor."""
        return tuple(hole for hole in self.openings if hole.bottom > 0.0)

    def placement(self, name: str) -> Placement:
        """The object with that id; raises `ValueError` with the existing ids."""
        for placement in self.placements:
            if placement.id == name:
                return placement
        known = ", ".join(placement.id for placement in self.placements)
        raise ValueError(f"the {self.kind} has no object {name!r}; it has {known}")


def pose_matrix_of(placement: Placement | Item) -> Float[np.ndarray, "4 4"]:
    """Pose of an object's frame in the room, or of an item's frame in its holder's."""
    T = np.eye(4)
    T[:3, :3] = matrix_from_quat(np.array(placement.quat))
    T[:3, 3] = placement.position
    return T


def turn_matrix(yaw: float) -> Float[np.ndarray, "4 4"]:
    """A rotation about z by a multiple of a quarter turn, with entries of exactly 0 and 1."""
    cos, sin = np.round(np.cos(yaw)), np.round(np.sin(yaw))
    T = np.eye(4)
    T[:2, :2] = [[cos, -sin], [sin, cos]]
    return T


def wall_axis(side: Side) -> int:
    """Axis along which a wall runs: 0 (x) or 1 (y)."""
    return 0 if side in ("front", "back") else 1


def wall_length(side: Side, size: Sequence[float]) -> float:
    """Length (m) of a wall of a room of that size."""
    return size[wall_axis(side)]


def along_wall(side: Side, size: Sequence[float], low: Sequence[float], high: Sequence[float]) -> np.ndarray:
    """Converts a box (2 3) from (along the wall, out of the wall, up) to the room.

    "Along" runs in the direction of x or y, whichever the wall follows.
    """
    axis, box = wall_axis(side), np.array([low, high], dtype=np.float64)
    if side in ("back", "right"):
        box[:, 1] = size[1 - axis] - box[::-1, 1]
    return box if axis == 0 else box[:, [1, 0, 2]]


def from_wall(side: Side, size: Sequence[float], boxes: Float[np.ndarray, "N 2 3"]) -> np.ndarray:
    """Converts boxes from the room to (along the wall, out of the wall, up)."""
    axis = wall_axis(side)
    turned = boxes.copy() if axis == 0 else boxes[..., [1, 0, 2]]
    if side in ("back", "right"):
        turned[..., 1] = size[1 - axis] - turned[..., ::-1, 1]
    return turned


def room_shell(
    size: tuple[float, float, float],
    openings: Sequence[Opening],
    color: tuple[float, float, float],
    floor: Pattern = "plain",
    wall: Pattern = "plain",
    thickness: Mapping[Side, float] | None = None,
) -> tuple[Fixture, ...]:
    """Floor and walls of the room; walls with openings are in pieces.

    ``thickness`` (m) of each wall; default: `THICKNESS`.
    """
    (width, depth, height), thick = size, thickness or dict.fromkeys(SIDES, THICKNESS)
    shell = [
        Fixture(
            name="floor",
            low=(-thick["left"], -thick["front"], -THICKNESS),
            high=corner(np.array([width + thick["right"], depth + thick["back"], 0.0])),
            color=FLOOR_COLORS[floor],
            pattern=floor,
        )
    ]
    for side in SIDES:
        first, last = ("left", "right") if wall_axis(side) == 0 else ("front", "back")
        ends = -thick[first], wall_length(side, size) + thick[last]
        pieces = _cut_wall(ends, height, [hole for hole in openings if hole.side == side])
        for index, (start, stop, bottom, top) in enumerate(pieces):
            box = along_wall(side, size, (start, -thick[side], bottom), (stop, 0.0, top))
            name = f"wall_{side}" if len(pieces) == 1 else f"wall_{side}_{index}"
            shell.append(
                Fixture(name=name, low=corner(box[0]), high=corner(box[1]), color=color, pattern=wall)
            )
    return tuple(shell)


def _cut_wall(
    ends: tuple[float, float], height: float, holes: Sequence[Opening]
) -> list[tuple[float, float, float, float]]:
    """Rectangles (start, stop, bottom, top) of a wall around its openings: upright strips, cut by those that
    pass through them."""
    edges = sorted(
        {*ends, *(float(np.clip(edge, *ends)) for hole in holes for edge in (hole.start, hole.stop))}
    )
    pieces = []
    for start, stop in pairwise(edges):
        bottom = 0.0
        passing = [hole for hole in holes if hole.start < (start + stop) / 2.0 < hole.stop]
        for hole in sorted(passing, key=lambda hole: hole.bottom):
            pieces.append((start, stop, bottom, hole.bottom))
            bottom = max(bottom, hole.top)
        pieces.append((start, stop, bottom, height))
    return [piece for piece in pieces if piece[1] - piece[0] > 1e-6 and piece[3] - piece[2] > 1e-6]


def rounded_quat(R: Float[np.ndarray, "3 3"]) -> tuple[float, float, float, float]:
    """A rotation as a quaternion (wxyz), rounded to nine decimals."""
    w, x, y, z = (round(float(value), 9) + 0.0 for value in quat_from_matrix(R))
    return w, x, y, z


def corner(point: Float[np.ndarray, "3"]) -> tuple[float, float, float]:
    """A point as floats, rounded to a hundredth of a millimetre."""
    x, y, z = (round(float(value), 5) for value in point)
    return x, y, z
