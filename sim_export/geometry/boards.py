"""Fills the thin gap between the two faces of a panel.

Voxels represent surfaces only. A board three cells thick is two sheets with a gap. Where its edge touches
another part (a shelf behind a door), the gap is open towards that part and is not an enclosed cavity of the
board. Gaps are therefore searched in the whole object at rest: an enclosed space that is nowhere wider than a
board. The space between two bodies that move against each other (a flat drawer under a table top) looks the
same; it is distinguished by the share of its walls that belongs to each body.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool
from scipy import ndimage

from artigen.types import VoxelGrid
from sim_export.geometry.grid import label_cells

MAX_BOARD = 3
"""Largest width (cells) of a gap; wider spaces are compartments."""
MAX_FOREIGN = 0.25
"""Share of walls belonging to other links from which a space is not the inside of a board."""


def fill_boards(voxels: VoxelGrid, owners: Sequence[int] | None = None) -> tuple[VoxelGrid, int]:
    """Fills the gaps inside boards; also returns the number of filled cells.

    A gap is assigned to the part that owns most of the surrounding cells. ``owners`` gives for every part the
    part that leads its link (`sim_export.physics.links.link_owners`); without it all parts count as one link.
    """
    owner = np.pad(voxels.part_grid(), 1, constant_values=-1)
    spaces, count = label_cells(owner < 0)
    wide = np.unique(spaces[wider_than(owner < 0, MAX_BOARD)])
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


def wider_than(empty: Bool[np.ndarray, "X Y Z"], width: int) -> Bool[np.ndarray, "X Y Z"]:
    """Empty cells whose runs of empty cells are longer than ``width`` along all three axes."""
    out = np.ones_like(empty)
    for axis in range(3):
        line = np.zeros(3, dtype=int)
        line[axis] = width
        structure = np.ones(line + 1, dtype=bool)
        out &= ndimage.binary_opening(empty, structure)
    return out
