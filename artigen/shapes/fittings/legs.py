"""Legs of furniture: plain ones of one piece, turned ones, cabriole legs, bun feet and turned columns.

A leg is a stack of convex pieces between square or round outlines, lowest first, given as shares of its
width and height. Turned legs have a square block at the top, to which aprons are joined.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Literal, get_args

import numpy as np

from artigen.shapes.primitives import Primitive, move, polygon, polytope
from artigen.shapes.ranges import Range

LegKind = Literal["square", "tapered", "round", "splayed", "turned", "cabriole"]
LEG_KINDS: tuple[LegKind, ...] = get_args(LegKind)
ROUND_SIDES = 10
"""Sides of the prisms of round legs."""
SHORT = 0.3
"""Height (m) below which a turned leg is a bun foot."""
LEAN = 0.16
"""Outward lean of splayed legs, relative to their height."""

_Level = tuple[float, float, float]
"""Height, width and outward offset along either axis, as shares of the leg's height and width."""
_Course = tuple[int, _Level, _Level]
"""Sides of a piece, and its lower and upper end."""
SQUARE = 4
PROFILES: Mapping[str, Sequence[_Course]] = {
    "square": ((SQUARE, (0.0, 1.0, 0.0), (1.0, 1.0, 0.0)),),
    "tapered": ((SQUARE, (0.0, 0.6, 0.0), (1.0, 1.0, 0.0)),),
    "round": ((ROUND_SIDES, (0.0, 0.62, 0.0), (1.0, 1.0, 0.0)),),
    "splayed": ((ROUND_SIDES, (0.0, 0.6, 0.0), (1.0, 1.0, 0.0)),),
    "turned": (
        (ROUND_SIDES, (0.0, 0.46, 0.0), (0.07, 0.78, 0.0)),
        (ROUND_SIDES, (0.07, 0.5, 0.0), (0.6, 0.92, 0.0)),
        (ROUND_SIDES, (0.6, 0.98, 0.0), (0.63, 0.98, 0.0)),
        (ROUND_SIDES, (0.63, 0.9, 0.0), (0.75, 0.52, 0.0)),
        (SQUARE, (0.75, 1.0, 0.0), (1.0, 1.0, 0.0)),
    ),
    "bun": (
        (ROUND_SIDES, (0.0, 0.62, 0.0), (0.4, 1.0, 0.0)),
        (ROUND_SIDES, (0.4, 1.0, 0.0), (0.8, 0.62, 0.0)),
        (SQUARE, (0.8, 1.0, 0.0), (1.0, 1.0, 0.0)),
    ),
    "column": (
        (ROUND_SIDES, (0.0, 1.5, 0.0), (0.08, 1.5, 0.0)),
        (ROUND_SIDES, (0.08, 1.1, 0.0), (0.34, 1.9, 0.0)),
        (ROUND_SIDES, (0.34, 1.9, 0.0), (0.8, 0.85, 0.0)),
        (ROUND_SIDES, (0.8, 1.25, 0.0), (0.86, 1.25, 0.0)),
        (SQUARE, (0.86, 1.0, 0.0), (1.0, 1.0, 0.0)),
    ),
    "cabriole": (
        (ROUND_SIDES, (0.0, 0.8, 0.1), (0.07, 0.62, 0.09)),
        (ROUND_SIDES, (0.07, 0.52, 0.09), (0.22, 0.42, 0.0)),
        (ROUND_SIDES, (0.22, 0.42, 0.0), (0.62, 0.68, 0.02)),
        (ROUND_SIDES, (0.62, 0.68, 0.02), (0.84, 0.96, 0.1)),
        (SQUARE, (0.78, 1.0, 0.0), (1.0, 1.0, 0.0)),
    ),
}
"""Pieces of each kind, widths across flats of the block or the largest ring."""


def place_legs(
    x: Range, y: Range, height: float, *, kind: LegKind, width: float, finish: str, middle: bool = False
) -> tuple[tuple[Primitive, ...], ...]:
    """Four legs (six with a ``middle`` pair) within the rectangle x by y, from the floor to ``height`` (m).

    They are ordered by x, then by y.
    """
    named = "bun" if kind == "turned" and height < SHORT else kind
    lean = LEAN * height if kind == "splayed" else 0.0
    ends = [end for _, *ends in PROFILES[named] for end in ends]
    spread = max((wide / 2 + offset) * width + lean * (1.0 - level) for level, wide, offset in ends)
    xs = (x[0] + spread, x[1] - spread)
    ys = (y[0] + spread, (y[0] + y[1]) / 2, y[1] - spread) if middle else (y[0] + spread, y[1] - spread)
    out = []
    for at_x in xs:
        for at_y in ys:
            sides = (float(np.sign(at_x - sum(x) / 2)), float(np.sign(round(at_y - sum(y) / 2, 6))))
            leg = _build_leg(named, width, height, lean, sides, finish)
            out.append(tuple(move(piece, (at_x, at_y, 0.0)) for piece in leg))
    return tuple(out)


def make_legs(
    x: Range, y: Range, height: float, *, kind: LegKind, width: float, finish: str, middle: bool = False
) -> tuple[Primitive, ...]:
    """The pieces of the legs that `place_legs` places."""
    legs = place_legs(x, y, height, kind=kind, width=width, finish=finish, middle=middle)
    return tuple(piece for leg in legs for piece in leg)


def make_column(z: Range, width: float, finish: str) -> tuple[Primitive, ...]:
    """The pieces of a turned column about the z axis, ``width`` (m) wide at its top."""
    column = _build_leg("column", width, z[1] - z[0], 0.0, (0.0, 0.0), finish)
    return tuple(move(piece, (0.0, 0.0, z[0])) for piece in column)


@lru_cache(maxsize=128)
def _build_leg(
    kind: str, width: float, height: float, lean: float, out: tuple[float, float], finish: str
) -> tuple[Primitive, ...]:
    """A leg whose top is about x = y = 0; ``out`` points away from the object."""
    pieces = []
    for sides, *ends in PROFILES[kind]:
        ring = polygon(sides)
        ring /= 2 * np.abs(ring).max()
        corners = []
        for level, wide, offset in ends:
            at = np.array(out) * (offset * width + lean * (1.0 - level))
            corners.append(np.column_stack([wide * width * ring + at, np.full(sides, level * height)]))
        pieces.append(polytope(np.concatenate(corners), finish))
    return tuple(pieces)
