"""Front panels, the spaces behind them, and their hinges and runners.

Metres, z up, front -x. Seen from the front, left is +y. A front is hinged at the *front outer* corner of its
edge: up to 90 degrees the leaf stays within its own outline, and it never moves backwards.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from artigen.shapes.primitives import DOWN, FRONT, LEFT, RIGHT, UP, Primitive, Vector, block, place_vertices
from artigen.shapes.ranges import Range, narrow
from artigen.transforms import joint_motion
from artigen.types import Joint

Edge = Literal["left", "right", "top", "bottom"]
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
class _Rectangle:
    """Ranges of y and z (m)."""

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


@dataclass(frozen=True, kw_only=True)
class Panel(_Rectangle):
    """The rectangle of a front (m): its face lies at ``x`` and it extends back by ``thickness``."""

    x: float
    """x of the front face, the smallest x."""
    thickness: float

    @property
    def back(self) -> float:
        """The x of the rear face."""
        return self.x + self.thickness

    def fill(self, finish: str, bevel: float = 0.0) -> Primitive:
        """A board with edges chamfered by ``bevel`` (m)."""
        return block((self.x, self.back), self.y, self.z, finish, bevel)

    def split(self, gap: float) -> tuple["Panel", "Panel"]:
        """The left and the right half, with a gap (m) between them."""
        middle = self.center[0]
        left, right = (middle + gap / 2, self.y[1]), (self.y[0], middle - gap / 2)
        return replace(self, y=left), replace(self, y=right)


@dataclass(frozen=True, kw_only=True)
class Space(_Rectangle):
    """A free box behind a front, metres."""

    x: Range

    @property
    def depth(self) -> float:
        return self.x[1] - self.x[0]

    def fill(self, finish: str, bevel: float = 0.0) -> Primitive:
        """A box with edges chamfered by ``bevel`` (m)."""
        return block(self.x, self.y, self.z, finish, bevel)

    def hollow(self, wall: float) -> "Space":
        """The space within walls at the back and at all sides (m), open to the front."""
        return Space(x=(self.x[0], self.x[1] - wall), y=narrow(self.y, wall), z=narrow(self.z, wall))


def lift(primitives: Iterable[Primitive], height: float) -> tuple[Primitive, ...]:
    """Solids raised by ``height`` metres."""
    up = np.array([0.0, 0.0, height])
    return tuple(replace(primitive, center=primitive.center + up) for primitive in primitives)


def hinge(panel: Panel, edge: Edge, upper: float) -> Joint:
    """A hinge along ``edge`` that opens by ``upper`` radians towards the viewer."""
    y, z = panel.center
    axis, y, z = {
        "left": (DOWN, panel.y[1], z),
        "right": (UP, panel.y[0], z),
        "top": (LEFT, y, panel.z[1]),
        "bottom": (RIGHT, y, panel.z[0]),
    }[edge]
    return rotate(axis, (panel.x, y, z), upper)


def stay_above(joint: Joint, solids: Iterable[Primitive], floor: float) -> Joint:
    """The hinge, opening no farther than to where one of the solids comes down to height ``floor`` (m)."""
    points = np.concatenate([place_vertices(solid) for solid in solids])
    angles = np.linspace(0.0, joint.upper, 181)
    T = joint_motion(joint, angles)
    below = np.flatnonzero((T[:, 2, :3] @ points.T + T[:, 2, 3:]).min(axis=1) < floor)
    return joint if not below.size else replace(joint, upper=float(angles[max(below[0] - 1, 0)]))


def rotate(axis: Vector, origin: Vector, upper: float | None = None, *, spring: float = 0.0) -> Joint:
    """A joint that turns by ``upper`` radians about an axis through a point, or without limits (None)."""
    about, through = np.array(axis), np.array(origin)
    if upper is None:
        return Joint(type="continuous", axis=about, origin=through, upper=2 * np.pi)
    return Joint(type="revolute", axis=about, origin=through, upper=upper, spring=spring)


def slide(upper: float, axis: Vector = FRONT, *, spring: float = 0.0) -> Joint:
    """A runner that travels ``upper`` metres towards the viewer, or along ``axis``."""
    return Joint(type="prismatic", axis=np.array(axis), upper=upper, spring=spring)


def sweep_gap(width: float, thickness: float) -> float:
    """Space (m) that a leaf needs beside its free edge, where its inner corner swings out."""
    return max(GAP, (width**2 + thickness**2) ** 0.5 - width + PASSING)
