"""What turns without end: drums are round and whole, the body leaves the rings that they sweep."""

import numpy as np
import pytest
from cupboard import EDGE, row

from artigen.voxels.cleanup.revolve import _find_swept, revolve_parts

TUB = (slice(2, 30),) * 3
DRUM = (slice(8, 24), slice(5, 27), slice(5, 27))
DIAL = (slice(2, 4), slice(12, 20), slice(12, 20))
Y, Z = np.meshgrid(np.arange(EDGE) - 15.5, np.arange(EDGE) - 15.5, indexing="ij")
RADII = np.hypot(Y, Z)
ROWS = np.stack([row("base", TUB), row("tray", DRUM, "continuous", axis=(1, 0, 0), turn=1.0)])


@pytest.fixture
def machine() -> np.ndarray:
    """A drum of one layer's thickness and a back, in a tub that is square outside."""
    owners = np.full((EDGE,) * 3, -1)
    owners[2:30, 2:30, 2:30] = 0
    owners[2:26][:, RADII < 13] = -1
    owners[8:24][:, (RADII < 11) & (RADII >= 9)] = 1
    owners[22:24][:, RADII < 11] = 1
    return owners


def test_a_round_drum_with_room_stays(machine: np.ndarray):
    made, notes = revolve_parts(machine, ROWS)
    assert (made == machine).all()
    assert notes == ()


def test_dents_are_filled_and_bulges_go(machine: np.ndarray):
    worn = machine.copy()
    worn[10:16, 4:9, 13:19] = -1  # a dent
    worn[12:18, 14:18, 26:28] = 1  # a bulge
    worn[9:20, 14:18, 8:10] = 1  # a paddle
    made, notes = revolve_parts(worn, ROWS)
    assert ((made == 1) == np.rot90(made == 1, axes=(1, 2))).all()  # it is round
    assert ((made == 1) != (machine == 1)).sum() < 0.05 * (machine == 1).sum()  # and much what it was
    assert ((made == 0) == (machine == 0)).all()
    assert notes == (f"{(worn != made).sum()} cells were changed so that parts turn freely",)


def test_the_body_leaves_what_the_drum_sweeps_and_nothing_more(machine: np.ndarray):
    narrow = machine.copy()
    narrow[12:14, 4:7, 15:17] = 0  # a rib of the tub inside the drum's ring
    narrow[12:14, 15:17, 15:17] = 0  # something on the axis, within the hollow drum
    made, _ = revolve_parts(narrow, ROWS)
    assert (made[12:14, 5:7, 15:17] != 0).all()
    assert (made[12:14, 15:17, 15:17] == 0).all()
    assert (np.delete(made, (12, 13), axis=0) == np.delete(machine, (12, 13), axis=0)).all()


def test_the_inside_of_a_door_leaves_what_the_drum_sweeps_and_its_front_stays(machine: np.ndarray):
    door = row("door", (slice(4, 12), slice(4, 28), slice(4, 28)), "revolute", axis=(0, 0, 1), turn=0.25)
    machine[4:6, 4:28, 4:28] = 2
    bulge = machine.copy()
    bulge[6:12, 14:18, 24:28] = 2  # into the wall of the drum
    rows = np.stack([*ROWS, door])
    made, _ = revolve_parts(bulge, rows)
    assert (made[4:6] == machine[4:6]).all()
    taken = (bulge == 2) & (made != 2)
    assert taken[8:12].any()
    assert not (taken & (RADII < 8)).any()
    behind = np.argwhere((made == 2)[8:12] & (RADII <= 11) & (RADII >= 9))
    assert not len(behind)  # nothing is left where the drum turns
    assert (revolve_parts(machine, rows)[0] == machine).all()


def test_what_is_made_does_not_depend_on_where_the_dents_are(machine: np.ndarray):
    """A quarter turn about the axis takes the result for a drum to that for the turned drum."""
    worn = machine.copy()
    worn[10:16, 4:9, 13:19] = -1
    turned = np.rot90(worn, axes=(1, 2))
    assert (revolve_parts(turned, ROWS)[0] == np.rot90(revolve_parts(worn, ROWS)[0], axes=(1, 2))).all()


def test_a_dial_flush_with_its_panel_keeps_its_shape_and_gets_room():
    owners = np.full((EDGE,) * 3, -1)
    owners[2:30, 2:30, 2:30] = 0
    owners[2:4, 12:20, 12:20] = 1
    rows = np.stack([row("base", TUB), row("knob", DIAL, "continuous", axis=(1, 0, 0), turn=1.0)])
    made, _ = revolve_parts(owners, rows)
    assert ((made == 1) == (owners == 1)).all()
    corner = np.hypot(3.5, 3.5)
    assert (made[2:4][:, corner >= RADII] != 0).all()
    assert (made[2:4][:, corner + 1 < RADII] == owners[2:4][:, corner + 1 < RADII]).all()
    assert (made[4:] == owners[4:]).all()


def test_a_dial_sunk_into_its_panel_sits_on_it():
    owners = np.full((EDGE,) * 3, -1)
    owners[3:30, 2:30, 2:30] = 0
    owners[1:6, 12:20, 12:20] = 1
    sunk = (slice(1, 6), *DIAL[1:])
    rows = np.stack([row("base", TUB), row("knob", sunk, "continuous", axis=(1, 0, 0), turn=1.0)])
    made, _ = revolve_parts(owners, rows)
    assert (made[1:3] == owners[1:3]).all()
    assert (made[3:6, 12:20, 12:20] == 0).all()


def test_dials_that_would_meet_are_parted_and_keep_the_greater_part():
    owners = np.full((EDGE,) * 3, -1)
    owners[4:30, 2:30, 2:30] = 0
    first, second = (slice(2, 4), slice(6, 12), slice(12, 18)), (slice(2, 4), slice(12, 18), slice(12, 18))
    owners[first], owners[second] = 1, 2
    rows = np.stack(
        [
            row("base", TUB),
            *(row("knob", place, "revolute", axis=(1, 0, 0), turn=0.5) for place in (first, second)),
        ]
    )
    made, _ = revolve_parts(owners, rows)
    cells = [np.argwhere(made == number)[:, 1:] + 0.5 for number in (1, 2)]
    middles = np.array([9.0, 15.0]), np.array([15.0, 15.0])
    reach = [np.hypot(*(place - middle).T).max() for place, middle in zip(cells, middles, strict=True)]
    assert np.hypot(*(cells[1] - middles[0]).T).min() > reach[0]
    assert np.hypot(*(cells[0] - middles[1]).T).min() > reach[1]
    assert min(map(len, cells)) >= 36


def test_what_slides_or_turns_about_its_end_makes_no_room():
    owners = np.full((EDGE,) * 3, -1)
    owners[2:30, 2:30, 2:30] = 0
    owners[2:4, 12:20, 12:20] = 1
    for lever in (
        row("knob", DIAL, "prismatic", axis=(1, 0, 0), travel=1.0),
        row("knob", DIAL, "revolute", axis=(1, 0, 0), turn=0.2, origin=(3, 12, 16)),
    ):
        rows = np.stack([row("base", TUB), lever])
        assert (revolve_parts(owners, rows)[0] == owners).all()


@pytest.mark.parametrize(("narrow", "cut"), [(8.1, True), (7.9, False)])
def test_layers_with_four_fifths_of_the_radius_sweep_as_far_as_the_widest(narrow: float, cut: object):
    """A hull spans both layers of a drum of ten cells; a rib stands at nine."""
    wide, ring = np.array([3.0, 10.0]), np.array([3.0, narrow])
    radii = np.zeros((2, 3, 1))
    radii[0, :2, 0], radii[1, :2, 0], radii[:, 2, 0] = wide, ring, 9.0
    mine = np.zeros(radii.shape, dtype=bool)
    mine[:, :2] = True
    assert _find_swept(mine, radii, 0)[:, 2, 0].tolist() == [True, cut]


@pytest.mark.parametrize(("beyond", "cut"), [(0.74, True), (0.76, False)])
def test_what_turns_gets_three_quarters_of_a_cell_of_room(beyond: float, cut: object):
    radii = np.array([5.0, 8.0, 8.0 + beyond, 4.0]).reshape(1, 4, 1)
    mine = np.array([True, True, False, False]).reshape(1, 4, 1)
    assert _find_swept(mine, radii, 0).ravel().tolist() == [True, True, cut, False]


def test_rings_are_a_cell_wide():
    """Corners of a cross are 0.41 from its arms, half of their ring, and 0.59 from what is beyond."""
    owners = np.full((EDGE,) * 3, -1)
    owners[8:24, 15:18, 16] = owners[8:24, 16, 15:18] = 1
    square = owners.copy()
    square[8:24, 15:18, 15:18] = 1
    drum = row("tray", DRUM, "continuous", axis=(1, 0, 0), origin=(8, 16.5, 16.5), turn=1.0)
    assert (revolve_parts(owners, np.stack([ROWS[0], drum]))[0] == square).all()


@pytest.mark.parametrize(("gap", "sunk"), [(1.4, True), (1.6, False)])
def test_the_panel_of_a_dial_is_sought_a_cell_and_a_half_around_it(gap: float, sunk: object):
    """A dial of one cell, which ends in a panel; the panel begins at the corners or beyond them."""
    radius = np.hypot(Y - 0.5, Z - 0.5)
    owners = np.full((EDGE,) * 3, -1)
    owners[4:6, (radius > gap) & (radius < 10)] = 0
    owners[2:6, 16, 16] = 1
    place = (slice(2, 6), slice(16, 17), slice(16, 17))
    rows = np.stack([row("base", TUB), row("knob", place, "continuous", axis=(1, 0, 0), turn=1.0)])
    made, _ = revolve_parts(owners, rows)
    assert (made[2:4, 16, 16] == 1).all()
    assert (made[4:6, 16, 16] == (0 if sunk else 1)).all()
