"""Owners of cells: their rows of the outline, and notes of how many changed."""

import numpy as np
from jaxtyping import Float, Int

from artigen.voxels.fields import ROW, VoxelFields

Owners = Int[np.ndarray, "X Y Z"]
"""Row of the outline that every cell belongs to; -1 where empty."""
CERTAIN = 4.0
"""Logits beyond this, either way, count as certain."""


def note_changes(before: Owners, after: Owners, what: str) -> tuple[Owners, tuple[str, ...]]:
    """The new owners, with a note of the number of changed cells and ``what`` they are, if there are any."""
    changed = int((after != before).sum())
    return after, (f"{changed} {what}",) if changed else ()


def read_owners(found: VoxelFields, rows: Float[np.ndarray, "N C"]) -> Owners:
    """Row whose box is nearest to the box that each occupied cell states; -1 where empty."""
    box = rows[:, ROW.box]
    owners = np.full((found.resolution,) * 3, -1)
    if len(found.coords):
        off = np.abs(found.box[:, None] - box[None]).max(axis=2)
        owners[tuple(found.coords.T)] = off.argmin(axis=1)
    return owners
