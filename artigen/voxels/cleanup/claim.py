"""Gives small parts without cells the cells of their boxes."""

import numpy as np
from jaxtyping import Float

from artigen.types import PartLabel
from artigen.voxels.cleanup.boxes import reach_box
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_rows

CLAIMING: frozenset[PartLabel] = frozenset({"handle", "knob", "wheel"})
"""Parts that are as good as their box; a drawer is not."""


def claim_cells(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which every handle, knob and wheel of an outline has a cell, and a note if one had none.

    A push button of half a cell is easily decoded as a piece of the panel that it sits on.

    Args:
        owners: A row per cell, -1 where nothing is.
        rows: An outline, the channels after occupancy, one row per part.
        layout: Channels.
    """
    owners = owners.copy()
    lost = [
        number
        for number, label in enumerate(name_rows(rows, layout))
        if label in CLAIMING and not (owners == number).any()
    ]
    for number in lost:
        owners[reach_box(rows[number, after_occupancy(layout.box)], len(owners))] = number
    note = f"{len(lost)} small parts without cells were given those of their boxes"
    return owners, (note,) if lost else ()
