"""Cells far from all others of their link go to the part around them, and nothing else changes."""

import numpy as np
import pytest

from artigen.types import VoxelGrid
from sim_export.geometry.lone_cells import give_lone_cells

FLOOR, BASKET, HANDLE = 0, 1, 2


def grid(lone: int, gap: int) -> VoxelGrid:
    """A basket's rim on a floor, and some of its cells in the floor beyond a gap."""
    owner = np.full((32, 32, 32), -1)
    owner[2:30, 2:30, 2] = FLOOR
    owner[4:8, 4:8, 2:6] = BASKET
    owner[8 + gap : 8 + gap + lone, 5, 2] = BASKET
    owner[20, 20, 3] = HANDLE
    coords = np.argwhere(owner >= 0)
    return VoxelGrid(coords=coords, part_ids=owner[tuple(coords.T)], resolution=32)


@pytest.mark.parametrize(
    ("lone", "gap", "given"),
    [(1, 3, 1), (4, 3, 4), (5, 3, 0), (1, 2, 0)],
)
def test_four_cells_that_three_cells_separate_from_their_link_go_to_what_is_around(lone, gap, given):
    voxels = grid(lone, gap)
    after, count = give_lone_cells(voxels, [FLOOR, BASKET, HANDLE])
    changed = after.part_ids != voxels.part_ids
    assert count == given == np.count_nonzero(changed)
    np.testing.assert_array_equal(after.coords, voxels.coords)
    assert (after.part_ids[changed] == FLOOR).all()


def test_a_part_keeps_its_last_cells_and_a_link_all_of_its_parts():
    voxels = grid(1, 3)
    assert np.count_nonzero(give_lone_cells(voxels, [FLOOR, BASKET, HANDLE])[0].part_ids == HANDLE) == 1
    after, count = give_lone_cells(voxels, [FLOOR, FLOOR, HANDLE])
    assert count == 0
    assert after is voxels
