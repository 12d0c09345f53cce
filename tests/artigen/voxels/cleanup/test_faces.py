"""Faces: holes, stairs and frayed edges are made even; strips, panels, openings and true objects stay."""

import numpy as np
import pytest
from cupboard import BASE, EDGE, carcass, row

from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import PAPER_CATEGORIES
from artigen.voxels.cleanup.faces import even_faces, weigh_depths
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import ROW, name_category, tabulate_parts

DOOR = (slice(1, 4), slice(4, 28), slice(4, 28))
ROWS = np.stack([BASE, row("door", DOOR, "revolute", axis=(0, 0, 1), turn=0.25)])
CERTAIN = 6.0
Y, Z = np.meshgrid(np.arange(EDGE), np.arange(EDGE), indexing="ij")
WITHIN = (Y >= 4) & (Y < 28) & (Z >= 4) & (Z < 28)
STAIR = WITHIN & (Y + Z > 38)
CORNER = (Y >= 16) & (Y < 28) & (Z >= 16) & (Z < 28)
SPOT = (Y >= 12) & (Y < 18) & (Z >= 14) & (Z < 19)
PANEL = (Y >= 8) & (Y < 24) & (Z >= 8) & (Z < 24)
FRAME = WITHIN & ~((Y >= 7) & (Y < 25) & (Z >= 7) & (Z < 25))
GRIP = (Y >= 23) & (Y < 26) & (Z >= 13) & (Z < 20)
ASIDE = (Y >= 4) & (Y < 16) & (Z >= 8) & (Z < 24)


def of_category(name: str, rows: np.ndarray = ROWS) -> np.ndarray:
    """The same rows, of an object of a category."""
    out = rows.copy()
    out[:, ROW.category] = [kind == name for kind in PAPER_CATEGORIES]
    return out


def even(owners: Owners, rows: np.ndarray = ROWS) -> Owners:
    """Owners with even faces, where the network is sure of what it drew."""
    made, notes = even_faces(owners, np.where(owners >= 0, CERTAIN, -CERTAIN), rows)
    changed = int((made != owners).sum())
    said = f"{changed} cells of holes, stairs and frayed edges of faces were made even"
    assert notes == ((said,) if changed else ())
    return made


@pytest.fixture
def cupboard() -> Owners:
    owners = carcass()
    owners[DOOR] = 1
    return owners


def test_a_cupboard_stays(cupboard: Owners):
    assert (even(cupboard) == cupboard).all()


@pytest.mark.parametrize(("axis", "place"), [(1, 4), (1, 26), (0, 26), (2, 26)])
@pytest.mark.parametrize("shape", [STAIR, CORNER, SPOT])
@pytest.mark.parametrize("deep", [1, 2])
def test_dents_and_holes_in_boards_are_closed(
    cupboard: Owners, axis: int, place: int, shape: np.ndarray, deep: int
):
    """Seen from its side, the board loses its outer layer or both."""
    dented = cupboard.copy()
    outer = place if place == 4 else place + 2 - deep
    layers = np.moveaxis(dented, axis, 0)[outer : outer + deep]
    inner = shape & (Y >= 6) & (Y < 26) & (Z >= 6) & (Z < 26)
    layers[:, inner] = np.where(layers[:, inner] == 0, -1, layers[:, inner])
    assert (dented != cupboard).sum() > 20
    made = even(dented)
    assert (made == cupboard).all()
    assert (even(made) == made).all()


def test_what_stands_on_a_board_is_planed_off(cupboard: Owners):
    cupboard[28:30, 10:20, 14:22] = 0
    made = even(cupboard)
    assert (made[28:] < 0).all()
    assert (made[:28] == cupboard[:28]).all()


def test_a_worktop_over_its_sides_stays(cupboard: Owners):
    cupboard[4:28, 2:30, 26:28] = 0
    assert (even(cupboard) == cupboard).all()


def test_a_plinth_and_feet_stay(cupboard: Owners):
    cupboard[:, :, 4:8] = -1
    for x in (4, 25):
        for y in (4, 25):
            cupboard[x : x + 3, y : y + 3, 4:8] = 0
    cupboard[4:28, 4:28, 8:10] = 0
    assert (even(cupboard) == cupboard).all()


@pytest.mark.parametrize(
    ("shape", "stays"),
    [(STAIR, False), (CORNER, False), (ASIDE, False), (PANEL, True), (FRAME, True), (GRIP, True)],
)
@pytest.mark.parametrize("deep", [1, 2])
def test_of_what_is_cut_into_a_front_panels_and_grips_stay(
    cupboard: Owners, shape: np.ndarray, deep: int, *, stays: bool
):
    cut = cupboard.copy()
    cut[1 : 1 + deep][:, shape] = -1
    assert (even(cut) == (cut if stays else cupboard)).all()


def test_other_parts_on_a_face_stay(cupboard: Owners):
    rows = np.concatenate([ROWS, row("handle", (slice(0, 1), slice(8, 10), slice(8, 14)))[None]])
    cupboard[0, 8:10, 8:14] = 2
    assert (even(cupboard, rows) == cupboard).all()


def test_the_edge_of_an_open_body_is_straight():
    whole = carcass()
    frayed = whole.copy()
    frayed[4, 4:6, 8:20:3] = -1
    frayed[4:6, 10:13, 26:28] = -1
    assert (even(frayed, BASE[None]) == whole).all()


def test_tables_are_open_below_and_cooktops_carry_burners():
    table = carcass()
    table[:, 8:24, 4:24] = -1
    assert (even(table, of_category("Table", BASE[None])) == table).all()
    hob = carcass()
    hob[10:16, 10:16, 28] = 0
    assert (even(hob, of_category("Oven", BASE[None])) == hob).all()
    assert (even(hob, of_category("Microwave", BASE[None])) != hob).any()


def test_a_top_goes_on_over_a_drawer(cupboard: Owners):
    rows = np.stack([BASE, row("drawer", (slice(4, 20), slice(8, 20), slice(20, 28)), "prismatic")])
    cupboard[cupboard == 1] = -1
    sunk = cupboard.copy()
    sunk[8:16, 8:20, 20:27] = 1
    sunk[8:16, 8:20, 27] = -1
    made = even(sunk, of_category("Table", rows))
    assert (made[:, :, 26:28] == cupboard[:, :, 26:28]).all()
    assert (made[8:16, 8:20, 20:26] == 1).all()


def test_the_front_of_a_washing_machine_is_whole_around_its_door(cupboard: Owners):
    disc = np.hypot(Y - 15.5, Z - 15.5) < 8
    cupboard[cupboard == 1] = -1
    cupboard[2:4, disc] = 1
    cupboard[4:6, 4:28, 4:28] = 0
    whole = cupboard.copy()
    whole[4:6, disc] = -1
    torn = whole.copy()
    torn[4:6, STAIR & (Y < 26) & (Z < 26)] = -1
    rows = of_category("WashingMachine")
    assert (torn != whole).sum() > 80
    assert (even(whole, rows) == whole).all()
    assert (even(torn, rows) == whole).all()


def test_columns_begin_at_their_first_cell():
    cells = np.random.default_rng(0).random((5, 40, 40)) < 0.3
    weights = weigh_depths(np.where(cells, 1.0, -1.0))
    first = np.where(cells.any(axis=0), cells.argmax(axis=0), 5)
    assert weights.shape == (6, 40, 40)
    assert (weights.argmax(axis=0) == first).all()
    assert (weights.max(axis=0) == 5.0).all()


def test_uncertain_cells_speak_for_no_depth():
    assert (weigh_depths(np.zeros((4, 1, 1))) == 0.0).all()


@pytest.mark.parametrize("category", PAPER_CATEGORIES)
def test_true_objects_hardly_change(category: str):
    for seed in (0, 3):
        asset = shape_to_asset(draw_shape(category, seed), 64)
        assert asset.voxels is not None
        owners = np.full((64,) * 3, -1)
        owners[tuple(asset.voxels.coords.T)] = asset.voxels.part_ids
        rows = tabulate_parts(asset)
        assert name_category(rows) == category
        assert (even(owners, rows) != owners).sum() < 0.015 * (owners >= 0).sum()
