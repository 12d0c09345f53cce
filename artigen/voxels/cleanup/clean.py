"""Runs all clean-up stages of sampled cells in order."""

from collections.abc import Callable
from functools import partial

import numpy as np
from jaxtyping import Float

from artigen.voxels.cleanup.boards import make_boards
from artigen.voxels.cleanup.claim import claim_cells
from artigen.voxels.cleanup.doorways import clear_doorways
from artigen.voxels.cleanup.faces import even_faces
from artigen.voxels.cleanup.portholes import round_portholes
from artigen.voxels.cleanup.revolve import revolve_parts
from artigen.voxels.cleanup.rows import Owners

Stage = Callable[[Owners], tuple[Owners, tuple[str, ...]]]
"""A clean-up stage: owners of the cells to new owners and notes of what changed."""


def mend_cells(
    owners: Owners, logits: Float[np.ndarray, "X Y Z"], rows: Float[np.ndarray, "N C"]
) -> tuple[Owners, tuple[str, ...]]:
    """Cleans up sampled cells; returns the new owners and notes of what changed.

    Args:
        owners: Row of the outline per cell, -1 where empty.
        logits: Occupancy logits of all cells.
        rows: The outline: channels after occupancy, one row per part.
    """
    stages: list[Stage] = [
        partial(make_boards, logits=logits, rows=rows),
        partial(round_portholes, rows=rows),
        partial(even_faces, logits=logits, rows=rows),
        partial(clear_doorways, rows=rows),
        partial(claim_cells, rows=rows),
        partial(revolve_parts, rows=rows),
    ]
    notes: list[str] = []
    for stage in stages:
        owners, new = stage(owners)
        notes += new
    return owners, tuple(notes)
