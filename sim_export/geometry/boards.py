"""Fills the thin space between the two faces of a panel.

Voxels hold surfaces only. A board three cells thick is two sheets with a gap, and where its edge
touches another part (a shelf behind a door) the gap is open towards that part and no cavity of its
own. So the gap is found in the whole object at rest: a space without a way out and nowhere wider than
a board. The room between two bodies that move against each other (a flat drawer under a table top) is
such a space too; it is told by how much of its walls belongs to each.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Int
from scipy import ndimage

from artigen.types import VoxelGrid

MAX_BOARD = 3
"""Cells; wider spaces are compartments."""
MAX_FOREIGN = 0.25
"""A space of whose walls this share or more belongs to other links than most of them is no board's inside."""


def fill_boards(
    voxels: VoxelGrid, owners: Sequence[int] | None = None, max_width: int = MAX_BOARD
) -> tuple[VoxelGrid, int]:
    """Adds the gaps inside of boards to the parts around them; also returns how many cells those are.

    A gap goes as a whole to the part that owns most of the cells around it. ``owners`` tells for every
    part which part leads its link (`sim_export.physics.links.link_owners`); without it all parts are one
    link.
    """
    shape = (voxels.resolution + 2,) * 3
    owner = np.full(shape, -1, dtype=np.int64)
    owner[tuple(voxels.coords.T + 1)] = voxels.part_ids
    spaces, count = label_spaces(owner < 0)
    wide = np.unique(spaces[wider_than(owner < 0, max_width)])
    thin = np.setdiff1d(np.arange(1, count + 1), wide)
    gaps = np.isin(spaces, thin)
    if not gaps.any():
        return voxels, 0
    parts = int(voxels.part_ids.max()) + 1
    votes = np.zeros((count + 1, parts), dtype=np.int64)
    for axis in range(3):
        for step in (-1, 1):
            beside = np.roll(owner, step, axis)
            touching = gaps & (beside >= 0)
            np.add.at(votes, (spaces[touching], beside[touching]), 1)
    if owners is not None:
        links = np.zeros((count + 1, max(owners) + 1), dtype=np.int64)
        np.add.at(links.T, np.asarray(owners[:parts]), votes.T)
        total = links.sum(axis=1)
        between = total - links.max(axis=1) >= MAX_FOREIGN * np.maximum(total, 1)
        gaps &= ~between[spaces]
    added = np.argwhere(gaps)
    coords = np.concatenate([voxels.coords, added - 1])
    part_ids = np.concatenate([voxels.part_ids, votes.argmax(axis=1)[spaces[tuple(added.T)]]])
    return replace(voxels, coords=coords, part_ids=part_ids), len(added)


def label_spaces(empty: Bool[np.ndarray, "X Y Z"]) -> tuple[Int[np.ndarray, "X Y Z"], int]:
    """Numbers the connected spaces from 1; 0 is solid."""
    spaces = np.zeros(empty.shape, dtype=np.int64)
    ndimage.label(empty, output=spaces)
    return spaces, int(spaces.max())


def wider_than(empty: Bool[np.ndarray, "X Y Z"], width: int) -> Bool[np.ndarray, "X Y Z"]:
    """Empty cells whose runs of empty cells are longer than ``width`` along all three axes."""
    out = np.ones_like(empty)
    for axis in range(3):
        line = np.zeros(3, dtype=int)
        line[axis] = width
        structure = np.ones(line + 1, dtype=bool)
        out &= ndimage.binary_opening(empty, structure)
    return out
