"""Cylinder locks of fronts, and flip latches of lids."""

import numpy as np

from artigen.shapes.fittings.hardware import rotate
from artigen.shapes.primitives import FRONT, RIGHT, Vector, block, cylinder
from artigen.shapes.ranges import Range, around
from artigen.shapes.shape import ShapePart

FREE = 0.0015
"""Gap (m) between a turning lock and its face."""
DEEP = 0.014
"""Depth (m) of a flip latch: two fingers hold it at its sides without touching the face behind it."""
UNHOOKED = 0.5
"""Share of a flip latch's range at which it has let go of the lid."""


def make_lock(at: Vector, *, name: str, parent: str = "body", radius: float = 0.011) -> ShapePart:
    """A cylinder lock with its key on a front face at x, which turns by a quarter.

    Args:
        at: Point where its axis meets the face (m).
        name: Name of the part.
        parent: Name of the part that carries it.
        radius: Radius of the cylinder (m).
    """
    x, y, z = at
    solids = (
        cylinder((x - FREE, y, z), (x - 0.008, y, z), radius, "handle"),
        block((x - 0.026, x - 0.008), around(y, 0.002), around(z, 0.8 * radius), "steel"),
    )
    return ShapePart(name, "knob", solids, rotate(FRONT, at, np.pi / 2), parent=parent)


def make_latch(
    x: float, y: Range, z: Range, *, name: str, upper: float = 1.9, finish: str = "steel"
) -> ShapePart:
    """A latch before a face at x, which holds a lid down and flips outwards about its lower edge.

    It is `FREE` from the face and `DEEP` at the lip for the fingers at its upper end, a fifth less below.

    Args:
        x: Front face of the box, and of the lid where the latch reaches it.
        y: Left and right edge (m).
        z: Lower edge, on the box, and upper edge, on the lid (m).
        name: Name of the part.
        upper: Opening angle (rad).
        finish: Role of the finish.
    """
    face = x - FREE
    front = face - 0.8 * DEEP
    solids = (
        block((front, face), y, z, finish),
        block((face - DEEP, front), y, (z[1] - 0.008, z[1]), finish),
    )
    turn = rotate(RIGHT, (front, (y[0] + y[1]) / 2, z[0]), upper)
    return ShapePart(name, "knob", solids, turn)
