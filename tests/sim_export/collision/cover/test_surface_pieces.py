"""Boundaries of pieces of a surface: which are sheets, and where and how they are cut."""

import numpy as np
import pytest

from sim_export.collision.cover.free_space import FreeSpace, find_free_space
from sim_export.collision.cover.surface_pieces import cut_planes, make_piece, split_piece, wrap
from sim_export.geometry.grid import Grid


def rectangle(*corners) -> np.ndarray:
    """Two triangles between four corners (m) in a ring."""
    return np.array(corners, dtype=float)[np.array([[0, 1, 2], [0, 2, 3]])]


@pytest.mark.parametrize(("thickness", "sheet"), [(0.0019, True), (0.0021, False)])
def test_what_is_thinner_than_two_millimetres_is_a_sheet_without_volume(thickness, sheet):
    corners = np.array([[x, y, z] for x in (0.0, 0.3) for y in (0.0, 0.2) for z in (0.0, thickness)])
    around = wrap(corners @ np.array([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]]))
    assert (len(around.planes) == 0) == sheet
    assert (around.volume == 0.0) == sheet
    assert around.area == pytest.approx(2.0 * 0.3 * 0.2, rel=0.05)


@pytest.mark.parametrize(("share", "taken"), [(0.025, False), (0.035, True)])
def test_three_hundredths_of_a_sheet_may_lie_in_free_space(share, taken):
    """A sheet that is two metres long, of which one end is free."""
    sheet = rectangle([0, 0, 0], [2, 0, 0], [2, 0.5, 0], [0, 0.5, 0])
    grid = Grid(low=np.array([0.0, 0.0, -0.05]), cell=0.01, shape=(200, 50, 10))
    depth = np.zeros(grid.shape, dtype=np.float32)
    depth[: round(share * 200)] = 0.5
    piece = make_piece(sheet, FreeSpace(grid=grid, away=depth, depth=depth), 0.005)
    assert (piece.intrusion.volume > 0.0) == taken


def test_cuts_are_tried_beside_the_six_largest_levels_of_a_surface():
    """Eight shelves, the higher the smaller, with half a millimetre between a cut and its shelf."""
    heights = 0.1 * np.arange(8)
    edges = 0.5 - 0.02 * np.arange(8)
    shelves = [
        rectangle([0, 0, z], [edge, 0, z], [edge, edge, z], [0, edge, z])
        for z, edge in zip(heights, edges, strict=True)
    ]
    planes = cut_planes(np.concatenate(shelves))
    level = planes[planes[:, 2] > 0.99, 3]
    expected = np.concatenate([heights[:6] - 5e-4, heights[:6] + 5e-4, [0.35]])
    np.testing.assert_allclose(np.sort(level), np.sort(expected), atol=1e-12)


def test_a_wall_comes_off_its_floor_half_a_millimetre_beside_its_plane():
    floor = rectangle([0, 0, 0], [0.5, 0, 0], [0.5, 0.6, 0], [0, 0.6, 0])
    wall = rectangle([0, 0, 0], [0, 0.6, 0], [0, 0.6, 0.4], [0, 0, 0.4])
    corner = np.concatenate([floor, wall])
    space = find_free_space(corner, 0.9)
    halves = split_piece(make_piece(corner, space, 0.004), space, 0.004)
    assert halves is not None
    assert all(half.intrusion.volume == 0.0 for half in halves)
    thinnest = sorted(float(np.ptp(half.bounds, axis=0).min()) for half in halves)
    np.testing.assert_allclose(thinnest, [0.0, 5e-4], atol=1e-9)


@pytest.mark.parametrize(("end", "whole"), [(0.038, False), (0.049, True)])
def test_an_end_that_takes_no_free_space_comes_off_whole_if_it_holds_a_twentieth_of_the_surface(end, whole):
    """Of a square tube a metre long, all of it in free space but for one end, which a small square across
    the tube divides from the rest; else a cut through the middle of the tube is better."""
    side, square = 0.15, 0.025
    ring = side * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    walls = [rectangle([0, *ring[k - 1]], [0, *ring[k]], [1, *ring[k]], [1, *ring[k - 1]]) for k in range(4)]
    across = rectangle(*([end, *corner] for corner in ring * square / side))
    tube = np.concatenate([*walls, across])
    grid = Grid(low=np.array([-0.06, -0.21, -0.21]), cell=0.03, shape=(38, 14, 14))
    depth = np.zeros(grid.shape, dtype=np.float32)
    depth[4:] = 0.5  # from x = 0.06 on
    space = FreeSpace(grid=grid, away=depth, depth=depth)
    halves = split_piece(make_piece(tube, space, 0.01), space, 0.01)
    assert halves is not None
    lengths = sorted(float(np.ptp(half.bounds[:, 0])) for half in halves)
    assert (lengths[0] == pytest.approx(end + 5e-4)) == whole
