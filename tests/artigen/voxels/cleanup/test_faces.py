"""Faces: holes, stairs and frayed edges are made even; strips, panels, openings and true objects stay."""

import numpy as np
import pytest
from cupboard import BASE, EDGE, carcass, row

from artigen.kind import paper_kinds
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
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
    out[:, ROW.category] = [kind == name for kind in paper_kinds()]
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


@pytest.mark.parametrize("category", paper_kinds())
def test_true_objects_hardly_change(category: str):
    for seed in (0, 3):
        asset = shape_to_asset(draw_shape(category, seed), 64)
        assert asset.voxels is not None
        owners = np.full((64,) * 3, -1)
        owners[tuple(asset.voxels.coords.T)] = asset.voxels.part_ids
        rows = tabulate_parts(asset)
        assert name_category(rows) == category
        assert (even(owners, rows) != owners).sum() < 0.015 * (owners >= 0).sum()


@pytest.mark.parametrize(("logit", "stays"), [(1.25, True), (1.15, False)])
def test_a_panel_stays_from_a_logit_of_one_and_two_tenths(cupboard: Owners, logit: float, stays: object):
    """Certain is four. A panel has 1.3 of evidence per cell: one as drawn, and a quarter of its logit."""
    cut = cupboard.copy()
    cut[1][PANEL] = -1
    logits = np.where(cut >= 0, CERTAIN, -CERTAIN)
    logits[1][PANEL] = -logit
    assert (even_faces(cut, logits, ROWS)[0] == (cut if stays else cupboard)).all()


@pytest.mark.parametrize(("deep", "closed"), [(5, True), (6, False)])
def test_holes_are_closed_in_panels_that_begin_in_the_first_six_layers(deep: int, closed: object):
    whole = np.full((EDGE,) * 3, -1)
    whole[1:9, WITHIN] = 1
    whole[1 : 1 + deep, 9:23, 9:23] = -1
    torn = whole.copy()
    torn[1:9, 15:17, 15:17] = -1
    assert (even(torn) == (whole if closed else torn)).all()


@pytest.mark.parametrize(("layer", "stays"), [(0, True), (1, False)])
def test_a_part_lies_on_a_face_in_the_first_layer_and_is_seen_through_a_hole_in_the_second(
    cupboard: Owners, layer: int, stays: object
):
    rows = np.concatenate([ROWS, row("handle", (slice(1, 2), slice(10, 12), slice(12, 16)))[None]])
    cupboard[1:4, 10:12, 12:16] = -1
    cupboard[1 + layer, 10:12, 12:16] = 2
    made = even(cupboard, rows)
    assert (made == cupboard).all() == stays
    assert (made[1, 10:12, 12:16] == (2 if stays else 1)).all()


@pytest.mark.parametrize(("drawn", "closed"), [(12, True), (11, False)])
def test_a_face_ends_with_the_last_line_that_is_half_drawn(cupboard: Owners, drawn: int, closed: object):
    """A line of 24 cells along the upper edge of a door, of which every second is missing, or one more."""
    frayed = cupboard.copy()
    frayed[1:4, 4 : 4 + 2 * drawn : 2, 28] = 1
    whole = cupboard.copy()
    whole[1:4, 4:28, 28] = 1
    assert (even(frayed) == (whole if closed else frayed)).all()


@pytest.mark.parametrize(("width", "closed"), [(11, True), (12, False)])
def test_what_is_seen_in_three_fifths_of_its_outline_is_a_face(cupboard: Owners, width: int, closed: object):
    """A door with a window, which covers 0.38 or 0.42 of it, and a small hole."""
    cupboard[1:4, 10 : 10 + width, 6:26] = -1
    torn = cupboard.copy()
    torn[1:4, 6:8, 4:6] = -1
    assert (even(torn) == (cupboard if closed else torn)).all()


@pytest.mark.parametrize(("width", "closed"), [(10, True), (11, False)])
def test_a_board_that_lacks_more_than_seven_twentieths_was_meant_to_be_open(width: int, closed: object):
    """A top with two holes across from each other, 0.347 or 0.365 of it."""
    top = np.full((EDGE,) * 3, -1)
    top[WITHIN, 26:28] = 0
    torn = top.copy()
    torn[5:15, 5:15] = torn[16:26, 16 : 16 + width] = -1
    assert (even(torn, BASE[None]) == (top if closed else torn)).all()


def test_recesses_in_openings_of_a_front_have_openings_and_what_is_in_those_has_none():
    """Squares in one another: board, recess, opening, recess, and an opening that is closed."""
    drawn = np.full((6, 44, 44), -1)
    drawn[:2, 2:42, 2:42] = 0
    for edge, full in ((30, True), (18, False), (10, True), (6, False)):
        start = 22 - edge // 2
        drawn[:, start : start + edge, start : start + edge] = -1
        if full:
            drawn[3, start : start + edge, start : start + edge] = 0
    wanted = drawn.copy()
    wanted[3, 19:25, 19:25] = 0
    assert (even(drawn, of_category("Table", BASE[None])) == wanted).all()


@pytest.mark.parametrize(("thick", "filled"), [(2, 2), (3, 3), (4, 3), (5, 3)])
def test_holes_are_filled_three_cells_deep(thick: int, filled: int):
    door = np.full((EDGE,) * 3, -1)
    door[1 : 1 + thick, WITHIN] = 1
    torn = door.copy()
    torn[:, 14:16, 14:16] = -1
    made = even(torn)
    assert (made[1 : 1 + filled] == door[1 : 1 + filled]).all()
    assert (made[1 + filled :] == torn[1 + filled :]).all()
