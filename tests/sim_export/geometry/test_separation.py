"""A cell belongs to one of two links where a drawer is sunk into its carrier, and latches keep away from
frames; nothing else changes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import ndimage

from artigen.types import FIXED, Asset, Joint, Part
from sim_export.geometry.joining import join_cells
from sim_export.geometry.occupancy import PartOccupancy
from sim_export.geometry.separation import free_latches, separate_solids

UNIT = np.array([np.zeros(3), np.ones(3)])
SLIDE = Joint(type="prismatic", axis=np.array([-1.0, 0.0, 0.0]), origin=np.zeros(3), upper=0.3)


def solid(low, high) -> PartOccupancy:
    grid = np.zeros((24, 24, 24), dtype=bool)
    grid[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] = True
    return PartOccupancy(occupancy=grid, shared=0, enclosed=0, joined=0)


def table(label="drawer", joint: Joint = SLIDE) -> Asset:
    parts = (
        Part(name="body", label="base", parent=-1, joint=FIXED, box=UNIT),
        Part(name="box", label=label, parent=0, joint=joint, box=UNIT),
    )
    return Asset(name="table", category="Table", scale=1.0, parts=parts)


APRON = solid((4, 2, 8), (6, 22, 14))


@pytest.mark.parametrize("depth", [3, 6, 13])
def test_a_sunk_drawer_has_its_cells_to_itself(depth):
    """Two layers in the apron, of up to thirteen; of fourteen it is hardly sunk."""
    drawer = solid((4, 6, 9), (4 + depth, 12, 13))
    (body, box), records = separate_solids(table(), (APRON, drawer), (0, 1))
    assert not (body.occupancy & box.occupancy).any()
    assert box is drawer
    np.testing.assert_array_equal(body.occupancy | (APRON.occupancy & drawer.occupancy), APRON.occupancy)
    np.testing.assert_array_equal(join_cells(body.occupancy, box.occupancy), body.occupancy)
    assert len(records) == 1


def carried(body, drawer):
    """What a body keeps beside a drawer, and the records."""
    solids = [PartOccupancy(occupancy=cells, shared=0, enclosed=0, joined=0) for cells in (body, drawer)]
    (kept, _), records = separate_solids(table(), solids, (0, 1))
    return kept.occupancy, records


def test_pieces_that_hold_by_yielded_cells_among_them_go_with_them():
    """A block in a hole of the drawer, which the body held by the drawer's cells alone."""
    body = solid((4, 2, 9), (16, 22, 13)).occupancy.copy()
    body[20:22, 2:4, 2:4] = True  # apart before
    drawer = solid((4, 6, 9), (16, 14, 13)).occupancy.copy()
    drawer[8:12, 8:12, 9:13] = False
    body[4:16, 2:6] = False
    kept, records = carried(body, drawer)
    assert len(records) == 1
    _, pieces = ndimage.label(kept)
    assert pieces == 2
    assert not kept[8:12, 8:12, 9:13].any()


def test_a_body_that_would_fall_apart_yields_nothing():
    """A leg under a board that a drawer takes over: it reaches out of the box of the cells in common."""
    body = solid((4, 2, 8), (20, 22, 9)).occupancy.copy()
    body[4:20, 2:4, 9:20] = True
    body[6:9, 10:13, 7] = True
    drawer = solid((3, 5, 8), (21, 22, 12)).occupancy
    kept, records = carried(body, drawer)
    np.testing.assert_array_equal(kept, body)
    assert records == ()
    body[6:9, 10:13, 7] = False
    kept, records = carried(body, drawer)
    np.testing.assert_array_equal(kept, body & ~drawer)
    assert len(records) == 1


def test_what_is_hardly_sunk_moves_otherwise_or_is_of_one_link_stays():
    hardly, drawer = solid((4, 6, 9), (18, 12, 13)), solid((4, 6, 9), (7, 12, 13))
    turning = replace(SLIDE, type="revolute")
    for asset, mover, owners in (
        (table(), hardly, (0, 1)),
        (table("door", turning), drawer, (0, 1)),
        (table("drawer", FIXED), drawer, (0, 0)),
        (table(), drawer, (0, 0)),
    ):
        kept, records = separate_solids(asset, (APRON, mover), owners)
        assert kept == (APRON, mover)
        assert records == ()


TURN = Joint(type="revolute", axis=np.array([-1.0, 0.0, 0.0]), origin=np.zeros(3), upper=0.8)
LEAF, FRAME = solid((4, 2, 2), (7, 12, 22)), solid((2, 16, 2), (8, 20, 22))


def door(label="knob", joint: Joint = TURN, leaf: Joint = TURN) -> Asset:
    box = np.array([[0.0, 11.0 / 24 - 0.5, 0.0], [1.0, 10.0 / 24, 1.0]])
    parts = (
        Part(name="frame", label="base", parent=-1, joint=FIXED, box=UNIT),
        Part(name="leaf", label="door", parent=0, joint=leaf, box=UNIT),
        Part(name="lever", label=label, parent=1, joint=joint, box=box),
    )
    return Asset(name="door", category="Door", scale=1.0, parts=parts)


@pytest.mark.parametrize("joint", [TURN, SLIDE])
def test_a_latch_ends_a_cell_before_the_frame(joint: Joint):
    lever = solid((2, 6, 10), (4, 16, 12))
    asset, (frame, leaf, latch), records = free_latches(door(joint=joint), (FRAME, LEAF, lever), (0, 1, 2))
    assert frame is FRAME
    assert leaf is LEAF
    np.testing.assert_array_equal(latch.occupancy, solid((2, 6, 10), (4, 15, 12)).occupancy)
    low, high = (asset.parts[2].box[0] + sign * asset.parts[2].box[1] / 2 for sign in (-1, 1))
    assert (low[1], high[1]) == pytest.approx((6 / 24 - 0.5, 15 / 24 - 0.5))
    assert len(records) == 1


def test_what_is_far_carried_by_no_leaf_or_no_latch_stays():
    near, far = solid((2, 6, 10), (4, 16, 12)), solid((2, 5, 10), (4, 15, 12))
    for asset, latch, owners in (
        (door(), far, (0, 1, 2)),
        (door(label="handle"), near, (0, 1, 2)),
        (door(joint=replace(TURN, type="continuous")), near, (0, 1, 2)),
        (door(leaf=FIXED), near, (0, 0, 2)),
    ):
        same, kept, records = free_latches(asset, (FRAME, LEAF, latch), owners)
        assert kept == (FRAME, LEAF, latch)
        assert same.parts == asset.parts
        assert records == ()


@pytest.mark.parametrize(("start", "end", "cut"), [(13, 18, True), (12, 20, False)])
def test_a_latch_keeps_two_fifths_of_its_cells(start: int, end: int, *, cut: bool):
    """Two rows of cells of five are far from the frame, or three of eight."""
    lever = solid((2, start, 10), (4, end, 12))
    _, (_, _, latch), records = free_latches(door(), (FRAME, LEAF, lever), (0, 1, 2))
    assert (latch is not lever) == bool(records) == cut


@pytest.mark.parametrize(("deep", "cut"), [(1, True), (2, False)])
def test_a_latch_that_would_lose_an_end_stays(deep: int, *, cut: bool):
    """Of two ends of 2 x 2 cells beside the frame, the shaft between which is near it, one is short."""
    frame = solid((6, 2, 2), (9, 22, 22))
    lever = solid((5 - deep, 10, 10), (5, 12, 12)).occupancy | solid((10, 10, 10), (22, 12, 12)).occupancy
    lever[5:10, 10:12, 10:12] = True
    whole = PartOccupancy(occupancy=lever, shared=0, enclosed=0, joined=0)
    _, (_, _, latch), records = free_latches(door(), (frame, LEAF, whole), (0, 1, 2))
    assert (latch is not whole) == bool(records) == cut
