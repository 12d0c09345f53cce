"""Which doors of an outline close on what lies inside."""

import numpy as np
from jaxtyping import Float, Int

from artigen.models.outline.boxes import CELL

INSIDE = ("drawer", "tray", "shelf")
"""Parts that doors close on."""
RIM = 1.0 * CELL
"""A part may reach so far over the edges of doors and still lie inside, in unit-cube lengths."""


def find_doors_before(
    row: int, doors: Int[np.ndarray, "D"], center: Float[np.ndarray, "N 3"], size: Float[np.ndarray, "N 3"]
) -> Int[np.ndarray, "K"]:
    """The door, or the doors side by side, that a part lies inside of as seen from the front; none, if it
    does not.

    Args:
        row: of the part.
        doors: rows of the doors that may close on it.
        center: of the boxes of all parts.
        size: of the same.
    """
    over = (size[row, 2] - size[doors, 2]) / 2 + np.abs(center[row, 2] - center[doors, 2])
    level = doors[over <= RIM]
    shared = (size[row, 1] + size[level, 1]) / 2 - np.abs(center[row, 1] - center[level, 1])
    whole = shared.clip(0.0, size[row, 1]).sum() >= size[row, 1] - 2 * RIM
    return level[shared > 0] if whole else level[:0]
