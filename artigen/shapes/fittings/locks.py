"""Cylinder locks of fronts, and flip latches of lids."""

import numpy as np

from artigen.shapes.fittings.hardware import Range
from artigen.shapes.primitives import Vector, box, cylinder
from artigen.shapes.shape import Motion, ShapePart

FREE = 0.0015
"""Gap (m) between a turning lock and its face."""


def make_lock(
    at: Vector, *, name: str, parent: str, radius: float = 0.011, finish: str = "handle"
) -> ShapePart:
    """A cylinder lock with its key on a front face at x, which turns by a quarter.

    Args:
        at: Point where its axis meets the face (m).
        name: Name of the part.
        parent: Name of the part that carries it.
        radius: Radius of the cylinder (m).
        finish: Role of the finish.
    """
    x, y, z = at
    solids = (
        cylinder((x - FREE, y, z), (x - 0.008, y, z), radius, finish),
        box((x - 0.026, y - 0.002, z - 0.8 * radius), (x - 0.008, y + 0.002, z + 0.8 * radius), "steel"),
    )
    turn = Motion(type="revolute", axis=(-1.0, 0.0, 0.0), origin=(x, y, z), upper=np.pi / 2)
    return ShapePart(name=name, label="knob", parent=parent, primitives=solids, motion=turn)


def make_latch(
    x: float, y: Range, z: Range, *, name: str, parent: str, upper: float = 1.9, finish: str = "steel"
) -> ShapePart:
    """A latch before a face at x, which holds a lid down and flips outwards about its lower edge.

    Its plate is 4 mm thick, is `FREE` from the face and has a lip for the fingers at its upper end.

    Args:
        x: Front face of the box, and of the lid where the latch reaches it.
        y: Left and right edge (m).
        z: Lower edge, on the box, and upper edge, on the lid (m).
        name: Name of the part.
        parent: Name of the box.
        upper: Opening angle (rad).
        finish: Role of the finish.
    """
    face = x - FREE
    solids = (
        box((face - 0.004, y[0], z[0]), (face, y[1], z[1]), finish),
        box((face - 0.010, y[0], z[1] - 0.006), (face - 0.004, y[1], z[1]), finish),
    )
    turn = Motion(
        type="revolute",
        axis=(0.0, -1.0, 0.0),
        origin=(face - 0.004, (y[0] + y[1]) / 2, z[0]),
        upper=upper,
    )
    return ShapePart(name=name, label="knob", parent=parent, primitives=solids, motion=turn)
