"""`Piece`: one solid of a sketch at the level at which people name solids: a box, a rod, a tapered leg, a
ring.

Numbers are lengths and coordinates in metres, in the order of `NUMBERS`: six for the bounds of the solid
(lowest, then highest corner) and up to four more, by kind. ``u`` and ``v`` are the axes after the piece's own
axis, in cyclic order.
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
cylinder  bounds, square across the axis
frustum   bounds of the end at the top of its axis (span along the axis), then the rectangle of the other end;
          with more than four sides both rectangles are squares around a circle through the corners
prism     span along the axis; its four corners (u, v): the first in the low corner, the third in the high
          corner, then the second and the fourth
ring      span along the axis and the square around the outer circle of its far end; inner radii at both ends,
          outer radius of the near end
spokes    as ring, but boxes: inner radius and half their width
plate     bounds; centre and radius of a round hole along x
slab      bounds of a box with some edges along its axis cut by an arc of `sides` straight segments (one for a
          chamfer); length of the arc along u and v, at most half an edge that two cut corners share
shell     bounds; rounding of all four edges along the axis, along u at its low and at its high end (equal
along
          v, at most to the middle); inset of one end on every side, positive for the low end and negative for
          the high end; thickness of the wall around the hollow, which is open at both ends, 0 for a solid
elbow     bounds of a quarter of a bent round tube, square across its axis; the tube's diameter is the span
          along the axis
"""
SQUARE_KINDS: tuple[PieceKind, ...] = ("cylinder", "ring", "spokes", "elbow")
"""Kinds with equal extents along both axes across their own."""
ROUND_SIDES = (10, 16)
"""Numbers of corners with which a frustum's ends represent circles."""
MIN_WEDGES = 8
"""Smallest number of wedges of a ring."""
MAX_PIECES_OF_ARC = 8
"""Largest number of straight segments in a quarter arc of a slab, shell or elbow."""
CORNER_ENDS = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Corners across an axis by their ends along u and v, 0 for the low one; counterclockwise. The cut corners of
a slab are bits of one number."""
CORNERS = len(CORNER_ENDS)
LINED: tuple[Vector, ...] = (
    (1.0, 0.0, 0.0),
    (-1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, -1.0, 0.0),
    (0.0, 0.0, 1.0),
    (0.0, 0.0, -1.0),
)
"""Sides that can carry a lining; one further index stands for the inside of a ring, hole or shell."""
INWARD = len(LINED)
TOLERANCE = 1e-6
"""Distance (m) within which a fitted piece must reproduce the corners of its primitives."""


class UnknownSolid(ValueError):
    """A primitive that no kind of piece represents."""


@dataclass(frozen=True, kw_only=True)
class Piece:
    """One solid; numbers in metres for a shape, in grid steps for a sketch."""

    kind: PieceKind
    finish: str
    numbers: tuple[float, ...]
    lining: str | None = None
    lined: int | None = None
    """Index into `LINED`, or `INWARD`."""
    axis: int = 0
    """Own axis of all kinds but boxes and plates: 0 to 2 for x to z."""
    sides: int = 0
    """Corners of a frustum's ends, wedges of a ring, number of spokes, or segments of the arcs of a slab,
    shell or elbow."""
    phase: int = 0
    """Spokes: rotation in half steps from the first axis across, 0 or 1."""
    corners: int = 0
    """Slab: cut corners, corner k as bit k. Elbow: the corner of the bounds about which it bends."""

    def __post_init__(self) -> None:
        if len(self.numbers) != len(NUMBERS[self.kind]):
            raise ValueError(
                f"a {self.kind} with {len(self.numbers)} numbers, expected {len(NUMBERS[self.kind])}"
            )
        if (self.lining is None) != (self.lined is None):
            raise ValueError("a piece needs both a lining and a lined side, or neither")

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
    """The two axes after ``axis``, in cyclic order."""
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
    """Finish and lining of a piece."""

    finish: str
    lining: str | None
    lined: int | None


def lined_inward(primitive: Primitive) -> Surface:
    """Surface of a piece around a hollow, lined inwards if its primitives are lined."""
    lined = None if primitive.lining is None else INWARD
    return Surface(finish=primitive.finish, lining=primitive.lining, lined=lined)
