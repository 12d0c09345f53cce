"""Doors before drums are round, with a round opening behind them; all other doors stay."""

import numpy as np
import pytest
from cupboard import EDGE, row

from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.voxels.cleanup.portholes import round_portholes
from artigen.voxels.fields import tabulate_parts

BODY = (slice(5, 28), slice(2, 30), slice(2, 30))
DOOR = (slice(2, 5), slice(6, 26), slice(6, 26))
DRUM = (slice(8, 24), slice(8, 24), slice(8, 24))
PLATE = 5
"""The layer of cells behind the door."""


def outline(axis: tuple[float, float, float] = (1, 0, 0)) -> np.ndarray:
    return np.stack(
        [
            row("base", BODY),
            row("door", DOOR, "revolute", axis=(0, 0, 1), turn=0.4),
            row("tray", DRUM, "continuous", axis=axis, turn=1.0),
        ]
    )


@pytest.fixture
def machine() -> np.ndarray:
    """A square door over a square hole that is ragged at one side."""
    owners = np.full((EDGE,) * 3, -1)
    owners[PLATE, 2:30, 2:30] = 0
    owners[PLATE, 10:22, 10:22] = -1
    owners[PLATE, 20:26, 12:16] = -1
    owners[DOOR] = 1
    return owners


def radii() -> np.ndarray:
    """Of the cells of a layer about the middle of the door, whose radius is 10 cells."""
    across = np.arange(EDGE) + 0.5 - 16.0
    return np.hypot(across[:, None], across[None]) / 10.0


def test_a_square_door_before_a_drum_becomes_a_disc_over_a_round_hole(machine: np.ndarray):
    made, notes = round_portholes(machine, outline())
    radius = radii()
    for layer in range(DOOR[0].start, DOOR[0].stop):
        assert ((made[layer] == 1) == (radius <= 1.0)).all()
    plate = made[PLATE, 2:30, 2:30] == 0
    inner = radius[2:30, 2:30]
    assert plate[inner > 0.80].all()
    assert not plate[inner < 0.72].any()
    assert notes == (f"{(made != machine).sum()} cells were changed to make a door and its opening round",)
    again, nothing = round_portholes(made, outline())
    assert (again == made).all()
    assert nothing == ()


def test_a_disc_with_a_lost_rim_is_whole_again(machine: np.ndarray):
    whole, _ = round_portholes(machine, outline())
    torn = whole.copy()
    torn[DOOR[0], 6:10] = -1
    made, _ = round_portholes(torn, outline())
    assert ((made == 1).any(axis=0) == (whole == 1).any(axis=0)).all()


def test_a_lid_over_a_drum_that_stands_stays(machine: np.ndarray):
    made, notes = round_portholes(machine, outline(axis=(0, 0, 1)))
    assert (made == machine).all()
    assert notes == ()


@pytest.mark.parametrize(("width", "rounded"), [(16, True), (15, False)])
def test_a_door_a_quarter_higher_than_wide_is_round_and_a_narrower_one_is_not(machine, width, rounded):
    door = (DOOR[0], slice(16 - width // 2, 16 + width - width // 2), DOOR[2])
    machine[DOOR] = -1
    machine[door] = 1
    rows = np.stack([outline()[0], row("door", door, "revolute", axis=(0, 0, 1), turn=0.4), outline()[2]])
    assert (round_portholes(machine, rows)[1] != ()) == rounded


def test_true_objects_hardly_change():
    for category, seeds in (("WashingMachine", (1, 2, 8)), ("Microwave", (0,)), ("Oven", (0,))):
        for seed in seeds:
            asset = shape_to_asset(draw_shape(category, seed), 64)
            assert asset.voxels is not None
            owners = np.full((64,) * 3, -1)
            owners[tuple(asset.voxels.coords.T)] = asset.voxels.part_ids
            made, _ = round_portholes(owners, tabulate_parts(asset))
            allowed = 0.007 if category == "WashingMachine" else 0.0
            assert (made != owners).sum() <= allowed * len(asset.voxels.coords)


def around(beyond: int, layer: int = PLATE) -> np.ndarray:
    """A square door before a plate whose square hole is a few cells wider than the door on each side."""
    owners = np.full((EDGE,) * 3, -1)
    owners[layer, 1:31, 1:31] = 0
    owners[layer, 6 - beyond : 26 + beyond, 6 - beyond : 26 + beyond] = -1
    owners[DOOR] = 1
    return owners


@pytest.mark.parametrize(("behind", "found"), [(6, True), (7, False)])
def test_the_plate_is_sought_in_the_seven_layers_behind_the_door(behind: int, found: object):
    made, _ = round_portholes(around(0, PLATE + behind), outline())
    corners = (radii() > 0.80)[6:26, 6:26]
    assert (made[PLATE + behind, 6:26, 6:26][corners] == (0 if found else -1)).all()


@pytest.mark.parametrize(("beyond", "found"), [(2, True), (3, False)])
def test_the_plate_is_sought_three_cells_around_the_door(beyond: int, found: object):
    made, _ = round_portholes(around(beyond), outline())
    corners = (radii() > 0.80)[6:26, 6:26]
    assert (made[PLATE, 6:26, 6:26][corners] == (0 if found else -1)).all()


@pytest.mark.parametrize(("share", "whole"), [(0.71, True), (0.69, False)])
def test_a_layer_of_a_door_with_seven_tenths_of_its_rim_gets_the_rest(
    machine: np.ndarray, share: float, whole: object
):
    radius = radii()
    rim = np.argwhere((radius > 0.80) & (radius <= 1.0))
    lost = rim[round(share * len(rim)) :]
    machine[4][tuple(lost.T)] = -1
    made, _ = round_portholes(machine, outline())
    assert (made[4][tuple(lost.T)] == (1 if whole else -1)).all()
