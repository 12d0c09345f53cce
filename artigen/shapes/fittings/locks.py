"""Locks that a key turns, and latches that a hand flips: what keeps fronts and lids closed."""

import numpy as np

from artigen.shapes.fittings.hardware import Range
from artigen.shapes.primitives import Vector, box, cylinder
from artigen.shapes.shape import Motion, ShapePart

FREE = 0.0015
"""Distance (m) at which a lock turns before its face."""


def make_lock(
    at: Vector, *, name: str, parent: str, radius: float = 0.011, finish: str = "handle"
) -> ShapePart:
    """A cylinder lock with its key, on a face at x that looks to the front; it turns by a quarter.

    Args:
        at: Where its axis meets the face (m).
        name: Of the part.
        parent: What it turns on.
        radius: Of the cylinder (m).
        finish: Surface.
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
    """A latch before a face at x that holds a lid down and flips outwards about its lower edge.

    Its plate is 4 mm thick and stands `FREE` before the face; a lip at its upper end is for the fingers.

    Args:
        x: Front face of the box, and of the lid where the latch reaches it.
        y: Edges across (m).
        z: Lower edge, on the box, and upper edge, on the lid.
        name: Of the part.
        parent: The box.
        upper: How far it opens (rad).
        finish: Surface.
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
