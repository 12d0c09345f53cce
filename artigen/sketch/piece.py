"""`Piece`: one solid of a sketch, as a person would name it: a box, a rod, a tapered leg, a ring.

Numbers are lengths and coordinates in metres, in the order of `NUMBERS`: six that bound the solid (lowest,
then highest corner) and up to four more, by kind. ``u`` and ``v`` are the axes after the piece's own axis,
in cyclic order.
"""

from dataclasses import dataclass
from functools import cache
from typing import Literal, TypedDict, get_args

import numpy as np
from jaxtyping import Float

from artigen.shapes.primitives import Primitive, Vector

PieceKind = Literal[
    "box", "cylinder", "frustum", "prism", "ring", "spokes", "plate", "slab", "shell", "elbow"
]
PIECE_KINDS: tuple[PieceKind, ...] = get_args(PieceKind)
NUMBERS: dict[PieceKind, tuple[str, ...]] = {
    "box": ("x0", "y0", "z0", "x1", "y1", "z1", "bevel"),
    "cylinder": ("x0", "y0", "z0", "x1", "y1", "z1"),
    "frustum": ("x0", "y0", "z0", "x1", "y1", "z1", "u0", "v0", "u1", "v1"),
    "prism": ("x0", "y0", "z0", "x1", "y1", "z1", "u1", "v1", "u3", "v3"),
    "ring": ("x0", "y0", "z0", "x1", "y1", "z1", "inner0", "inner1", "outer0"),
    "spokes": ("x0", "y0", "z0", "x1", "y1", "z1", "inner", "half_width"),
    "plate": ("x0", "y0", "z0", "x1", "y1", "z1", "hole_y", "hole_z", "radius"),
    "slab": ("x0", "y0", "z0", "x1", "y1", "z1", "cut_u", "cut_v"),
    "shell": ("x0", "y0", "z0", "x1", "y1", "z1", "cut0", "cut1", "inset", "wall"),
    "elbow": ("x0", "y0", "z0", "x1", "y1", "z1"),
}
"""The numbers of each kind (m).

box       bounds; width of the bevel on each face, 0 for sharp edges
cylinder  bounds of the round solid, square across its axis
frustum   bounds of the end at the top of its axis (span along the axis), then the rectangle of the other end;
          with more than four sides both rectangles are squares around a circle through the corners
prism     span along the axis; of its four corners (u, v) the first in the low corner, the third in the high
          one, then the second and the fourth
ring      span along the axis and the square around the outer circle of its far end; inner radii at both ends,
          outer radius of the near end
spokes    as ring, of boxes: inner radius and half their width
plate     bounds; centre and radius of a round hole along x
slab      bounds of a box of which some edges along its axis are cut off by an arc of `sides` straight pieces
          (one for a chamfer); length of the arc along u and v, at most half an edge that two corners share
shell     bounds; how far all four edges along the axis are rounded, along u at its low and at its high end
          (along v as far, at most to the middle); by how much one end is narrower on every side, the low one
          for positive, the high one for negative numbers; thickness of the wall around the hollow, which is
          open at both ends, 0 for a solid
elbow     bounds of a quarter of a bent round tube, square across its axis; the tube's diameter is the span
          along the axis
"""
SQUARE_KINDS: tuple[PieceKind, ...] = ("cylinder", "ring", "spokes", "elbow")
"""Kinds that are as wide as high across their axis."""
ROUND_SIDES = (10, 16)
"""Corners of a frustum's ends that stand for circles."""
MIN_WEDGES = 8
"""Wedges that a ring has at least."""
MAX_PIECES_OF_ARC = 8
"""Straight pieces of the arc of a slab's, shell's or elbow's quarter turn."""
CORNERS = 4
"""Corners across an axis, counterclockwise from the lowest (u, v); those of a slab are bits of one number."""
LINED: tuple[Vector, ...] = (
    (1.0, 0.0, 0.0),
    (-1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, -1.0, 0.0),
    (0.0, 0.0, 1.0),
    (0.0, 0.0, -1.0),
)
"""Sides that can be lined; one more stands for the inside of a ring, hole or shell."""
INWARD = len(LINED)
TOLERANCE = 1e-6
"""Distance (m) within which a fitted piece must repeat the corners of its primitives."""


class UnknownSolid(ValueError):
    """A primitive that is none of the pieces."""


@dataclass(frozen=True, kw_only=True)
class Piece:
    """One solid; numbers in metres where it describes a shape, in grid steps where it is part of a sketch."""

    kind: PieceKind
    finish: str
    numbers: tuple[float, ...]
    lining: str | None = None
    lined: int | None = None
    """Index into `LINED`, or `INWARD`."""
    axis: int = 0
    """Of all but boxes and plates: 0 to 2 for x to z."""
    sides: int = 0
    """Corners of a frustum's ends, wedges of a ring, number of spokes, pieces of the arcs of a slab, shell or
    elbow."""
    phase: int = 0
    """Spokes: in half steps from the first axis across, 0 or 1."""
    corners: int = 0
    """Slab: its cut corners, corner k as bit k. Elbow: the corner of its bounds about which it bends."""

    def __post_init__(self) -> None:
        if len(self.numbers) != len(NUMBERS[self.kind]):
            raise ValueError(
                f"a {self.kind} of {len(self.numbers)} numbers, expected {len(NUMBERS[self.kind])}"
            )
        if (self.lining is None) != (self.lined is None):
            raise ValueError("a piece has a lining and the side it lines, or neither")

    @property
    def low(self) -> Float[np.ndarray, "3"]:
        """Lowest corner of the bounds."""
        return np.array(self.numbers[:3])

    @property
    def high(self) -> Float[np.ndarray, "3"]:
        """Highest corner of the bounds."""
        return np.array(self.numbers[3:6])

    @property
    def rest(self) -> tuple[float, ...]:
        """The numbers after the bounds."""
        return self.numbers[6:]


def across(axis: int) -> tuple[int, int]:
    """The axes after ``axis``, in cyclic order."""
    return (axis + 1) % 3, (axis + 2) % 3


@cache
def number_axes(kind: PieceKind, axis: int) -> tuple[int | None, ...]:
    """The axis along which each number is a coordinate; None for a length."""
    u, v = across(axis)
    named: dict[str, int | None] = {"x": 0, "y": 1, "z": 2, "u": u, "v": v}
    holes = {"hole_y": 1, "hole_z": 2}
    return tuple(
        named[name[0]] if name[1:] in ("0", "1", "3") and name[0] in named else holes.get(name)
        for name in NUMBERS[kind]
    )


class Surface(TypedDict):
    """Finish of a piece."""

    finish: str
    lining: str | None
    lined: int | None


def as_vector(values: Float[np.ndarray, "3"]) -> Vector:
    """A point as plain numbers."""
    return float(values[0]), float(values[1]), float(values[2])


def lined_inward(primitive: Primitive) -> Surface:
    """The surface of solids around a hollow that is lined, or is not."""
    lined = None if primitive.lining is None else INWARD
    return Surface(finish=primitive.finish, lining=primitive.lining, lined=lined)
