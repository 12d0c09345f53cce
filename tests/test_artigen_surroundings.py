"""What is told of a voxel's surroundings: ends, gaps, labels; whatever the order and the place."""

import numpy as np
import pytest

from artigen.facings import FACINGS, facing_frames, find_facings
from artigen.surroundings import GAP, NEAR, SURROUNDINGS, describe_surroundings
from artigen.types import PART_LABELS

EDGE = 24
AROUND = 3 + len(PART_LABELS) + 1
FIRST = 30
"""Where what lies around begins: after two places within extents."""
LABELS = np.array([PART_LABELS.index("base"), PART_LABELS.index("shelf")])


def make_room() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A hollow box from 4 to 19; a shelf of its own at height 10 leaves a gap of two cells all around."""
    grid = np.full((EDGE,) * 3, -1)
    grid[4:20, 4:20, 4:20] = 0
    grid[5:19, 5:19, 5:19] = -1
    grid[7:17, 7:17, 10] = 1
    cells = np.argwhere(grid >= 0)
    part_ids = grid[tuple(cells.T)]
    return cells, part_ids, find_facings(cells, part_ids, EDGE)


def look(cells: np.ndarray, part_ids: np.ndarray, facings: np.ndarray) -> np.ndarray:
    return describe_surroundings(cells, part_ids, facings, LABELS, EDGE)


def ways_of(told: np.ndarray) -> np.ndarray:
    """Outwards, inwards, and four across."""
    return told[:, FIRST : FIRST + FACINGS * AROUND].reshape(-1, FACINGS, AROUND)


def row_of(cells: np.ndarray, place: tuple[int, int, int]) -> int:
    return int(np.flatnonzero((cells == place).all(axis=1))[0])


def test_a_ceiling_sees_the_shelf_below_and_nothing_above():
    room = make_room()
    told = look(*room)
    assert told.shape == (len(room[0]), SURROUNDINGS)
    row = row_of(room[0], (12, 12, 19))
    assert room[2][row] == 5
    above, below = ways_of(told)[row, :2]
    nothing, shelf = np.eye(len(PART_LABELS) + 1)[[-1, PART_LABELS.index("shelf")]]
    np.testing.assert_array_equal(above, [0.0, 0.0, 1.0, *nothing])
    np.testing.assert_allclose(below, [0.0, np.exp(-8 / GAP), 8 / EDGE, *shelf], atol=1e-6)
    across = ways_of(told)[row, 2:]
    np.testing.assert_allclose(np.sort(across[:, 0]), np.sort([7, 7, 8, 8]) / NEAR)


def test_places_and_ends_are_those_of_the_part_and_of_the_object():
    cells, part_ids, facings = make_room()
    told = look(cells, part_ids, facings)
    corner = told[row_of(cells, (7, 16, 10))]
    np.testing.assert_allclose(corner[:3], [-1.0, 1.0, 0.0])
    np.testing.assert_allclose(corner[3:9], [0.0, 1.0, 0.0, 1.0, 0.0, 0.0])
    np.testing.assert_array_equal(corner[9:15], [1, 0, 1, 0, 1, 1])
    np.testing.assert_allclose(corner[15:18], [-9 / 15, 9 / 15, -3 / 15], atol=1e-6)
    np.testing.assert_allclose(corner[18:24], [3 / NEAR, 1.0, 6 / NEAR, 1.0, 3 / NEAR, 1.0])
    assert not corner[24:30].any()


def test_nearness_falls_with_distance_and_is_whole_on_the_label_itself():
    cells, part_ids, facings = make_room()
    near = look(cells, part_ids, facings)[:, -2 * len(PART_LABELS) :].reshape(-1, 2, len(PART_LABELS))
    assert (near[part_ids == 1][:, :, LABELS[1]] == 1.0).all()
    away = np.abs(cells[part_ids == 0] - [11.5, 11.5, 10]).clip([4.5, 4.5, 0], None) - [4.5, 4.5, 0]
    distance = np.linalg.norm(away, axis=1)
    np.testing.assert_allclose(near[part_ids == 0][:, 0, LABELS[1]], np.exp(-distance / 2.0), atol=1e-6)
    assert not np.delete(near, LABELS, axis=2).any()


def test_neither_order_nor_place_matters_and_rows_are_picked():
    cells, part_ids, facings = make_room()
    told = look(cells, part_ids, facings)
    rng = np.random.default_rng(0)
    order = rng.permutation(len(cells))
    np.testing.assert_array_equal(look(cells[order], part_ids[order], facings[order]), told[order])
    np.testing.assert_array_equal(look(cells + np.array([3, -2, 4]), part_ids, facings), told)
    rows = rng.choice(len(cells), 50)
    picked = describe_surroundings(cells, part_ids, facings, LABELS, EDGE, rows)
    np.testing.assert_array_equal(picked, told[rows])


@pytest.mark.parametrize("facing", range(FACINGS))
def test_ways_are_those_of_the_frame_of_the_outer_side(facing: int):
    """One voxel, and another at its own distance in each direction."""
    frame = np.round(facing_frames()[facing]).astype(int)
    ways = np.concatenate([frame.T, -frame.T])[[0, 3, 1, 4, 2, 5]]
    cells = np.array([[11, 11, 11]] + [[11, 11, 11] + (number + 2) * way for number, way in enumerate(ways)])
    told = look(cells, np.zeros(7, dtype=int), np.full(7, facing))
    np.testing.assert_allclose(ways_of(told)[0, :, 2], np.arange(1, 7) / EDGE, atol=1e-6)
