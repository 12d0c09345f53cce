"""Faces: stairs and stains are evened out, rectangles, frames and discs stay."""

import numpy as np
import pytest
from cupboard import BASE, EDGE, carcass, row

from artigen.mending.relief import flatten_faces

DOOR = (slice(1, 4), slice(4, 28), slice(4, 28))
ROWS = np.stack([BASE, row("door", DOOR, "revolute", axis=(0, 0, 1), turn=0.25)])
Y, Z = np.meshgrid(np.arange(EDGE), np.arange(EDGE), indexing="ij")
WITHIN = (Y >= 4) & (Y < 28) & (Z >= 4) & (Z < 28)
STAIR = WITHIN & (Y + Z < 24)
FRAME = WITHIN & ((Y < 7) | (Y >= 25) | (Z < 7) | (Z >= 25))
DISC = np.hypot(Y - 15.5, Z - 15.5) < 5
PANEL = (Y >= 8) & (Y < 20) & (Z >= 8) & (Z < 24)


@pytest.fixture
def cupboard() -> np.ndarray:
    owners = carcass()
    owners[DOOR] = 1
    return owners


@pytest.mark.parametrize("depth", [1, 2])
@pytest.mark.parametrize(("shape", "stays"), [(STAIR, False), (FRAME, True), (DISC, True), (PANEL, True)])
def test_of_what_is_cut_into_a_front_only_what_is_no_figure_goes(
    cupboard: np.ndarray, shape: np.ndarray, depth: int, *, stays: bool
):
    cut = cupboard.copy()
    cut[1 : 1 + depth][:, shape] = -1
    made, notes = flatten_faces(cut, ROWS)
    assert (made == (cut if stays else cupboard)).all()
    said = f"{(cut != cupboard).sum()} cells of steps and stains on faces were evened out"
    assert notes == (() if stays else (said,))


def test_what_stands_out_of_a_front_goes_too(cupboard: np.ndarray):
    raised = cupboard.copy()
    raised[0][STAIR] = 1
    assert (flatten_faces(raised, ROWS)[0] == cupboard).all()


@pytest.mark.parametrize(("axis", "place"), [(1, 4), (1, 27), (0, 27)])
def test_stains_on_the_sides_and_the_back_of_a_body_are_filled(cupboard: np.ndarray, axis: int, place: int):
    dented = cupboard.copy()
    layer = np.moveaxis(dented, axis, 0)[place]
    layer[STAIR & (layer == 0)] = -1
    made, _ = flatten_faces(dented, ROWS)
    assert (made == cupboard).all()
    assert (dented != cupboard).sum() > 100


def test_a_front_of_no_main_depth_stays(cupboard: np.ndarray):
    """A wedge is no face with steps on it."""
    slanted = cupboard.copy()
    for step in range(8):
        slanted[1:4, 4 + 3 * step : 7 + 3 * step, 4:28] = -1
        slanted[step : step + 2, 4 + 3 * step : 7 + 3 * step, 4:28] = 1
    made, _ = flatten_faces(slanted, ROWS)
    assert ((made == 1) == (slanted == 1)).all()


def test_other_parts_on_a_face_stay(cupboard: np.ndarray):
    rows = np.concatenate([ROWS, row("handle", (slice(0, 1), slice(8, 10), slice(8, 14)))[None]])
    cupboard[0, 8:10, 8:14] = 2
    assert (flatten_faces(cupboard, rows)[0] == cupboard).all()


HOLES = {
    "stairs": (STAIR, True),
    "rectangle": ((Y >= 8) & (Y < 20) & (Z >= 8) & (Z < 24), False),
    "disc": (DISC, False),
}


@pytest.mark.parametrize("shape", HOLES)
def test_a_hole_in_a_top_is_closed_unless_it_is_a_figure(cupboard: np.ndarray, shape: str):
    hole, closed = HOLES[shape]
    inner = hole & (Y >= 6) & (Y < 26) & (Z >= 6) & (Z < 26)
    holed = cupboard.copy()
    holed[:, :, 26:28][inner] = -1
    made, _ = flatten_faces(holed, ROWS)
    assert (holed != cupboard).sum() > 100
    assert (made == (cupboard if closed else holed)).all()


def test_what_stands_on_a_top_stays(cupboard: np.ndarray):
    loaded = cupboard.copy()
    loaded[:, :, 28:30][STAIR & (Y < 26)] = 0
    assert (flatten_faces(loaded, ROWS)[0] == loaded).all()


def test_feet_beside_a_round_top_are_no_holes_in_it():
    table = np.full((EDGE,) * 3, -1)
    table[:, :, 24:26][np.hypot(Y - 15.5, Z - 15.5) < 12] = 0
    table[4:28, 4:28, 2:4] = 0
    table[14:18, 14:18, 4:24] = 0
    assert (flatten_faces(table, BASE[None])[0] == table).all()
