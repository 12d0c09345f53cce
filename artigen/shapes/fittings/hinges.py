"""Leaves of doors and windows between jambs, and butt hinges whose barrel is before the leaf's face."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from artigen.shapes.fittings.hardware import GAP, Space, rotate, sweep_gap
from artigen.shapes.primitives import Primitive, block, cylinder
from artigen.shapes.ranges import Range, between, margins
from artigen.types import Joint

BARREL = 0.0065
"""Radius (m) of the barrel of a door hinge (DIN 18268: 13 to 16 mm diameter)."""
AXIS = BARREL + 0.0015
"""Distance (m) of the axis before the face, which keeps the barrel clear of the turning leaf."""
HEAD = 0.004
"""Gap (m) above a leaf."""


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
        low, high = margins(self.y, width)
        field = (low[1], high[0])
        return (low, field, high) if self.side > 0 else (high, field, low)

    def swing(self, upper: float) -> Joint:
        """A hinge axis before the face; the leaf opens by ``upper`` radians towards the viewer."""
        origin = (self.x[0] - AXIS, self.hung, self.z[0])
        return rotate((0.0, 0.0, float(self.side)), origin, upper)


def hang_leaves(
    inner: Space, thick: float, *, count: int, hand: Literal[-1, 1], sill: float
) -> tuple[Leaf, ...]:
    """One leaf, or two that meet in the middle, in a frame that is flush with its front.

    Args:
        inner: Free space within the frame.
        thick: Thickness of a leaf (m).
        count: 1 or 2 leaves; the first has the lever.
        hand: Direction (y) from the hinges of the first leaf to its lock.
        sill: Gap below (m).
    """
    x, z = (inner.x[0], inner.x[0] + thick), (inner.z[0] + sill, inner.z[1] - HEAD)
    (low, high), middle = inner.y, sum(inner.y) / 2
    free = sweep_gap(inner.width / count, thick + AXIS)
    if count == 1:
        y = (low + GAP, high - free) if hand > 0 else (low + free, high - GAP)
        return (Leaf(x=x, y=y, z=z, side=hand),)
    right = Leaf(x=x, y=(low + GAP, middle - free / 2), z=z, side=1)
    left = Leaf(x=x, y=(middle + free / 2, high - GAP), z=z, side=-1)
    return (right, left) if hand > 0 else (left, right)


def fit_hinges(
    leaf: Leaf, levels: Iterable[float], *, length: float, straps: tuple[float, float]
) -> tuple[list[Primitive], list[Primitive]]:
    """Butt hinges, two knuckles with a strap each: the solids on the leaf and those on the frame.

    Args:
        leaf: The leaf.
        levels: Heights of their middles (m).
        length: Length of a barrel (m).
        straps: Extent of the straps on leaf and frame, from the axis (m).
    """
    x, y = leaf.x[0] - AXIS, leaf.hung
    face = x + AXIS
    moving, fixed = between(y, y + leaf.side * straps[0]), between(y, y - leaf.side * straps[1])
    on_leaf: list[Primitive] = []
    on_frame: list[Primitive] = []
    for middle in levels:
        upper, lower = (middle + GAP / 2, middle + length / 2), (middle - length / 2, middle - GAP / 2)
        for solids, strap, z in ((on_leaf, moving, upper), (on_frame, fixed, lower)):
            solids.append(cylinder((x, y, z[0]), (x, y, z[1]), BARREL, "handle"))
            solids.append(block((face - 0.004, face), strap, z, "handle"))
    return on_leaf, on_frame


def build_astragal(leaf: Leaf, *, cover: float, inset: float) -> tuple[Primitive, ...]:
    """A strip on the leaf that opens first, which covers the gap and holds back the other leaf."""
    edge, x = leaf.edge, leaf.x[0]
    low, high = between(edge - leaf.side * inset, edge)
    over = between(edge - leaf.side * inset, edge + leaf.side * cover)
    return (
        block((x - GAP, x), (low, high), leaf.z, "front"),
        block((x - 0.012, x - GAP), over, leaf.z, "front"),
    )
