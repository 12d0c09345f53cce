"""Which way outer sides face: boards of boxes, any orientation, junctions."""

from itertools import pairwise

import numpy as np
import pytest

from artigen.voxels.frames import (
    AROUND,
    FACINGS,
    SIDES,
    count_behind,
    facing_frames,
    find_covered,
    find_facings,
    find_joined,
)

EDGE = 20
WAYS = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]])


def make_box(low: int, high: int) -> np.ndarray:
    """Cells of a hollow box whose boards are one cell thick."""
    grid = np.zeros((EDGE,) * 3, dtype=bool)
    grid[low:high, low:high, low:high] = True
    grid[low + 1 : high - 1, low + 1 : high - 1, low + 1 : high - 1] = False
    return np.argwhere(grid)


def test_boards_of_a_box_face_outwards():
    cells = make_box(3, 17)
    facings = find_facings(cells, np.zeros(len(cells), dtype=int), EDGE)
    away = cells - 9.5
    inner = np.sort(np.abs(away), axis=1)[:, 1] < 5  # of one board alone
    assert inner.sum() > 300
    side = np.abs(away[inner]).argmax(axis=1)
    sign = np.sign(away[inner][np.arange(len(side)), side])
    np.testing.assert_array_equal(WAYS[facings[inner]][np.arange(len(side)), side], sign)


@pytest.mark.parametrize("turn", [(1, 2, 0), (2, 0, 1)])
def test_facings_turn_with_the_object(turn: tuple[int, int, int]):
    cells = make_box(3, 17)
    alone = np.sort(np.abs(cells - 9.5), axis=1)[:, 1] < 5
    plain, turned = (
        find_facings(one, np.zeros(len(cells), dtype=int), EDGE) for one in (cells, cells[:, turn])
    )
    np.testing.assert_array_equal(WAYS[turned][alone], WAYS[plain][alone][:, turn])


def test_a_door_faces_away_from_the_object_though_it_is_a_part_of_its_own():
    body = make_box(3, 17)
    door = np.argwhere(np.ones((1, 14, 14), dtype=bool)) + np.array([2, 3, 3])
    cells = np.concatenate([body, door])
    part_ids = np.repeat([0, 1], [len(body), len(door)])
    facings = find_facings(cells, part_ids, EDGE)
    assert (facings[part_ids == 1] == 0).all()
    back = part_ids == 1
    mirrored = find_facings(np.where([True, False, False], EDGE - 1 - cells, cells), part_ids, EDGE)
    assert (mirrored[back] == 1).all()


def test_a_shelf_does_not_turn_the_wall_that_it_meets():
    body = make_box(3, 17)
    shelf = np.argwhere(np.ones((12, 12, 1), dtype=bool)) + np.array([4, 4, 9])
    cells = np.concatenate([body, shelf])
    facings = find_facings(cells, np.zeros(len(cells), dtype=int), EDGE)
    wall = (cells[:, 1] == 3) & (np.abs(cells[:, 0] - 9.5) < 5) & (np.abs(cells[:, 2] - 9.5) < 5)
    assert (facings[wall] == 2).all()


def test_frames_are_rotations_that_face_as_they_should():
    frames = facing_frames()
    assert frames.shape == (FACINGS, 3, 3)
    np.testing.assert_array_equal(frames[:, :, 0], WAYS)
    np.testing.assert_allclose(np.linalg.det(frames), 1.0)
    np.testing.assert_allclose(frames @ frames.transpose(0, 2, 1), np.tile(np.eye(3), (FACINGS, 1, 1)))
    assert all(not np.array_equal(one, other) for one, other in pairwise(frames))


def test_what_stands_before_a_side_covers_it_unless_it_is_the_other_face_of_a_board():
    box = make_box(3, 17)
    facings = find_facings(box, np.zeros(len(box), dtype=int), EDGE)
    alone = np.sort(np.abs(box - 9.5), axis=1)[:, 1] < 5
    np.testing.assert_array_equal(find_covered(box, facings, EDGE)[alone], [[False, True]] * alone.sum())
    plate = np.argwhere(np.ones((EDGE, EDGE, 2), dtype=bool))
    facings = 4 + (plate[:, 2] > 0)
    assert not find_covered(plate, facings, EDGE).any()
    roof = np.array([[5, 5, 9]])
    both = np.concatenate([plate, roof])
    covered = find_covered(both, np.append(facings, 5), EDGE)
    below = (plate[:, :2] == 5).all(axis=1)
    np.testing.assert_array_equal(covered[:-1][below], [[False, True], [True, False]])
    assert covered[-1].tolist() == [False, True]
    assert not covered[:-1][~below].any()


def test_a_part_goes_on_where_its_own_cells_are_whichever_way_it_faces():
    row = np.array([[4, 4, z] for z in range(3, 7)])
    other = np.array([[4, 5, 4], [4, 4, 7]])
    cells, part_ids = np.concatenate([row, other]), np.repeat([2, 0], [4, 2])
    for facing, frame in enumerate(facing_frames()):
        joined = find_joined(cells, part_ids, np.full(6, facing), EDGE)
        ways = {
            tuple(way * frame[:, axis]): joined[:, axis - 1, side]
            for axis in (1, 2)
            for side, way in enumerate((-1.0, 1.0))
        }
        for way, found in ways.items():
            expected = {(0, 0, -1): [False, True, True, True], (0, 0, 1): [True, True, True, False]}
            assert found.tolist() == [*expected.get(way, [False] * 4), False, False]


def test_cells_in_a_row_with_a_voxel_are_those_of_its_part_along_its_facing():
    plate = np.argwhere(np.ones((4, 6, 2), dtype=bool)) + 3
    cells = np.concatenate([plate, [[3, 3, 5], [3, 3, 9]]])
    part_ids = np.concatenate([np.zeros(len(plate), dtype=int), [1, 0]])
    for facing, length in enumerate((4, 4, 6, 6, 2, 2)):
        behind = count_behind(cells, part_ids, np.full(len(cells), facing), EDGE)
        assert (behind[:-2] == length).all()
        assert behind[-2:].tolist() == [1, 1]


@pytest.mark.parametrize(("span", "back"), [(4, 0), (5, 1)])
def test_the_back_of_a_leaf_of_six_cells_faces_the_object(span: int, back: int):
    """Both boards of a thinner one face away from the object."""
    board = np.argwhere(np.ones((1, 12, 12), dtype=bool))
    leaf = np.concatenate([board, board + np.array([span, 0, 0])])
    cells = np.concatenate([leaf, board + np.array([18, 0, 0])]) + np.array([1, 4, 4])
    facings = find_facings(cells, np.repeat([0, 1], [len(leaf), len(board)]), EDGE)
    alone = (np.abs(cells[:, 1:] - 9.5) < 4).all(axis=1)
    assert (facings[alone & (cells[:, 0] == 1)] == 0).all()
    assert (facings[alone & (cells[:, 0] == 1 + span)] == back).all()


@pytest.mark.parametrize(("before", "covered"), [(2, False), (3, True)])
def test_a_voxel_covers_a_side_from_three_cells_on(before: int, covered: object):
    cells = np.array([[5, 5, 5], [5, 5, 5 + before]])
    assert find_covered(cells, np.array([5, 5]), EDGE)[0].tolist() == [covered, False]


def test_as_many_sides_and_neighbours_are_told_apart_as_networks_are_made_for():
    cells, one = np.array([[5, 5, 5]]), np.zeros(1, dtype=int)
    assert find_covered(cells, one, EDGE).size == SIDES
    assert find_joined(cells, one, one, EDGE).size == AROUND
