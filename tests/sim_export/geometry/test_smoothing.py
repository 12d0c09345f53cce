"""Smoothing keeps long waves and flattens short ones, within limits; what is locked or far stays in place."""

from itertools import product

import numpy as np
import pytest

from sim_export.geometry.smoothing import BlockySurface, smooth_surface, stretch_to_box

CORNERS = np.array(list(product((0, 1), repeat=3)))
SIDES = np.array(
    [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
)  # fmt: skip
ACROSS = np.array(
    [(low, low | bit, axis) for axis, bit in enumerate((4, 2, 1)) for low in range(8) if not low & bit]
)

FREE = np.ones(3, dtype=bool)


def surface_of(
    vertices: np.ndarray, quads: np.ndarray, free: np.ndarray, **given: np.ndarray
) -> BlockySurface:
    """Curved quads whose vertices may move along some axes."""
    return BlockySurface(
        vertices=vertices,
        quads=quads,
        flat=given.get("flat", np.zeros(len(quads), dtype=bool)),
        locked=~np.broadcast_to(free, vertices.shape),
        walls=given.get("walls", np.zeros((0, 3), dtype=int)),
        slant=np.full(vertices.shape, -1),
        slants=np.zeros((0, 3)),
    )


def wave_left(length: int) -> float:
    """Share of a wave's height that is left on a field of cells without an end."""
    ring, width = np.arange(length), 3
    height = 0.3 * np.cos(2 * np.pi * ring / length)
    vertices = np.array([(x, y, height[x]) for x in ring for y in range(width)], dtype=float)
    place = np.arange(length * width).reshape(length, width)
    ahead, aside = np.roll(place, -1, axis=0), np.roll(place, -1, axis=1)
    quads = np.stack([place, ahead, np.roll(ahead, -1, axis=1), aside], axis=-1).reshape(-1, 4)
    smooth = smooth_surface(surface_of(vertices, quads, np.array([False, False, True])))
    return float(smooth[0, 2] / 0.3)


def test_waves_of_thirty_cells_keep_their_height_and_those_of_eight_lose_nearly_half():
    assert 1.0 <= wave_left(30) < 1.01
    assert 0.5 < wave_left(8) < 0.6
    assert wave_left(4) < 0.1


@pytest.mark.parametrize("length", [6, 8, 12])
def test_eighty_pairs_of_steps_damp_a_wave(length: int):
    """Each shrinks it by 0.6 of its height above its neighbours' mean and grows it by 0.605 of that."""
    above_mean = 0.5 - 0.5 * np.cos(2 * np.pi / length)
    assert wave_left(length) == pytest.approx(
        ((1.0 - 0.6 * above_mean) * (1.0 + 0.605 * above_mean)) ** 80, rel=1e-6
    )


@pytest.mark.parametrize("edge", [2.0, 3.0])
def test_the_shrinking_step_stops_at_seven_tenths_of_a_cell(edge: float):
    """The growing one takes a cube's corners back by 0.605 of the way to their neighbours' mean."""
    smooth = smooth_surface(surface_of(edge * CORNERS, SIDES, FREE))
    np.testing.assert_allclose(np.ptp(smooth, axis=0), (edge - 1.4) * (1.0 + 0.605 * 2 / 3), rtol=1e-9)


def test_walls_of_one_cell_keep_three_tenths_of_it():
    cube = surface_of(CORNERS.astype(float), SIDES, FREE, walls=ACROSS)
    np.testing.assert_allclose(np.ptp(smooth_surface(cube), axis=0), 0.3)


def test_flat_quads_follow_a_curved_rim_over_four_cells():
    count, rim = 12, 4
    column = np.repeat(np.arange(count), 2)
    height = np.where((column < rim) & (column % 2 == 1), 0.6, 0.0)
    vertices = np.stack([column, np.tile([0, 1], count), height], axis=1).astype(float)
    first = 2 * np.arange(count - 1)
    quads = np.stack([first, first + 2, first + 3, first + 1], axis=1)
    flat = np.arange(count - 1) >= rim - 1
    smooth = smooth_surface(surface_of(vertices, quads, np.array([False, False, True]), flat=flat))
    moved = np.abs(smooth - vertices)[::2, 2] > 1e-9
    assert moved.tolist() == [True] * (rim + 4) + [False] * (count - rim - 4)


@pytest.mark.parametrize(("missing", "reach"), [(0.8, 0.81), (-0.8, 0.81), (0.8, 0.79)])
def test_a_side_stretches_to_its_box_over_four_cells_if_the_box_is_within_reach(missing, reach):
    along = np.linspace(0.0, 10.0, 21)
    vertices = np.stack([along, 0 * along, 0 * along], axis=1)
    free = np.ones(vertices.shape, dtype=bool)
    free[19] = False
    box = np.array([[0.0, 0.0, 0.0], [10.0 + missing, 0.0, 0.0]])
    shift = missing * np.clip((along - 6.0) / 4.0, 0.0, 1.0) * free[:, 0] * (reach > abs(missing))
    np.testing.assert_allclose(stretch_to_box(vertices, free, box, reach)[:, 0], along + shift)
