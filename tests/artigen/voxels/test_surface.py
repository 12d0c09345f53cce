"""Surface within voxels: boards and bars of known sizes, anywhere in the grid, facing any way."""

import numpy as np
import pytest
from box_surface import EDGE, MISSED, sample_box

from artigen.types import SurfaceSamples, VoxelGrid
from artigen.voxels.frames import FACINGS, facing_frames
from artigen.voxels.surface import (
    HEIGHT_REACH,
    MIDDLE_SPREAD,
    PLACES,
    VoxelPlaces,
    describe_places,
    measure_places,
)
from artigen.voxels.voxelize import voxelize

"""Voxels within which an end is known."""


def place_box(facing: int) -> tuple[VoxelGrid, VoxelPlaces]:
    """A board of half a voxel, whose frame's +x is the side that faces that way: 6 by 3.1 voxels."""
    frame = facing_frames()[facing]
    corners = np.array([[-0.2, -3.0, -1.3], [0.3, 3.0, 1.8]]) @ frame.T + (EDGE / 2 + 0.5)
    surface = sample_box(corners.min(axis=0), corners.max(axis=0))
    voxels = voxelize(surface, EDGE)
    return voxels, measure_places(surface, voxels, np.full(len(voxels.coords), facing))


@pytest.mark.parametrize("facing", range(FACINGS))
def test_a_board_that_ends_within_a_voxel_is_told_so_whichever_way_it_faces(facing: int):
    voxels, places = place_box(facing)
    local = (voxels.coords - EDGE / 2) @ facing_frames()[facing]
    assert len(local) == 7 * 4
    np.testing.assert_allclose(places.heights, np.tile([0.3, -0.2], (len(local), 1)), atol=1e-5)
    starts, ends = local[:, 1:].min(axis=0), local[:, 1:].max(axis=0)
    for axis, (low, high) in enumerate(((0.0, 0.0), (-0.3, -0.2))):
        first, last = local[:, 1 + axis] == starts[axis], local[:, 1 + axis] == ends[axis]
        np.testing.assert_allclose(places.lowest[first, axis], low, atol=MISSED)
        np.testing.assert_allclose(places.highest[last, axis], high, atol=MISSED)
        assert (places.lowest[~first, axis] < MISSED / 2 - 0.5 + 1e-6).all()
        assert (places.highest[~last, axis] > 0.5 - MISSED / 2 - 1e-6).all()


def test_only_surface_of_the_voxels_part_counts():
    board = sample_box(np.array([2.0, 2.0, 4.4]), np.array([8.0, 8.0, 4.6]))
    bar = sample_box(np.array([4.0, 4.0, 4.7]), np.array([5.0, 5.0, 4.9]), part=1)
    voxels = voxelize(board, EDGE)
    facings = np.full(len(voxels.coords), 5)
    both = SurfaceSamples(
        **{name: np.concatenate([value, getattr(bar, name)]) for name, value in vars(board).items()}
    )
    alone, beside = measure_places(board, voxels, facings), measure_places(both, voxels, facings)
    for name, value in vars(alone).items():
        np.testing.assert_array_equal(value, getattr(beside, name))


def fill(low: tuple[int, int, int], high: tuple[int, int, int]) -> VoxelGrid:
    """All cells of a box."""
    axes = [np.arange(first, last) for first, last in zip(low, high, strict=True)]
    coords = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return VoxelGrid(resolution=EDGE, coords=coords, part_ids=np.zeros(len(coords), dtype=np.int64))


def test_surface_over_a_voxel_is_that_voxels():
    for top, height in ((5.1, 0.6), (5.4, 0.675)):  # higher surface cannot be encoded
        surface = sample_box(np.array([2.0, 2.0, 4.3]), np.array([6.0, 6.0, top]))
        places = measure_places(surface, fill((2, 2, 4), (6, 6, 5)), np.full(16, 5))
        np.testing.assert_allclose(places.heights, np.tile([height, -0.2], (16, 1)), atol=1e-6)


def test_what_no_surface_says_is_taken_to_be_filled():
    surface = sample_box(np.array([2.0, 2.0, 4.4]), np.array([4.0, 4.0, 4.6]))
    voxels = VoxelGrid(resolution=EDGE, coords=np.array([[9, 9, 9], [2, 2, 4]]), part_ids=np.zeros(2, int))
    places = measure_places(surface, voxels, np.array([3, 0]))
    assert places.heights.tolist()[0] == [0.3, -0.3]
    assert places.lowest.tolist()[0] == [-0.5, -0.5]
    assert places.highest.tolist()[0] == [0.5, 0.5]
    assert places.heights[1, 1] == -0.3  # the board goes on inwards


def test_what_networks_are_told_is_where_the_surface_lies():
    _, places = place_box(3)
    told = describe_places(places)
    np.testing.assert_allclose(HEIGHT_REACH * np.tanh(told[:, :2]), places.heights, atol=1e-6)
    middles, widths = MIDDLE_SPREAD * told[:, 2:4], np.exp(told[:, 4:])
    np.testing.assert_allclose(middles - widths / 2, places.lowest, atol=1e-6)
    np.testing.assert_allclose(middles + widths / 2, places.highest, atol=1e-6)


def place_one(heights: tuple[float, float], low: float, high: float) -> VoxelPlaces:
    """One voxel with a surface from ``low`` to ``high`` along both axes."""
    ends = np.array([[low, low]]), np.array([[high, high]])
    return VoxelPlaces(heights=np.array([heights]), lowest=ends[0], highest=ends[1])


def test_places_are_encoded_as_the_shipped_weights_read_them():
    code = describe_places(place_one((0.375, -0.3), -0.25, 0.5))[0]
    np.testing.assert_allclose(code, [*np.arctanh([0.5, -0.4]), 0.5, 0.5, *np.log([0.75, 0.75])])
    narrow = describe_places(place_one((0.75, -0.75), 0.0, 0.05))[0]
    np.testing.assert_allclose(narrow, [*np.arctanh([0.9, -0.9]), 0.1, 0.1, *np.log([0.1, 0.1])])


@pytest.mark.parametrize(("degrees", "sides"), [(59.0, 1), (61.0, 0)])
def test_surface_faces_a_side_up_to_sixty_degrees_from_it(degrees: float, sides: int):
    turn = np.radians(degrees)
    surface = SurfaceSamples(
        points=np.array([[0.5, 0.5, 0.5]]) / EDGE - 0.5,
        normals=np.array([[np.sin(turn), 0.0, np.cos(turn)]]),
        colors=np.zeros((1, 3), dtype=np.uint8),
        part_ids=np.zeros(1, dtype=np.int64),
    )
    places = measure_places(surface, fill((0, 0, 0), (1, 1, 1)), np.full(1, 5))
    np.testing.assert_allclose(places.heights, [[0.0 if sides else 0.3, -0.3]], atol=1e-9)


@pytest.mark.parametrize(("top", "thickness", "kept"), [(5.25, 0.26, 0.26), (5.4, 0.45, 0.3)])
def test_sides_keep_a_distance_of_up_to_three_tenths_where_heights_end(
    top: float, thickness: float, kept: float
):
    surface = sample_box(np.array([2.0, 2.0, top - thickness]), np.array([6.0, 6.0, top]))
    places = measure_places(surface, fill((2, 2, 4), (6, 6, 5)), np.full(16, 5))
    np.testing.assert_allclose(places.heights, np.tile([0.675, 0.675 - kept], (16, 1)), atol=1e-6)


def test_surface_reaches_a_sixth_of_a_voxel_beyond_its_last_sample():
    surface = SurfaceSamples(
        points=np.array([[0.5, 0.4, 0.5], [0.5, 0.7, 0.5]]) / EDGE - 0.5,
        normals=np.tile([1.0, 0.0, 0.0], (2, 1)),
        colors=np.zeros((2, 3), dtype=np.uint8),
        part_ids=np.zeros(2, dtype=np.int64),
    )
    places = measure_places(surface, fill((0, 0, 0), (1, 1, 1)), np.full(1, 1))
    np.testing.assert_allclose(places.lowest[0], [-0.1 - 1 / 6, -1 / 6], atol=1e-6)
    np.testing.assert_allclose(places.highest[0], [0.2 + 1 / 6, 1 / 6], atol=1e-6)


def test_networks_are_made_for_as_many_numbers_as_describe_a_place():
    assert describe_places(place_one((0.3, -0.3), -0.5, 0.5)).shape == (1, PLACES)
