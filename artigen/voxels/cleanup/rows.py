"""Maps every cell to its row of the outline."""

import numpy as np
from jaxtyping import Float, Int

from artigen.voxels.fields import VoxelFields, after_occupancy

Owners = Int[np.ndarray, "X Y Z"]
"""The row of an outline that every cell belongs to; -1 where nothing is."""


def read_owners(found: VoxelFields, rows: Float[np.ndarray, "N C"]) -> Owners:
    """The row whose box every occupied cell says, or says most nearly; -1 where nothing is."""
    layout = found.layout
    box = rows[:, after_occupancy(layout.box)]
    owners = np.full((found.resolution,) * 3, -1)
    if len(found.coords):
        off = np.abs(found.box[:, None] - box[None]).max(axis=2)
        owners[tuple(found.coords.T)] = off.argmin(axis=1)
    return owners
