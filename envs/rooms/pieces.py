"""Pieces of furniture, and clusters of pieces side by side, as boxes in one frame.

A cluster's frame is like an object's: fronts face -x, backs are at x = 0, y runs along the cluster from 0, z
up from the floor. Boxes are rows (low, high), metres.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import transform_points

from .catalogue import Entry
from .footprints import Footprint, bounds_of, read_footprint, standing_places
from .room import ROBOT_HEIGHT, turn_matrix

GAP = 0.003
"""Distance (m) between neighbours, and between an object and the floor or wall behind it."""
WIDER_GAPS = (GAP, 0.02, 0.05, 0.08, 0.12, 0.2, 0.3)
"""Gaps tried in this order until neighbours can open."""
TOUCH = 2e-4
"""Smallest overlap (m) along every axis at which boxes count as overlapping."""
ALIGN = 0.15
"""Largest distance (m) of a piece from the wall for aligning its front."""


def _none() -> Float[np.ndarray, "0 2 3"]:
    return np.zeros((0, 2, 3))


@dataclass(frozen=True, kw_only=True, eq=False)
class Boxes:
    """``bodies`` are solid; ``sweeps`` and ``stands`` must stay free of other bodies."""

    bodies: Float[np.ndarray, "N 2 3"]
    sweeps: Float[np.ndarray, "K 2 3"] = field(default_factory=_none)
    stands: Float[np.ndarray, "S 2 3"] = field(default_factory=_none)

    @property
    def all(self) -> Float[np.ndarray, "A 2 3"]:
        """The boxes of all three kinds."""
        return np.concatenate([self.bodies, self.sweeps, self.stands])

    def change(self, function: Callable[[np.ndarray], np.ndarray]) -> "Boxes":
        """Applies a function to the boxes of each kind."""
        return Boxes(bodies=function(self.bodies), sweeps=function(self.sweeps), stands=function(self.stands))


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """A package in a role (or, without an entry, a fitting), with the space that it takes."""

    role: str
    entry: Entry | None
    boxes: Boxes
    face: float
    """x of its front without handles."""
    footprint: Footprint | None = None
    front: float | None = None
    """x of the front of the piece below it, if any, which determines the standing place."""

    @property
    def box(self) -> Float[np.ndarray, "2 3"]:
        """Bounds of the body."""
        return bounds_of(self.boxes.bodies)


@dataclass(frozen=True, kw_only=True, eq=False)
class Member:
    """A piece with its place in the cluster."""

    piece: Piece
    T: Float[np.ndarray, "4 4"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Cluster:
    """Members in one frame, with all their boxes; ``length`` along y and ``depth`` along x, from 0."""

    name: str
    members: tuple[Member, ...]
    boxes: Boxes
    length: float
    depth: float


def make_piece(
    entry: Entry, role: str, radius: float, front: float | None = None, elevation: float = GAP
) -> Piece:
    """A package as a piece; ``radius`` is the robot's, ``front`` x of the piece below it, and ``elevation``
    the height of its underside above the floor."""
    footprint = read_footprint(entry.folder)
    places = standing_places(footprint, radius, front)
    floor = footprint.body[0, 2] - elevation
    stands = np.zeros((len(places), 2, 3))
    stands[:, 0, :2], stands[:, 1, :2] = places - radius, places + radius
    stands[:, :, 2] = floor + 0.02, floor + ROBOT_HEIGHT
    return Piece(
        role=role,
        entry=entry,
        boxes=Boxes(bodies=footprint.solid, sweeps=footprint.sweeps, stands=stands),
        face=footprint.face,
        footprint=footprint,
        front=front,
    )


def move_boxes(boxes: Boxes, T: Float[np.ndarray, "4 4"]) -> Boxes:
    """Moves boxes by quarter turns and a translation."""

    def moved(rows: Float[np.ndarray, "N 2 3"]) -> Float[np.ndarray, "N 2 3"]:
        corners = transform_points(T, rows)
        return np.stack([corners.min(axis=1), corners.max(axis=1)], axis=1)

    return boxes.change(moved)


def shift_boxes(boxes: Boxes, shift: Float[np.ndarray, "3"]) -> Boxes:
    """Translates boxes, which is much cheaper."""
    return boxes.change(lambda rows: rows + shift)


def join_boxes(parts: Sequence[Boxes]) -> Boxes:
    """Concatenates boxes."""
    return Boxes(
        bodies=np.concatenate([_none(), *(part.bodies for part in parts)]),
        sweeps=np.concatenate([_none(), *(part.sweeps for part in parts)]),
        stands=np.concatenate([_none(), *(part.stands for part in parts)]),
    )


def overlap(first: Float[np.ndarray, "N 2 3"], second: Float[np.ndarray, "M 2 3"]) -> bool:
    """Whether a box of one set overlaps a box of the other."""
    if not len(first) or not len(second):
        return False
    near = second[_shared(bounds_of(first)[None], second)[0]]  # most boxes of a room are elsewhere
    return bool(_shared(first, near).any())


def _shared(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Mask (N M) of overlapping boxes."""
    low = np.maximum(first[:, None, 0], second[None, :, 0])
    high = np.minimum(first[:, None, 1], second[None, :, 1])
    return np.all(high - low > TOUCH, axis=2)


def conflict(first: Boxes, second: Boxes) -> bool:
    """Whether bodies overlap, or a body stands in space that the other keeps free."""
    return (
        overlap(first.bodies, second.bodies)
        or overlap(first.sweeps, second.bodies)
        or overlap(first.bodies, second.sweeps)
        or overlap(first.stands, second.bodies)
        or overlap(first.bodies, second.stands)
    )


def line_up(name: str, pieces: Sequence[Piece], height: float | None = None) -> Cluster:
    """Places pieces side by side in order, with aligned fronts if possible and the smallest gaps that let all
    of them open.

    Args:
        pieces: At least one piece.
        height: Height of the undersides above the floor; None places them on it.
    """
    depths = [float(piece.box[1, 0] - piece.face) for piece in pieces]
    front = max(depths)
    members: list[Member] = []
    placed: list[Boxes] = []
    end = 0.0
    for piece, depth in zip(pieces, depths, strict=True):
        box = piece.box
        back = front - depth if front - depth <= ALIGN else 0.0
        lift = GAP if piece.entry is not None else 0.0
        T = np.eye(4)
        T[0, 3] = -box[1, 0] - back
        T[2, 3] = (height if height is not None else lift) - box[0, 2]
        T[1, 3] = end - box[0, 1]
        gap = _least_gap(piece, T, placed) if members else 0.0
        T[1, 3] += gap
        boxes = move_boxes(piece.boxes, T)
        members.append(Member(piece=piece, T=T))
        placed.append(boxes)
        end = float(boxes.bodies[:, 1, 1].max())
    boxes = join_boxes(placed)
    deep = float(-boxes.bodies[:, 0, 0].min())
    return Cluster(name=name, members=tuple(members), boxes=boxes, length=end, depth=deep)


def _least_gap(piece: Piece, T: Float[np.ndarray, "4 4"], placed: Sequence[Boxes]) -> float:
    """The smallest of the gaps without conflict, or else the widest."""
    for gap in WIDER_GAPS:
        boxes = shift_boxes(move_boxes(piece.boxes, T), np.array([0.0, gap, 0.0]))
        if not any(conflict(boxes, other) for other in placed):
            return gap
    return WIDER_GAPS[-1]


def back_to_back(name: str, near: Cluster, far: Cluster) -> Cluster:
    """Two clusters back to back, the second one turned around."""
    turned = turn_matrix(np.pi)
    turned[:3, 3] = (2 * GAP, (near.length + far.length) / 2.0, 0.0)
    members = [replace(member, T=turned @ member.T) for member in far.members]
    low = min(0.0, (near.length - far.length) / 2.0)
    shift = np.eye(4)
    shift[:3, 3] = (-2 * GAP - far.depth, -low, 0.0)
    both = [replace(member, T=shift @ member.T) for member in (*near.members, *members)]
    boxes = join_boxes([move_boxes(member.piece.boxes, member.T) for member in both])
    return Cluster(
        name=name,
        members=tuple(both),
        boxes=boxes,
        length=max(near.length, far.length),
        depth=near.depth + far.depth + 2 * GAP,
    )


def widened(boxes: Float[np.ndarray, "N 2 3"], margin: float) -> Float[np.ndarray, "N 2 3"]:
    """Boxes grown by a margin to all sides along the floor."""
    grown = boxes.copy()
    grown[:, 0, :2] -= margin
    grown[:, 1, :2] += margin
    return grown
