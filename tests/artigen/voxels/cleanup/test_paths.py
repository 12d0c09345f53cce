"""What slides comes out: obstacles go where they are little, what is behind them where that is less."""

import numpy as np
import pytest
from cupboard import BASE, EDGE, carcass, row

from artigen.voxels.cleanup.paths import clear_paths

DRAWER = (slice(3, 20), slice(7, 25), slice(8, 20))
HANDLE = (slice(1, 3), slice(14, 18), slice(13, 15))
ROWS = np.stack([BASE, row("drawer", DRAWER, "prismatic", axis=(-1, 0, 0), travel=14), row("handle", HANDLE)])


@pytest.fixture
def chest() -> np.ndarray:
    """A carcass with a drawer, open at its top, and a handle on that."""
    owners = carcass()
    owners[DRAWER] = 1
    owners[4:19, 8:24, 9:20] = -1
    owners[HANDLE] = 2
    return owners


def clear(owners: np.ndarray, rows: np.ndarray = ROWS) -> tuple[np.ndarray, tuple[str, ...]]:
    return clear_paths(owners, np.where(owners >= 0, 6.0, -6.0), rows)


def test_what_comes_out_stays(chest: np.ndarray):
    made, notes = clear(chest)
    assert (made == chest).all()
    assert notes == ()


def test_a_rail_before_a_drawer_goes(chest: np.ndarray):
    blocked = chest.copy()
    blocked[2, 10:14, 10:12] = 0  # before its front
    blocked[0, 15:17, 13:15] = 0  # before its handle
    made, notes = clear(blocked)
    assert (made == chest).all()
    assert notes == ("0 cells of sliding parts and 12 before them were removed, so that they come out",)


def test_a_bulge_behind_the_body_goes(chest: np.ndarray):
    """Cells at the back of a drawer that reach down behind a board before it, under the drawer."""
    blocked = chest.copy()
    blocked[16:20, 10:20, 7] = blocked[16:20, 10:20, 6] = 1
    blocked[4:14, 7:25, 6:8] = 0
    made, _ = clear(blocked)
    assert (made[4:14, 11:19, 7] == 0).all()
    assert not (made[16:20, 11:19, 7] == 1).any()
    assert (made[:, :, 9:] == chest[:, :, 9:]).all()


def test_what_is_behind_a_drawer_or_beyond_its_travel_stays():
    owners = carcass()
    far = (slice(20, 26), slice(7, 25), slice(8, 20))
    owners[far] = 1
    owners[4:6, 7:25, 8:20] = 0  # 14 cells before it
    for travel, cleared in ((13, False), (16, True)):
        rows = np.stack([BASE, row("drawer", far, "prismatic", axis=(-1, 0, 0), travel=travel)])
        made, _ = clear(owners, rows)
        assert (made != owners).any() == cleared
        assert (made[20:] == owners[20:]).all()  # the board at the back is in no way


@pytest.mark.parametrize("axis", range(3))
def test_the_direction_does_not_matter(chest: np.ndarray, axis: int):
    """A mirrored chest, whose drawer opens to the other side, is cleared as its picture in the mirror."""
    blocked = chest.copy()
    blocked[2, 10:14, 10:12] = 0
    blocked[16:20, 10:20, 7] = 1
    mirrored = ROWS.copy()

    def flip(box: tuple[slice, slice, slice]) -> tuple[slice, slice, slice]:
        sides = list(box)
        sides[axis] = slice(EDGE - box[axis].stop, EDGE - box[axis].start)
        return sides[0], sides[1], sides[2]

    towards = (1.0 if axis == 0 else -1.0, 0.0, 0.0)
    mirrored[1] = row("drawer", flip(DRAWER), "prismatic", axis=towards, travel=14)
    mirrored[2] = row("handle", flip(HANDLE))
    made, _ = clear(np.flip(blocked, axis), mirrored)
    assert (np.flip(made, axis) == clear(blocked)[0]).all()
    assert (made != np.flip(blocked, axis)).any()
