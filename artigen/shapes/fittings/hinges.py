"""Leaves of doors and windows between jambs, and butt hinges whose barrel is before the leaf's face."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from artigen.shapes.fittings.hardware import GAP, Range, Space, between, rotate, sweep_gap
from artigen.shapes.primitives import Primitive, block, cylinder
from artigen.shapes.shape import Motion

BARREL = 0.0065
"""Radius (m) of the barrel of a door hinge (DIN 18268: 13 to 16 mm diameter)."""
AXIS = BARREL + 0.0015
"""Distance (m) of the axis before the face, which keeps the barrel clear of the turning leaf."""


def build_butt_hinge(
    at: tuple[float, float, float],
    length: float,
    side: Literal[-1, 1],
    finish: str,
    *,
    straps: tuple[float, float] = (0.02, 0.02),
) -> tuple[tuple[Primitive, ...], tuple[Primitive, ...]]:
    """Two knuckles about a vertical axis, each with a strap: the solids on the leaf and those on the frame.

    Args:
        at: Middle of the hinge on its axis; the faces of leaf and frame are `AXIS` behind it.
        length: Length of the barrel (m).
        side: 1 if the frame is on the left (+y) of the axis, -1 if it is on the right.
        finish: Role of the finish.
        straps: Extent of the straps on leaf and frame, from the axis (m).
    """
    x, y, z = at
    half = length / 2
    upper = cylinder((x, y, z + GAP / 2), (x, y, z + half), BARREL, finish)
    lower = cylinder((x, y, z - half), (x, y, z - GAP / 2), BARREL, finish)
    leaf, frame = between(y, y - side * straps[0]), between(y, y + side * straps[1])
    face = x + AXIS
    on_leaf = block((face - 0.004, face), leaf, (z + GAP / 2, z + half), finish)
    on_frame = block((face - 0.004, face), frame, (z - half, z - GAP / 2), finish)
    return (upper, on_leaf), (lower, on_frame)


@dataclass(frozen=True, kw_only=True)
class Leaf:
    """A leaf between jambs: its faces and edges; ``side`` is the direction (y) from hinges to lock."""

    x: Range
    y: Range
    z: Range
    side: Literal[-1, 1]

    @property
    def hung(self) -> float:
        """y of the hinged edge."""
        return self.y[0] if self.side > 0 else self.y[1]

    @property
    def edge(self) -> float:
        """y of the edge with the lock."""
        return self.y[1] if self.side > 0 else self.y[0]

    def stiles(self, width: float) -> tuple[Range, Range, Range]:
        """y ranges of the hinge stile, the field between, and the lock stile."""
        low, high = (self.y[0], self.y[0] + width), (self.y[1] - width, self.y[1])
        between = (low[1], high[0])
        return (low, between, high) if self.side > 0 else (high, between, low)

    def swing(self, upper: float) -> Motion:
        """A hinge axis before the face; the leaf opens by ``upper`` radians towards the viewer."""
        origin = (self.x[0] - AXIS, self.hung, self.z[0])
        return rotate((0.0, 0.0, float(self.side)), origin, upper)


def hang_leaves(
    inner: Space, thick: float, *, count: int, hand: Literal[-1, 1], sill: float, head: float = 0.004
) -> tuple[Leaf, ...]:
    """One leaf, or two that meet in the middle, in a frame that is flush with its front.

    Args:
        inner: Free space within the frame.
        thick: Thickness of a leaf (m).
        count: 1 or 2 leaves; the first has the lever.
        hand: Direction (y) from the hinges of the first leaf to its lock.
        sill: Gap below (m).
        head: Gap above (m).
    """
    x, z = (inner.x[0], inner.x[0] + thick), (inner.z[0] + sill, inner.z[1] - head)
    (low, high), middle = inner.y, sum(inner.y) / 2
    free = sweep_gap(inner.width / count, thick + AXIS)
    if count == 1:
        y = (low + GAP, high - free) if hand > 0 else (low + free, high - GAP)
        return (Leaf(x=x, y=y, z=z, side=hand),)
    right = Leaf(x=x, y=(low + GAP, middle - free / 2), z=z, side=1)
    left = Leaf(x=x, y=(middle + free / 2, high - GAP), z=z, side=-1)
    return (right, left) if hand > 0 else (left, right)


def fit_hinges(
    leaf: Leaf, levels: Iterable[float], finish: str, *, length: float, straps: tuple[float, float]
) -> tuple[list[Primitive], list[Primitive]]:
    """Butt hinges at the given heights (m): the solids on the leaf and those on the frame."""
    on_leaf: list[Primitive] = []
    on_frame: list[Primitive] = []
    for z in levels:
        at = (leaf.x[0] - AXIS, leaf.hung, z)
        moving, fixed = build_butt_hinge(at, length, -1 if leaf.side > 0 else 1, finish, straps=straps)
        on_leaf += moving
        on_frame += fixed
    return on_leaf, on_frame


def build_astragal(
    leaf: Leaf, finish: str, *, cover: float, inset: float, thick: float = 0.012
) -> tuple[Primitive, ...]:
    """A strip on the leaf that opens first, which covers the gap and holds back the other leaf."""
    edge, x = leaf.edge, leaf.x[0]
    low, high = between(edge - leaf.side * inset, edge)
    over = between(edge - leaf.side * inset, edge + leaf.side * cover)
    return (
        block((x - GAP, x), (low, high), leaf.z, finish),
        block((x - thick, x - GAP), over, leaf.z, finish),
    )
