"""Two hulls that overlap are parted by what takes least of them."""

import numpy as np
import pytest

from sim_export.collision.relief import OverlappingPair, relieve_pair
from sim_export.geometry.hulls import box_hull, hull_volume

BOARD = box_hull(np.zeros(3), np.array([1.0, 1.0, 0.02]))
TAB = box_hull(np.array([0.4, 0.4, 0.01]), np.array([0.45, 0.45, 0.03]))


def overlap(*, sliver: bool, cuttable: bool) -> OverlappingPair:
    """A tab half way down in a board, which may be cut, and dropped as a sliver, or not."""
    volumes = hull_volume(BOARD), hull_volume(TAB)
    return OverlappingPair(
        hulls=(BOARD, TAB),
        poses=(np.eye(4)[None], np.eye(4)[None]),
        volumes=volumes,
        allowances=(0.65 * volumes[0], 0.65 * volumes[1] if cuttable else 0.0),
        least=(0.0, 0.0),
        slivers=(False, sliver),
        room=(0, 0),
        size=1.0,
        axis=np.array([0.0, 0.0, 1.0]),
    )


@pytest.mark.parametrize(
    ("sliver", "cuttable", "board_left", "tab_left"),
    [(True, True, 1.0, 0.375), (True, False, 1.0, 0.0), (False, False, 0.375, 1.0)],
)
def test_a_sliver_goes_where_cuts_would_take_more_of_the_other_hull(sliver, cuttable, board_left, tab_left):
    """A cut leaves a gap of 2.5 mm, so that it takes 12.5 of 20 mm."""
    done = relieve_pair(overlap(sliver=sliver, cuttable=cuttable), 1e-3)
    assert done.reason == ""
    shares = [
        sum(map(hull_volume, left)) / hull_volume(hull)
        for left, hull in zip(done.hulls, (BOARD, TAB), strict=True)
    ]
    np.testing.assert_allclose(shares, [board_left, tab_left], atol=1e-6)


@pytest.mark.parametrize(
    ("cut_before", "least", "freed"), [(0.3, 0.004, True), (0.3, 0.003, False), (0.65, 0.004, False)]
)
def test_a_deep_cut_takes_little_whatever_other_cuts_have_taken(cut_before, least, freed):
    """A shaft through a board leaves a slot; that and the cuts before may take 0.65 of the board."""
    shaft = box_hull(np.array([0.4, 0.4, -0.5]), np.array([0.45, 0.45, 0.5]))
    board = box_hull(np.zeros(3), np.array([1.0, 1.0, 0.4]))
    before = hull_volume(board) / (1.0 - cut_before)
    pair = OverlappingPair(
        hulls=(board, shaft),
        poses=(np.eye(4)[None], np.eye(4)[None]),
        volumes=(before, hull_volume(shaft)),
        allowances=(0.65 * before, 0.0),
        least=(least * hull_volume(board), 0.0),
        slivers=(False, False),
        room=(8, 0),
        size=10.0,
        axis=np.array([0.0, 0.0, 1.0]),
    )
    assert (relieve_pair(pair, 1e-3).reason == "") is freed
