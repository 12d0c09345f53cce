"""Sides without surface take a colour that is seen beside them, and no other side changes."""

import numpy as np
import pytest

from artigen.bare_sides import cover_bare_sides

COUNT = 6
COORDS = np.stack([np.arange(COUNT), np.zeros(COUNT), np.zeros(COUNT)], axis=1).astype(int)


@pytest.fixture
def paint() -> np.ndarray:
    return np.random.default_rng(0).random((COUNT, 7))


def test_sides_that_show_keep_their_colour_and_so_does_clearness(paint: np.ndarray):
    faced = np.random.default_rng(1).random((COUNT, 2)) < 0.5
    covered = cover_bare_sides(paint, faced, COORDS, np.zeros(COUNT, int))
    shown = np.repeat(faced, 3, axis=1)
    np.testing.assert_array_equal(covered[:, :6][shown], paint[:, :6][shown])
    np.testing.assert_array_equal(covered[:, 6], paint[:, 6])


@pytest.mark.parametrize("side", [0, 1])
def test_a_bare_side_looks_as_the_other_one(paint: np.ndarray, side: int):
    faced = np.ones((COUNT, 2), bool)
    faced[2, side] = False
    covered = cover_bare_sides(paint, faced, COORDS, np.zeros(COUNT, int))
    np.testing.assert_array_equal(covered[2, :3], covered[2, 3:6])
    np.testing.assert_array_equal(np.delete(covered, 2, axis=0), np.delete(paint, 2, axis=0))


def test_a_voxel_without_sides_looks_as_the_nearest_of_its_part(paint: np.ndarray):
    faced = np.ones((COUNT, 2), bool)
    faced[[0, 1]] = False
    part_ids = np.array([0, 0, 1, 1, 0, 0])
    covered = cover_bare_sides(paint, faced, COORDS, part_ids)
    for row in (0, 1):
        np.testing.assert_array_equal(covered[row, :6], np.tile(paint[4, :3], 2))
    np.testing.assert_array_equal(covered[2:], paint[2:])


def test_a_part_that_shows_nothing_keeps_what_it_was_painted(paint: np.ndarray):
    faced = np.zeros((COUNT, 2), bool)
    np.testing.assert_array_equal(cover_bare_sides(paint, faced, COORDS, np.zeros(COUNT, int)), paint)
