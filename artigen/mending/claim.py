"""Cells for parts that a network drew none for: a stage of its own for handles, knobs and wheels.

A push button of half a cell is easily decoded as a piece of the panel that it sits on. Where an outline says
that there is one, it claims the cells of its box, as in the truth a part smaller than a cell does.
"""

import numpy as np
from jaxtyping import Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_rows
from artigen.mending.rows import Owners
from artigen.types import PartLabel

CLAIMING: frozenset[PartLabel] = frozenset({"handle", "knob", "wheel"})
"""Parts that are as good as their box; a drawer is not."""


def claim_cells(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which every handle, knob and wheel of an outline has a cell, and a note if one had none.

    Where nothing at all was drawn, there is nothing for them to sit on, and nothing is claimed.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    if (owners < 0).all():
        return owners, ()
    owners = owners.copy()
    lost = [
        number
        for number, label in enumerate(name_rows(rows, layout))
        if label in CLAIMING and not (owners == number).any()
    ]
    if not lost:
        return owners, ()
    for number in lost:
        box = rows[number, after_occupancy(layout.box)]
        owners[tuple(_cells_of_box(box, len(owners)).T)] = number
    note = f"{len(lost)} small parts without cells were given those of their boxes"
    return owners, (note,)


def _cells_of_box(box: Float[np.ndarray, "6"], resolution: int) -> np.ndarray:
    """Cells whose centres lie in a box; where it is thinner than a cell, the one that holds its middle."""
    center, size = (box[:3] + 0.5) * resolution, box[3:] * resolution
    low, high = np.ceil(center - size / 2 - 0.5), np.floor(center + size / 2 - 0.5)
    thin = low > high
    low[thin] = high[thin] = np.floor(center[thin])
    low, high = low.clip(0, resolution - 1).astype(int), high.clip(0, resolution - 1).astype(int)
    axes = [np.arange(a, b + 1) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
