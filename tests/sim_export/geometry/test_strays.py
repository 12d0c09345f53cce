"""Cells of a link that are apart from it go to what they touch; the others stay where they are."""

import numpy as np
import pytest

from artigen.types import FIXED, Asset, Joint, Part, VoxelGrid
from sim_export.geometry.strays import MAX_SHARE, SPECK, settle_strays

UNIT = np.array([np.zeros(3), np.ones(3)])
SLIDE = Joint(type="prismatic", axis=np.array([-1.0, 0.0, 0.0]), origin=np.zeros(3), upper=0.3)
POST = [(2, 2, z) for z in range(20)]
DRAWER = [(x, y, 10) for x in range(6, 16) for y in range(6, 16)]


def cabinet(**chunks) -> Asset:
    """A post that is the body's and a drawer beside it; ``chunks`` are more cells of either."""
    cells = dict.fromkeys(POST, 0) | dict.fromkeys(DRAWER, 1)
    cells |= dict.fromkeys(chunks.get("drawer", ()), 1)
    parts = (
        Part(name="body", label="base", parent=-1, joint=FIXED, box=UNIT),
        Part(name="drawer_0", label="drawer", parent=0, joint=SLIDE, box=UNIT),
    )
    voxels = VoxelGrid(resolution=24, coords=np.array([*cells]), part_ids=np.array([*cells.values()]))
    return Asset(name="cabinet", category="Table", scale=1.0, parts=parts, voxels=voxels)


def cells_of(voxels: VoxelGrid, part: int) -> set[tuple[int, ...]]:
    return set(map(tuple, voxels.coords[voxels.part_ids == part].tolist()))


def test_a_chunk_of_the_post_that_a_drawer_owns_is_the_posts():
    settled, records = settle_strays(cabinet(drawer=POST[5:9]), (0, 1))
    assert cells_of(settled, 0) == set(POST)
    assert cells_of(settled, 1) == set(DRAWER)
    assert len(records) == 1


def test_nothing_changes_where_every_link_holds_together_or_both_are_one_link():
    touching = [(x, 6, 10) for x in range(3, 6)]
    for asset, owners in ((cabinet(drawer=touching), (0, 1)), (cabinet(drawer=POST[5:9]), (0, 0))):
        assert asset.voxels is not None
        settled, records = settle_strays(asset, owners)
        np.testing.assert_array_equal(settled.coords, asset.voxels.coords)
        np.testing.assert_array_equal(settled.part_ids, asset.voxels.part_ids)
        assert records == ()


@pytest.mark.parametrize("more", [0, 1])
def test_a_piece_above_the_largest_share_stays(more):
    count = int(MAX_SHARE * len(DRAWER) / (1.0 - MAX_SHARE)) + more
    chunk = [(3, 2, z) for z in range(count)]
    settled, _ = settle_strays(cabinet(drawer=chunk), (0, 1))
    assert (set(chunk) <= cells_of(settled, 1)) == bool(more)


@pytest.mark.parametrize("more", [0, 1])
def test_a_speck_in_the_air_is_left_out_and_more_is_not(more):
    chunk = [(20, 20, z) for z in range(SPECK + more)]
    settled, _ = settle_strays(cabinet(drawer=chunk), (0, 1))
    assert (set(chunk) <= cells_of(settled, 1)) == bool(more)
    assert cells_of(settled, 0) == set(POST)
