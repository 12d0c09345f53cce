"""Boards out of cells: what is exact stays, what is torn is mended, parts keep to themselves."""

import numpy as np
import pytest
from cupboard import BASE, DOOR, EDGE, KNOB, carcass, row

from artigen.voxels.cleanup.boards import _make_part, make_boards
from artigen.voxels.cleanup.boxes import fill_boxes, find_boxes
from artigen.voxels.fields import ROW

ROWS = np.stack([BASE, row("door", DOOR), row("knob", KNOB)])


@pytest.fixture
def cupboard() -> np.ndarray:
    """Owner of every cell of an open carcass with a door before it and a knob on that."""
    owners = carcass()
    owners[DOOR], owners[KNOB] = 1, 2
    return owners


def remake(owners: np.ndarray) -> np.ndarray:
    logits = np.where(owners >= 0, 6.0, -6.0)
    return make_boards(owners, logits, ROWS)[0]


def test_what_is_made_of_boards_stays_and_is_not_noted(cupboard: np.ndarray):
    made, notes = make_boards(cupboard, np.where(cupboard >= 0, 6.0, -6.0), ROWS)
    assert (made == cupboard).all()
    assert notes == ()


@pytest.mark.parametrize("axes", [(0, 2, 1), (2, 1, 0), (1, 2, 0)])
def test_boxes_do_not_depend_on_the_axes(cupboard: np.ndarray, axes: tuple[int, int, int]):
    evidence = np.where(cupboard == 0, 1.0, -1.0)
    turned = evidence.transpose(axes)
    assert (fill_boxes(turned.shape, find_boxes(turned, 10)) == (turned > 0)).all()


def test_dents_pinholes_and_ragged_rims_are_mended(cupboard: np.ndarray):
    generator = np.random.default_rng(0)
    torn = cupboard.copy()
    torn[(cupboard == 1) & (generator.random(cupboard.shape) < 0.15)] = -1
    torn[1:3, 4:8, 4:9] = -1  # a corner
    torn[1:3, 28, 4:28][:, generator.random(24) < 0.3] = 1  # a rim
    assert (torn != cupboard).sum() > 150
    assert (remake(torn) == cupboard).all()


def test_cells_of_the_body_within_a_door_become_the_doors(cupboard: np.ndarray):
    speckled = cupboard.copy()
    speckled[1:3, 10:13, 10:13] = 0
    assert (remake(speckled) == cupboard).all()


def test_a_window_stays_open_and_a_dent_does_not(cupboard: np.ndarray, monkeypatch: pytest.MonkeyPatch):
    window = cupboard.copy()
    window[1:3, 8:20, 8:20] = -1
    assert (remake(window) == window).all()
    monkeypatch.setattr("artigen.voxels.cleanup.boards.LEAST_CUT", 400)
    assert (remake(window) == cupboard).all()


def test_the_gap_between_door_and_body_stays_empty(cupboard: np.ndarray):
    assert (remake(cupboard)[3] == -1).all()


def test_small_and_round_parts_stay_as_they_were_drawn(cupboard: np.ndarray):
    worn = cupboard.copy()
    worn[0, 14, 14] = -1
    assert (remake(worn) == worn).all()


def test_small_parts_keep_within_their_boxes(cupboard: np.ndarray):
    swollen = cupboard.copy()
    swollen[0, 13:17, 13:17] = 2
    assert (remake(swollen) == cupboard).all()


def test_a_turntable_stays_round():
    across, along = np.meshgrid(np.arange(EDGE) - 15.5, np.arange(EDGE) - 15.5, indexing="ij")
    owners = np.full((EDGE,) * 3, -1)
    owners[..., 8:10][np.hypot(across, along) < 11] = 0
    logits = np.where(owners >= 0, 6.0, -6.0)
    for joint, stays in (("continuous", True), ("fixed", False)):
        rows = np.stack([row("tray", (slice(5, 27), slice(5, 27), slice(8, 10)), joint)])
        made, _ = make_boards(owners, logits, rows)
        assert (made == owners).all() == stays


def test_a_part_without_cells_is_not_made_up(cupboard: np.ndarray):
    without = np.where(cupboard == 1, -1, cupboard)
    assert not (remake(without) == 1).any()


def test_a_slanted_piece_stays_beside_the_boards():
    owners = np.full((EDGE,) * 3, -1)
    for step in range(20):  # a slope that no box of ten cells holds
        owners[4 + step, 4:9, 4 + step] = 0
    rows = np.stack([row("base", (slice(4, 28), slice(4, 28), slice(4, 28)))])
    made, _ = make_boards(owners, np.where(owners >= 0, 6.0, -6.0), rows)
    assert (made == owners).all()


def test_the_note_counts_what_changed(cupboard: np.ndarray):
    torn = cupboard.copy()
    torn[1, 10:12, 10:12] = -1
    torn[3, 20, 20] = 1
    _, notes = make_boards(torn, np.where(torn >= 0, 6.0, -6.0), ROWS)
    assert notes == (f"boards: 4 cells were filled and 1 cleared, of {(torn >= 0).sum()}",)


def test_evidence_that_is_too_little_makes_no_box():
    evidence = np.full((8, 8, 8), -1.0)
    evidence[2:4, 2:4, 2:4] = 1.0
    assert find_boxes(evidence, 8.5) == []
    assert find_boxes(evidence, 8.0) == [(slice(2, 4),) * 3]


def keeps(cells: np.ndarray, others: np.ndarray | None = None) -> bool:
    """Whether every certain cell of a part stays."""
    owned = np.where(cells, 0, -1) if others is None else np.where(others, 1, np.where(cells, 0, -1))
    return bool(_make_part(owned, np.intp(0), np.where(owned >= 0, 1.0, -1.0))[owned == 0].all())


@pytest.mark.parametrize(("length", "kept"), [(20, True), (19, False)])
def test_a_board_has_twenty_cells(length: int, kept: object):
    cells = np.zeros((EDGE, 5, 5), dtype=bool)
    cells[2 : 2 + length, 2, 2] = True
    assert keeps(cells) == kept


@pytest.mark.parametrize(("logit", "kept"), [(4.0, True), (3.9, False)])
def test_a_logit_of_four_is_certain(logit: float, kept: object):
    owners = np.full((EDGE,) * 3, -1)
    bar = (slice(2, 22), slice(2, 3), slice(2, 3))
    owners[bar] = 0
    made, _ = make_boards(owners, np.where(owners >= 0, logit, -6.0), np.stack([row("base", bar)]))
    assert (made == owners).all() == kept


@pytest.mark.parametrize(("between", "kept"), [(39, True), (41, False)])
def test_cells_of_others_count_a_quarter_against_a_board_through_them(between: int, kept: object):
    """Two ends of fifteen cells are a board only together."""
    cells, others = np.zeros((2, 80, 5, 5), dtype=bool)
    cells[2 : 32 + between, 2, 2] = True
    others[17 : 17 + between, 2, 2] = True
    assert keeps(cells, others) == kept


@pytest.mark.parametrize(("height", "width", "filled"), [(10, 10, False), (9, 11, True)])
def test_an_opening_has_a_hundred_cells(height: int, width: int, filled: object):
    panel = np.zeros((3, 30, 30), dtype=bool)
    panel[1] = True
    panel[1, 8 : 8 + height, 8 : 8 + width] = False
    owned = np.where(panel, 0, -1)
    made = _make_part(owned, np.intp(0), np.where(panel, 1.0, -1.0))
    assert made[1].all() == filled


@pytest.mark.parametrize(("missing", "kept"), [(8, True), (9, False)])
def test_a_hundred_cells_without_a_board_stay(missing: int, kept: object):
    """Every second cell of a cube of six, of which no box holds more than it lacks."""
    cells = np.zeros((10, 10, 10), dtype=bool)
    cells[2:8, 2:8, 2:8] = np.indices((6, 6, 6)).sum(axis=0) % 2 == 0
    cells[tuple(np.argwhere(cells)[:missing].T)] = False
    assert keeps(cells) == kept


@pytest.mark.parametrize(("short", "kept"), [(0.24, True), (0.26, False)])
def test_boards_exceed_the_box_of_their_part_by_a_quarter_of_a_cell(short: float, kept: object):
    owners = np.full((EDGE,) * 3, -1)
    place = (slice(4, 28), slice(4, 28), slice(4, 8))
    owners[place] = 0
    base = row("base", place)
    base[ROW.box.start + 5] -= 2 * (1.0 + short) / EDGE  # a layer less at both ends, and a little more
    made, _ = make_boards(owners, np.where(owners >= 0, 6.0, -6.0), base[None])
    assert (made == owners).all() == kept


@pytest.mark.parametrize(("lumps", "found"), [(19, 1), (20, 0)])
def test_the_search_for_boxes_ends_after_twenty_starts_in_vain(lumps: int, found: int):
    """Lumps of 18 cells are surer than a bar of 20, and too small."""
    evidence = np.full((24, 24, 24), -9.0)
    for lump in range(lumps):
        x, y = 1 + 5 * (lump % 4), 1 + 4 * (lump // 4)
        evidence[x : x + 3, y : y + 3, 1:3] = 1.0
    evidence[1:21, 22, 20] = 1.0
    assert len(find_boxes(evidence, 20)) == found


@pytest.mark.parametrize(("specks", "open_"), [(29, True), (30, False)])
def test_an_opening_is_empty_in_seventeen_of_twenty_cells(specks: int, open_: object):
    """196 cells with some of the board scattered in it: 0.852 and 0.847 of them are empty."""
    panel = np.zeros((3, 30, 30), dtype=bool)
    panel[1] = True
    panel[1, 8:22, 8:22] = False
    within = [(y, z) for y in range(9, 21, 2) for z in range(9, 21, 2)][:specks]
    panel[1][tuple(np.transpose(within))] = True
    made = _make_part(np.where(panel, 0, -1), np.intp(0), np.where(panel, 1.0, -1.0))[1]
    assert made[8:22, 8:22].any() != open_
    assert made[8:22, 8:22].all() != open_


def test_boards_in_openings_have_openings_and_what_is_in_those_has_none():
    """Squares in one another: board, opening, board, opening, and a board whose opening is closed."""
    drawn = np.zeros((1, 202, 202), dtype=bool)
    for edge, full in ((200, True), (130, False), (62, True), (40, False), (18, True), (10, False)):
        start = 101 - edge // 2
        drawn[0, start : start + edge, start : start + edge] = full
    wanted = drawn.copy()
    wanted[0, 96:106, 96:106] = True
    made = _make_part(np.where(drawn, 0, -1), np.intp(0), np.where(drawn, 1.0, -1.0))
    assert (made == wanted).all()
