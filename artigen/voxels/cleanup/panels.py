"""Fills holes in the panel behind knobs.

Where a network drew a row of knobs and no panel behind, or room was made for what turns, they hang by a
corner. A patch closes the hole right behind such a knob, a cell wider than it, out of what carries it.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_dilation

from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_rows
from artigen.voxels.segmentation.tree import ALLOWED_PARENTS

BEHIND = {0: 1, 2: -1}
"""Axis of a knob and where its back lies: fronts face -x, and what faces up lies on what is below."""
HELD = 1 / 3
"""Faces of cells by which a knob touches what may carry it, over the cells of its back, at least."""
NEAR = np.ones((5, 5, 5), dtype=bool)
"""Cells around a knob in which its carrier is sought."""


def back_knobs(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which every knob has a panel behind it, and a note of how many were given one.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    owners, labels = owners.copy(), np.array(name_rows(rows, layout))
    carriers = np.flatnonzero(np.isin(labels, list(ALLOWED_PARENTS["knob"])))
    backed = 0
    for number in np.flatnonzero(labels == "knob"):
        mine = owners == number
        along = int(np.abs(rows[number, after_occupancy(layout.axis)]).argmax())
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
    """The cells right behind the last layer of a knob, and those of a patch around them; none at the rim."""
    layers = np.moveaxis(mine, along, 0)
    there = np.flatnonzero(layers.any(axis=(1, 2)))
    last = there[-1] if BEHIND[along] > 0 else there[0]
    back, patch = np.zeros_like(mine), np.zeros_like(mine)
    if 0 <= last + BEHIND[along] < len(layers):
        np.moveaxis(back, along, 0)[last + BEHIND[along]] = layers[last]
        np.moveaxis(patch, along, 0)[last + BEHIND[along]] = binary_dilation(layers[last], np.ones((3, 3)))
    return back, patch
