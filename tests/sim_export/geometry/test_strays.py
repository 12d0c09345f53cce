"""Cells of a link that are apart from it go to what they touch; the others stay where they are."""

import numpy as np
import pytest

from artigen.types import VoxelGrid
from sim_export.geometry.strays import settle_strays

NAMES = ("body", "drawer_0")
POST = [(2, 2, z) for z in range(20)]
DRAWER = [(x, y, 10) for x in range(6, 16) for y in range(6, 16)]


def cabinet(chunk) -> VoxelGrid:
    """A post that is the body's and a drawer beside it, which owns the cells of a chunk as well."""
    cells = dict.fromkeys(POST, 0) | dict.fromkeys(DRAWER, 1)
    cells |= dict.fromkeys(chunk, 1)
    return VoxelGrid(resolution=24, coords=np.array([*cells]), part_ids=np.array([*cells.values()]))


def cells_of(voxels: VoxelGrid, part: int) -> set[tuple[int, ...]]:
    return set(map(tuple, voxels.coords[voxels.part_ids == part].tolist()))


def test_a_chunk_of_the_post_that_a_drawer_owns_is_the_posts():
    settled, records = settle_strays(cabinet(POST[5:9]), (0, 1), NAMES)
    assert cells_of(settled, 0) == set(POST)
    assert cells_of(settled, 1) == set(DRAWER)
    assert len(records) == 1


def test_nothing_changes_where_every_link_holds_together_or_both_are_one_link():
    touching = [(x, 6, 10) for x in range(3, 6)]
    for voxels, owners in ((cabinet(touching), (0, 1)), (cabinet(POST[5:9]), (0, 0))):
        settled, records = settle_strays(voxels, owners, NAMES)
        np.testing.assert_array_equal(settled.coords, voxels.coords)
        np.testing.assert_array_equal(settled.part_ids, voxels.part_ids)
        assert records == ()


@pytest.mark.parametrize("more", [0, 1])
def test_a_piece_of_more_than_a_tenth_stays(more):
    count = 11 + more  # of 111, a tenth at most
    chunk = [(3, 2, z) for z in range(count)]
    settled, _ = settle_strays(cabinet(chunk), (0, 1), NAMES)
    assert (set(chunk) <= cells_of(settled, 1)) == bool(more)


@pytest.mark.parametrize("more", [0, 1])
def test_a_speck_of_four_cells_in_the_air_is_left_out_and_more_is_not(more):
    chunk = [(20, 20, z) for z in range(4 + more)]
    settled, _ = settle_strays(cabinet(chunk), (0, 1), NAMES)
    assert (set(chunk) <= cells_of(settled, 1)) == bool(more)
    assert cells_of(settled, 0) == set(POST)
