"""Outlines with rounded or cut corners, and the solids and hollow bodies between two of them.

An outline is a rectangle whose corners are quarter ellipses: a box with rounded edges, an arch or, where the
arcs meet, an egg.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from artigen.shapes.primitives import Primitive, line, polytope
from artigen.shapes.ranges import Range, around, narrow

SHARPEST = 0.2
"""Smallest remaining share of an arc's length when an outline is inset."""
MEETING = 1e-3
"""Arcs whose ends are up to twice this (m) apart are joined; a wall on the edge between is too thin."""
_NOTHING = 1e-5
"""Edges shorter than this (m) get no wall."""


def trace_corners(
    a: Range, b: Range, cuts: Sequence[tuple[float, float]], pieces: int
) -> Float[np.ndarray, "N 2"]:
    """A rectangle with corners cut off by arcs, counterclockwise from the lowest corner.

    Args:
        a: Range along the first axis.
        b: Range along the second axis.
        cuts: Cut of each corner along either axis; zero for a sharp corner.
        pieces: Straight pieces of each arc.

    Returns:
        ``pieces + 1`` points per corner; they coincide where arcs meet and at sharp corners.
    """
    turns = np.linspace(0.0, np.pi / 2, pieces + 1)
    out = []
    for k, (i, j) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
        angles = turns + (k + 2) * np.pi / 2
        middle = np.array([a[i] + (1 - 2 * i) * cuts[k][0], b[j] + (1 - 2 * j) * cuts[k][1]])
        out.append(middle + np.column_stack([np.cos(angles), np.sin(angles)]) * np.array(cuts[k]))
    return np.concatenate(out)


@dataclass(frozen=True, kw_only=True)
class Outline:
    """A rectangle with rounded corners, metres."""

    a: Range
    b: Range
    cuts: tuple[float, float]
    """Radius of the corners at the low and at the high end of ``a``: along ``a``, and as far along ``b``, at
    most to the middle."""
    pieces: int = 2
    """Straight pieces of each corner."""

    def shrink(self, by: float) -> "Outline":
        """The outline inset by a distance on every side."""
        a, b = narrow(self.a, by), narrow(self.b, by)
        low, high = (max(cut - by, SHARPEST * cut) for cut in self.cuts)
        fit = min(1.0, (a[1] - a[0]) / (low + high)) if low + high > 0 else 1.0
        return Outline(a=a, b=b, cuts=(fit * low, fit * high), pieces=self.pieces)

    def trace(self) -> Float[np.ndarray, "N 2"]:
        """Corners, counterclockwise, as in `trace_corners`."""
        half = (self.b[1] - self.b[0]) / 2
        low, high = ((cut, half if cut > half - MEETING else cut) for cut in self.cuts)
        return trace_corners(self.a, self.b, (low, high, high, low), self.pieces)


def draw_egg(center: tuple[float, float], front: float, back: float, half: float, pieces: int = 4) -> Outline:
    """An egg-shaped outline that extends ``front`` to -a, ``back`` to +a and ``half`` to both sides (m).

    Arcs are quarters of ellipses where ``front`` and ``back`` are longer than ``half``.
    """
    a, b = (center[0] - front, center[0] + back), around(center[1], half)
    return Outline(a=a, b=b, cuts=(front, back), pieces=pieces)


def build_loft(
    outline: Outline,
    axis: int,
    span: Range,
    finish: str,
    *,
    inset: float = 0.0,
    wall: float = 0.0,
    lining: str | None = None,
) -> tuple[Primitive, ...]:
    """A solid along an axis, or the walls of a tube that is open at both ends.

    Args:
        outline: Outline of the wider end; its axes follow ``axis`` in cyclic order.
        axis: 0, 1 or 2 for x, y or z.
        span: Low and high end along the axis (m).
        finish: Role of the finish.
        inset: Inset of the low end on every side (m); of the high end if negative.
        wall: Wall thickness across the axis (m); 0 for a solid.
        lining: Role of the finish of the inside.
    """
    small = outline.shrink(abs(inset))
    ends = (small, outline) if inset > 0 else (outline, small)
    outer = [_lift(end.trace(), at, axis) for end, at in zip(ends, span, strict=True)]
    if wall == 0:
        return (polytope(np.concatenate(outer), finish),)
    inner = [_lift(end.shrink(wall).trace(), at, axis) for end, at in zip(ends, span, strict=True)]
    rings, flat = np.stack([*outer, *inner]), outline.trace()
    out = []
    for k, after in pairwise([*range(len(flat)), 0]):
        if np.linalg.norm(flat[after] - flat[k]) < _NOTHING:
            continue
        solid = polytope(rings[:, [k, after]].reshape(-1, 3), finish)
        if lining is not None:
            inward = rings[2:, [k, after]].mean(axis=(0, 1)) - rings[:2, [k, after]].mean(axis=(0, 1))
            inward[axis] = 0.0
            x, y, z = (inward / np.linalg.norm(inward)).tolist()
            solid = line(solid, lining, (x, y, z))
        out.append(solid)
    return tuple(out)


def _lift(flat: Float[np.ndarray, "N 2"], at: float, axis: int) -> Float[np.ndarray, "N 3"]:
    """Points in the plane across an axis, at a coordinate along it."""
    out = np.full((len(flat), 3), at, dtype=float)
    out[:, [(axis + 1) % 3, (axis + 2) % 3]] = flat
    return out
