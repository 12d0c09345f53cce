"""Front panels, the spaces behind them, and their hinges and runners.

Metres, z up, front -x. Seen from the front, left is +y. A front is hinged at the *front outer* corner of its
edge: up to 90 degrees the leaf stays within its own outline, and it never moves backwards.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from artigen.shapes.primitives import Primitive, Vector, rounded_box
from artigen.shapes.shape import Motion

Edge = Literal["left", "right", "top", "bottom"]
Range = tuple[float, float]
GAP = 0.0025
"""Clearance (m) between a moving part and other parts."""
ROOM = 0.014
"""Space (m) beside racks and tubs that run on wheels, rails or runners."""
FINGER_ROOM = 0.028
"""Free height (m) below a grip that is held from above."""
PASSING = 0.003
"""Smallest distance (m) at which the inner corner of a leaf swings past its neighbours. At centimetres per
step, engines predict contacts there that never happen; half this distance was too little."""


@dataclass(frozen=True, kw_only=True)
class Panel:
    """The rectangle of a front (m): its face lies at ``x`` and it extends back by ``thickness``."""

    x: float
    """x of the front face, the smallest x."""
    thickness: float
    y: Range
    """Right and left edge, seen from the front."""
    z: Range
    """Lower and upper edge."""

    @property
    def width(self) -> float:
        return self.y[1] - self.y[0]

    @property
    def height(self) -> float:
        return self.z[1] - self.z[0]

    @property
    def center(self) -> tuple[float, float]:
        """Middle as (y, z)."""
        return (self.y[0] + self.y[1]) / 2, (self.z[0] + self.z[1]) / 2

    @property
    def back(self) -> float:
        """The x of the rear face."""
        return self.x + self.thickness


@dataclass(frozen=True, kw_only=True)
class Space:
    """A free box behind a front, metres."""

    x: Range
    y: Range
    z: Range

    @property
    def depth(self) -> float:
        return self.x[1] - self.x[0]

    @property
    def width(self) -> float:
        return self.y[1] - self.y[0]

    @property
    def height(self) -> float:
        return self.z[1] - self.z[0]


def fill_space(space: Space, finish: str, bevel: float = 0.0) -> Primitive:
    """A box that fills a space, with edges chamfered by ``bevel`` (m)."""
    low: Vector = (space.x[0], space.y[0], space.z[0])
    high: Vector = (space.x[1], space.y[1], space.z[1])
    return rounded_box(low, high, bevel, finish)


def lift(primitives: Iterable[Primitive], height: float) -> tuple[Primitive, ...]:
    """Solids raised by ``height`` metres."""
    up = np.array([0.0, 0.0, height])
    return tuple(replace(primitive, center=primitive.center + up) for primitive in primitives)


def hinge(panel: Panel, edge: Edge, upper: float) -> Motion:
    """A hinge along ``edge`` that opens by ``upper`` radians towards the viewer."""
    y, z = panel.center
    axis, y, z = {
        "left": ((0.0, 0.0, -1.0), panel.y[1], z),
        "right": ((0.0, 0.0, 1.0), panel.y[0], z),
        "top": ((0.0, 1.0, 0.0), y, panel.z[1]),
        "bottom": ((0.0, -1.0, 0.0), y, panel.z[0]),
    }[edge]
    return Motion(type="revolute", axis=axis, origin=(panel.x, y, z), upper=upper)


def slide(upper: float, axis: Vector = (-1.0, 0.0, 0.0)) -> Motion:
    """A runner that travels ``upper`` metres towards the viewer, or along ``axis``."""
    return Motion(type="prismatic", axis=axis, upper=upper)


def sweep_gap(width: float, thickness: float) -> float:
    """Space (m) that a leaf needs beside its free edge, where its inner corner swings out."""
    return max(GAP, (width**2 + thickness**2) ** 0.5 - width + PASSING)
