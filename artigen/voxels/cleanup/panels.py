"""Fills holes in the panel behind knobs.

Knobs hang by a corner where the network draws no panel behind them, or where an earlier stage cleared space
for rotating parts. A patch right behind such a knob, one cell wider than it, closes the hole; it belongs to
the part that carries the knob.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_dilation

from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import ROW, name_rows
from artigen.voxels.segmentation.tree import ALLOWED_PARENTS

BEHIND = {0: 1, 2: -1}
"""Direction of a knob's back along its axis: fronts face -x, and a knob that faces up lies on its carrier."""
HELD = 1 / 3
"""Least ratio of possible carriers' cells that touch a knob to the cells of its back."""
NEAR = np.ones((5, 5, 5), dtype=bool)
"""Neighbourhood of a knob's cells in which its carrier is sought."""


def back_knobs(owners: Owners, rows: Float[np.ndarray, "N C"]) -> tuple[Owners, tuple[str, ...]]:
    """Adds a panel behind knobs that lack one; returns owners and a note of how many.

    Args:
        owners: Row of the outline per cell, -1 where empty.
        rows: The outline: channels after occupancy, one row per part.
    """
    owners, labels = owners.copy(), np.array(name_rows(rows))
    carriers = np.flatnonzero(np.isin(labels, list(ALLOWED_PARENTS["knob"])))
    backed = 0
    for number in np.flatnonzero(labels == "knob"):
        mine = owners == number
        along = int(np.abs(rows[number, ROW.axis]).argmax())
        if not mine.any() or along not in BEHIND:
            continue
        back, patch = _find_back(mine, along)
        carried = np.isin(owners, carriers)
        near = owners[np.asarray(binary_dilation(mine, NEAR), dtype=bool) & carried]
        touched = np.count_nonzero(np.asarray(binary_dilation(mine), dtype=bool) & carried)
        if not back.any() or not len(near) or touched >= HELD * back.sum():
            continue
        owners[patch & (owners < 0)] = np.bincount(near).argmax()
        backed += 1
    if not backed:
        return owners, ()
    return owners, (f"{backed} knobs were given a panel behind them",)


def _find_back(
    mine: Bool[np.ndarray, "X Y Z"], along: int
) -> tuple[Bool[np.ndarray, "X Y Z"], Bool[np.ndarray, "X Y Z"]]:
    """The cells right behind the last layer of a knob, and a patch around them; empty outside the grid."""
    layers = np.moveaxis(mine, along, 0)
    there = np.flatnonzero(layers.any(axis=(1, 2)))
    last = there[-1] if BEHIND[along] > 0 else there[0]
    back, patch = np.zeros_like(mine), np.zeros_like(mine)
    if 0 <= last + BEHIND[along] < len(layers):
        np.moveaxis(back, along, 0)[last + BEHIND[along]] = layers[last]
        np.moveaxis(patch, along, 0)[last + BEHIND[along]] = binary_dilation(layers[last], np.ones((3, 3)))
    return back, patch
