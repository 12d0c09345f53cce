"""Wheels are under something: a stage of its own for legs that a network forgot.

A wheel under a table whose leg was not drawn floats, and the table falls over. What stands on a wheel goes
straight up from it, as a leg or the fork of a caster does, until it meets the body.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, name_rows
from artigen.mending.rows import Owners
from artigen.segmentation.tree import ALLOWED_PARENTS

THICK = 3
"""Edge of a leg in cells, at most; it is no thicker than its wheel."""


def extend_legs(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which every wheel below the body touches what it carries, and a note of how many legs grew.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    owners, labels = owners.copy(), np.array(name_rows(rows, layout))
    bodies, lengths = np.flatnonzero(labels == "base"), []
    for number in np.flatnonzero(labels == "wheel") if len(bodies) else ():
        own = owners == number
        carriers = np.isin(owners, np.flatnonzero(np.isin(labels, list(ALLOWED_PARENTS["wheel"])))) & ~own
        around = np.asarray(ndimage.binary_dilation(own, np.ones((3, 3, 3))), dtype=bool)
        if not own.any() or (around & carriers).any():
            continue
        leg = _find_leg(own, owners == bodies[0])
        if leg.any():
            lengths.append(int(leg.any(axis=(0, 1)).sum()))
            owners[leg & (owners < 0)] = bodies[0]
    if not lengths:
        return owners, ()
    return owners, (f"{len(lengths)} wheels were given legs, of {max(lengths)} cells at most",)


def _find_leg(own: Bool[np.ndarray, "X Y Z"], body: Bool[np.ndarray, "X Y Z"]) -> Bool[np.ndarray, "X Y Z"]:
    """The cells over the middle of a wheel, up to the body; none where the body is nowhere above."""
    leg = np.zeros_like(own)
    cells = np.argwhere(own)
    low, high = cells.min(axis=0), cells.max(axis=0) + 1
    thick = np.minimum(high - low, THICK)[:2]
    first = (low[:2] + high[:2] - thick) // 2
    x, y = (slice(int(start), int(start + size)) for start, size in zip(first, thick, strict=True))
    above = body[x, y, int(high[2]) :].any(axis=(0, 1))
    if above.any():
        leg[x, y, int(high[2]) : int(high[2] + above.argmax())] = True
    return leg
