"""Gives cells that are apart from all others of their link to the part around them.

Where a part lies on another one, the two contest the cells between them. Some are left over far from the
rest of their part, would float as cubes when the link moves, and get hulls.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import ndimage

from artigen.types import VoxelGrid
from sim_export.geometry.grid import label_cells

LONE = 4
"""Most cells of a piece that is given away."""
APART = 3
"""Cells around it in which there must be none of its link; struts bridge less."""
_ALL = np.ones((3, 3, 3), dtype=bool)


def give_lone_cells(voxels: VoxelGrid, owners: Sequence[int]) -> tuple[VoxelGrid, int]:
    """Gives lone cells to the part that owns most cells beside them, if any does; also returns their number.

    ``owners`` gives for every part the part that leads its link (`sim_export.physics.links.link_owners`). The
    last cells of a part are never given away.
    """
    part = np.pad(voxels.part_grid(), 1, constant_values=-1)
    link = np.where(part < 0, -1, np.asarray(owners)[part])
    out = part.copy()
    for owner in np.unique(link[link >= 0]):
        pieces, _ = label_cells(link == owner, _ALL)
        for index in np.flatnonzero(np.bincount(pieces.ravel()) <= LONE):
            own = np.argwhere(pieces == index)
            near = tuple(
                slice(max(low - APART, 0), high + APART + 1)
                for low, high in zip(own.min(axis=0), own.max(axis=0), strict=True)
            )
            if ((pieces[near] > 0) & (pieces[near] != index)).any():
                continue
            around = np.asarray(ndimage.binary_dilation(pieces[near] == index, _ALL), dtype=bool)
            beside = part[near][around & (pieces[near] != index) & (part[near] >= 0)]
            left = np.count_nonzero(out == out[tuple(own[0])]) - len(own)
            if len(beside) and left > 0:
                out[tuple(own.T)] = np.bincount(beside).argmax()
    ids = out[tuple(voxels.coords.T + 1)]
    changed = int(np.count_nonzero(ids != voxels.part_ids))
    return (replace(voxels, part_ids=ids), changed) if changed else (voxels, 0)
