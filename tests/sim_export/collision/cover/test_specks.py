"""Tiny hulls go where a hull that stays is as good as there, and nowhere else."""

import numpy as np
import pytest

from sim_export.collision.cover.specks import drop_specks
from sim_export.geometry.hulls import box_hull


def box_at(low, sides):
    return box_hull(np.array(low, dtype=float), np.array(low, dtype=float) + sides)


def stud(length, height):
    """A stud of a length and height on the top of a large block."""
    return box_at((0.1, 0.1, 0.0), (length, 0.5 * length, height))


@pytest.mark.parametrize(("diagonal", "reach"), [(1.0, 0.004), (0.5, 0.0025), (0.8, 0.004), (3.0, 0.004)])
@pytest.mark.parametrize(("longer", "higher", "stays"), [(0.99, 0.99, 0), (1.01, 0.99, 1), (0.99, 1.01, 1)])
def test_only_short_and_low_hulls_go(diagonal, reach, longer, higher, stays):
    """Up to 1.5 % of the diagonal long, and up to 4 mm or half a per cent of the diagonal high."""
    block = box_at((0, 0, -0.2), (0.2, 0.2, 0.2))
    speck = stud(longer * 0.015 * diagonal, higher * reach)
    kept = drop_specks((speck, block), diagonal)
    assert kept == ((speck, block) if stays else (block,))


@pytest.mark.parametrize(("apart", "stays"), [(0.99, False), (1.01, True)])
def test_distance_is_measured_to_the_edge_where_a_hull_lies_beside_it(apart, stays):
    block = box_at((-0.2, -0.2, -0.2), (0.2, 0.2, 0.2))
    sides = np.full(3, 0.001)
    speck = box_at(apart * 0.004 / np.sqrt(3.0) - sides, sides)  # its farthest corner is off a corner
    assert (len(drop_specks((block, speck), 1.0)) == 2) == stays


def test_tiny_hulls_inside_of_others_go():
    block = box_at((0, 0, 0), (0.2, 0.2, 0.2))
    assert drop_specks((box_at((0.1, 0.1, 0.1), np.full(3, 0.01)), block), 1.0) == (block,)


@pytest.mark.parametrize(("apart", "stays"), [(0.99, False), (1.01, True)])
def test_a_speck_stays_if_nothing_else_holds_a_hull(apart, stays):
    """Hulls within 5 mm hold together."""
    block = box_at((-0.2, -0.1, -0.1), (0.2, 0.2, 0.2))
    speck = box_at((0.0, 0.0, 0.0), (0.0036, 0.01, 0.01))
    post = box_at((apart * 0.005, -0.1, 0.0), (0.02, 0.2, 0.01))
    assert drop_specks((block, speck, post), 1.0) == ((block, speck, post) if stays else (block, post))


def test_hulls_in_a_row_do_not_vanish_one_after_the_other():
    """Each of them lies near the next, and none near a hull that would stay."""
    row = tuple(box_at((0.002 * n, 0, 0), (0.003, 0.003, 0.003)) for n in range(20))
    kept = drop_specks(row, 1.0)
    middles = np.array([hull.vertices.mean(axis=0) for hull in kept])
    for hull in row:
        assert np.linalg.norm(middles - hull.vertices.mean(axis=0), axis=1).min() <= 0.004
    assert 1 < len(kept) < len(row)


def test_large_hulls_stay_wherever_they_are():
    block = box_at((0, 0, 0), (0.2, 0.2, 0.2))
    inside = box_at((0.05, 0.05, 0.05), (0.1, 0.1, 0.1))
    assert drop_specks((block, inside), 1.0) == (block, inside)
