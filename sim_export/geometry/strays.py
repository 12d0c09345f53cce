"""Gives stray pieces of a link, which lie apart from it in the grid, to the link that they touch.

Where surfaces of two links run through the same cells, as those of a drawer's runners and of the posts that
hold them, each cell has one owner and owners alternate: chunks of a post are the drawer's, and would move
with it. A piece of a few cells that touches nothing is noise and left out.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Int
from scipy import ndimage

from artigen.types import VoxelGrid

MAX_SHARE = 0.1
"""Largest share of its link's cells that a stray piece may have; a larger one stays as it is."""
SPECK = 4
"""Largest number of cells of a piece that is left out if it touches no other link."""
_ALL = np.ones((3, 3, 3), dtype=bool)


def settle_strays(
    voxels: VoxelGrid, owners: Sequence[int], names: Sequence[str]
) -> tuple[VoxelGrid, tuple[str, ...]]:
    """The voxels with stray pieces given away or left out; one sentence per link that lost some.

    Args:
        voxels: The cells of all parts.
        owners: The part that leads each part's link (`sim_export.physics.links.link_owners`).
        names: Names of the parts.
    """
    records = []
    grid = np.full((voxels.resolution,) * 3, -1)
    grid[tuple(voxels.coords.T)] = voxels.part_ids
    links = np.append(np.asarray(owners), -1)  # part -1, nothing, is of link -1
    for owner in sorted(set(owners)):
        given = left_out = 0
        for piece in _find_strays(links[grid] == owner):
            around = ndimage.binary_dilation(piece, _ALL) & ~piece
            beside = grid[around & (grid >= 0) & (links[grid] != owner)]
            if len(beside):
                grid[piece] = np.bincount(beside).argmax()
                given += int(piece.sum())
            elif piece.sum() <= SPECK:
                grid[piece] = -1
                left_out += int(piece.sum())
        if given or left_out:
            records.append(
                f"{names[owner]}: {given} stray cells given to what they touch, {left_out} left out"
            )
    kept = grid[tuple(voxels.coords.T)] >= 0
    coords = voxels.coords[kept]
    return replace(voxels, coords=coords, part_ids=grid[tuple(coords.T)]), tuple(records)


def _find_strays(cells: Bool[np.ndarray, "X Y Z"]) -> list[Bool[np.ndarray, "X Y Z"]]:
    """Small pieces of a link that the rest of it does not touch, not even at a corner."""
    labels: Int[np.ndarray, "X Y Z"] = np.zeros(cells.shape, dtype=np.int32)
    ndimage.label(cells, _ALL, output=labels)
    sizes = np.bincount(labels[cells])
    strays = np.flatnonzero((sizes > 0) & (sizes <= MAX_SHARE * sizes.sum())).tolist()
    return [labels == piece for piece in strays]
