"""Gives small parts without cells the cells of their boxes."""

import numpy as np
from jaxtyping import Float

from artigen.types import PartLabel
from artigen.voxels.cleanup.boxes import reach_box
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import ROW, name_rows

CLAIMING: frozenset[PartLabel] = frozenset({"handle", "knob", "wheel"})
"""Labels of parts that their box approximates well; a drawer's box does not."""


def claim_cells(owners: Owners, rows: Float[np.ndarray, "N C"]) -> tuple[Owners, tuple[str, ...]]:
    """Gives every handle, knob and wheel without cells those of its box; returns owners and a note.

    A push button of half a cell is easily decoded as a piece of the panel that it sits on.
    """
    owners = owners.copy()
    lost = [
        number
        for number, label in enumerate(name_rows(rows))
        if label in CLAIMING and not (owners == number).any()
    ]
    for number in lost:
        owners[reach_box(rows[number, ROW.box], len(owners))] = number
    note = f"{len(lost)} small parts without cells were given those of their boxes"
    return owners, (note,) if lost else ()
