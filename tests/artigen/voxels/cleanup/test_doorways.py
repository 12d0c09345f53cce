"""Bins of doors: what would stand before a drawer goes, what is above it or on the panel stays."""

import numpy as np
import pytest
from cupboard import BASE, carcass, row

from artigen.voxels.cleanup.doorways import clear_doorways

DOOR = (slice(0, 6), slice(4, 28), slice(4, 28))
DRAWER = (slice(7, 24), slice(6, 26), slice(8, 14))
LOW_BIN, HIGH_BIN = (slice(2, 6), slice(6, 26), slice(9, 12)), (slice(2, 6), slice(6, 26), slice(20, 23))


def outline(turn: float) -> np.ndarray:
    door = row("door", DOOR, "revolute", axis=(0, 0, 1), origin=(0, 4, 16), turn=turn)
    return np.stack([BASE, door, row("drawer", DRAWER, "prismatic", axis=(-1, 0, 0), travel=15)])


@pytest.fixture
def fridge() -> np.ndarray:
    """A carcass behind a door of two layers with two bins, and a drawer at the height of the lower one."""
    owners = carcass()
    owners[:7] = -1
    owners[0:2, 4:28, 4:28] = owners[LOW_BIN] = owners[HIGH_BIN] = 1
    owners[DRAWER] = 2
    return owners


def test_the_door_is_told_to_open_as_the_joint_says():
    """Turned a quarter about its edge, the panel stands along -x, and its inside faces the middle."""
    panel = carcass() * 0 - 1
    panel[5, 4:8, 9:11] = 1  # six cells behind the hinge, at its side
    panel[0:2, 4:28, 4:28] = 1
    panel[DRAWER] = 2
    made, notes = clear_doorways(panel, outline(0.25))
    gone = np.argwhere((panel == 1) & (made < 0))
    assert len(gone) == 8  # 5.5 behind the hinge, then 5.5 beside it, at y = 9.5: before the drawer
    assert (gone[:, 0] == 5).all()
    said = "8 cells on the inside of doors were removed that would stand before a drawer when open"
    assert notes == (said,)


def test_a_bin_before_a_drawer_makes_way_and_others_stay(fridge: np.ndarray):
    made, _ = clear_doorways(fridge, outline(0.25))
    assert (made[HIGH_BIN] == 1).all()
    assert (made[0:2] == fridge[0:2]).all()
    assert (made[DRAWER] == 2).all()
    low = np.argwhere(made[2:6, :, 9:12] == 1)
    assert len(low) < (fridge[LOW_BIN] == 1).sum()
    assert (low[:, 0] + 2.5 + 4 < 6.5).all()  # none comes to stand within the drawer's width


def test_a_door_that_opens_half_a_turn_is_out_of_the_way(fridge: np.ndarray):
    made, notes = clear_doorways(fridge, outline(0.5))
    assert (made == fridge).all()
    assert notes == ()


def test_without_a_drawer_behind_it_a_door_keeps_its_bins(fridge: np.ndarray):
    fridge[DRAWER] = -1
    assert (clear_doorways(fridge, outline(0.25))[0] == fridge).all()


def test_both_doors_of_a_pair_make_way_for_a_drawer_behind_them():
    owners = carcass()
    owners[:7] = -1
    owners[0:6, 4:16, 4:28], owners[0:6, 16:28, 4:28] = 1, 2  # as thick at the hinge as elsewhere
    owners[DRAWER] = 3
    left, right = ((slice(0, 6), ys, slice(4, 28)) for ys in (slice(4, 16), slice(16, 28)))
    rows = np.stack(
        [
            BASE,
            row("door", left, "revolute", axis=(0, 0, 1), origin=(0, 4, 16), turn=0.25),
            row("door", right, "revolute", axis=(0, 0, -1), origin=(0, 28, 16), turn=0.25),
            row("drawer", DRAWER, "prismatic", axis=(-1, 0, 0), travel=15),
        ]
    )
    made, _ = clear_doorways(owners, rows)
    gone = (owners >= 0) & (made < 0)
    assert gone[:, 4:28].any()
    assert (gone == gone[:, ::-1]).all()
    assert not gone[0].any()
    assert (made[DRAWER] == 3).all()
    left = np.argwhere(made[:, :16, 8:14] == 1)
    assert (4 + left[:, 0] + 0.5 < 6 + 1).all()  # turned a quarter, none stands in the drawer's way


def test_a_drawer_beside_a_door_takes_nothing_from_it(fridge: np.ndarray):
    rows = outline(0.25)
    aside = (slice(7, 24), slice(28, 31), slice(8, 14))
    rows[2] = row("drawer", aside, "prismatic", axis=(-1, 0, 0), travel=15)
    fridge[DRAWER], fridge[aside] = -1, 2
    assert (clear_doorways(fridge, rows)[0] == fridge).all()


@pytest.mark.parametrize(("overlap", "gone"), [(0.24, False), (0.26, True)])
def test_a_drawer_slides_past_a_quarter_of_a_cell_of_an_open_door(
    fridge: np.ndarray, overlap: float, gone: object
):
    """The inner layer of the panel, which ends at the side of the drawer or a little before it."""
    rows = outline(0.25)
    rows[1] = row("door", DOOR, "revolute", axis=(0, 0, 1), origin=(0, 4 + overlap, 16), turn=0.25)
    fridge[LOW_BIN] = -1
    made, _ = clear_doorways(fridge, rows)
    assert (made[1, 4:28, 8:14] == (-1 if gone else 1)).all()
    assert (made[1, 4:28, 14:28] == 1).all()
