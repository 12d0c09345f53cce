"""Maps every cell to its row of the outline."""

import numpy as np
from jaxtyping import Float, Int

from artigen.voxels.fields import ROW, VoxelFields

Owners = Int[np.ndarray, "X Y Z"]
"""Row of the outline that every cell belongs to; -1 where empty."""


def read_owners(found: VoxelFields, rows: Float[np.ndarray, "N C"]) -> Owners:
    """Row whose box is nearest to the box that each occupied cell states; -1 where empty."""
    box = rows[:, ROW.box]
    owners = np.full((found.resolution,) * 3, -1)
    if len(found.coords):
        off = np.abs(found.box[:, None] - box[None]).max(axis=2)
        owners[tuple(found.coords.T)] = off.argmin(axis=1)
    return owners
