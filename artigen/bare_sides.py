"""Sides of voxels that show no surface: they look as the other side of the voxel does, as in training.

Where two boards meet, a voxel of one has no inner side; a Gaussian in the colour of the lining would shine
along the edge of a cabinet. So what is painted there is not the painter's to say.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from artigen.facings import SIDES


def cover_bare_sides(
    paint: Float[np.ndarray, "N 7"],
    faced: Bool[np.ndarray, "N 2"],
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
) -> Float[np.ndarray, "N 7"]:
    """Paint whose sides without surface have the colour of the other side.

    A voxel without any side, such as one within the end of a thick board, has the colour of the nearest voxel
    of its part that has one, of its outer side if it has both.

    Args:
        paint: Colours of the outer side and of the inner one, and how clear the voxel is.
        faced: Whether surface faces the way of either side.
        coords: Cells (x, y, z) of the grid.
        part_ids: Part of each.
    """
    colors = paint[:, :-1].reshape(-1, SIDES, 3).copy()
    for side in range(SIDES):
        bare = ~faced[:, side] & faced[:, 1 - side]
        colors[bare, side] = colors[bare, 1 - side]
    some = faced.any(axis=1)
    for part in np.unique(part_ids[~some]):
        own = part_ids == part
        rows, lost = np.flatnonzero(own & some), np.flatnonzero(own & ~some)
        if len(rows):
            nearest = rows[np.asarray(KDTree(coords[rows]).query(coords[lost])[1])]
            colors[lost] = colors[nearest, :1]
    return np.concatenate([colors.reshape(len(paint), -1), paint[:, -1:]], axis=1)
