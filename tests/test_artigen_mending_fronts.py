"""Fronts of doors and drawers: torn ones become whole in their own shape, whole ones stay."""

import numpy as np
import pytest
from cupboard import BASE, DOOR, EDGE, carcass, row

from artigen.fields import decode, encode, tabulate_parts
from artigen.mending.fronts import fill_fronts
from artigen.mending.rows import read_owners
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import PAPER_CATEGORIES, PartLabel

ROWS = np.stack([BASE, row("door", DOOR)])
BIN = (slice(3, 6), slice(6, 26), slice(8, 12))


@pytest.fixture
def cupboard() -> np.ndarray:
    """A carcass with a door that carries a bin on its inside."""
    owners = carcass()
    owners[DOOR] = owners[BIN] = 1
    return owners


@pytest.mark.parametrize("category", PAPER_CATEGORIES)
def test_true_objects_stay(category: str):
    for seed in range(2):
        asset = shape_to_asset(draw_shape(category, seed), 64)
        rows = tabulate_parts(asset)
        owners = read_owners(decode(encode(asset)), rows)
        made, notes = fill_fronts(owners, rows)
        assert (made == owners).all()
        assert notes == ()


def test_a_torn_front_gets_its_panel_back_and_nothing_else(cupboard: np.ndarray):
    torn = cupboard.copy()
    torn[1:3, 12:28, 14:28] = -1
    torn[1:3, 20:24, 14:20] = 0  # the body shows through
    made, notes = fill_fronts(torn, ROWS)
    assert (made == cupboard).all()
    assert notes == ("1 fronts of doors and drawers were filled, by 448 cells at most",)


@pytest.mark.parametrize(("label", "stays"), [("drawer", True), ("door", False)])
def test_a_drawer_may_have_a_hole_in_its_front_and_a_door_none(
    cupboard: np.ndarray, label: PartLabel, *, stays: bool
):
    rows = np.stack([BASE, row(label, DOOR)])
    torn = cupboard.copy()
    torn[1:3, 10:22, 10:18] = -1
    torn[BIN] = -1
    cupboard[BIN] = -1
    assert (fill_fronts(torn, rows)[0] == (torn if stays else cupboard)).all()


def test_a_round_front_stays_round():
    y, z = np.meshgrid(np.arange(EDGE) - 15.5, np.arange(EDGE) - 15.5, indexing="ij")
    disc = np.hypot(y, z) < 12
    owners = carcass()
    owners[1:3][:, disc] = 1
    torn = owners.copy()
    torn[1:3, 4:28, 18:28] = -1
    made, _ = fill_fronts(torn, ROWS)
    assert (made[1:3] == 1).all(axis=0).sum() == pytest.approx(disc.sum(), rel=0.02)
    assert (made == owners).mean() > 0.999


def test_a_part_without_cells_is_not_made_up():
    owners = carcass()
    assert (fill_fronts(owners, ROWS)[0] == owners).all()
