"""Shortcuts never change an answer: what is rejected by boxes, kept, or counted anew only in part."""

import numpy as np
import pytest

from artigen.transforms import matrix_from_quat
from sim_export.appearance.blending import find_near
from sim_export.collision.cover.cuboids import count_filled, empty_box, grow_boxes
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import box_hull, convex_hull, hull_planes
from sim_export.package import Hull


def random_hulls(rng: np.random.Generator, count: int) -> tuple[Hull, ...]:
    return tuple(
        convex_hull(rng.normal(size=3) + 0.3 * rng.normal(size=(12, 3)) * rng.uniform(0.1, 1.0, 3))
        for _ in range(count)
    )


def random_poses(rng: np.random.Generator, count: int, spread: float) -> np.ndarray:
    quats = rng.normal(size=(count, 4))
    T = np.tile(np.eye(4), (count, 1, 1))
    T[:, :3, :3] = matrix_from_quat(quats / np.linalg.norm(quats, axis=1, keepdims=True))
    T[:, :3, 3] = spread * rng.normal(size=(count, 3))
    return T


@pytest.mark.parametrize("spread", [0.5, 4.0])
@pytest.mark.parametrize("margin", [0.0, 0.05])
def test_no_pair_of_hulls_is_lost_by_boxes_around_all_of_them(spread: float, margin: float):
    rng = np.random.default_rng(0)
    for _ in range(5):
        first, second = (HullSet(hulls=random_hulls(rng, count)) for count in (4, 3))
        T, U = (random_poses(rng, 12, spread) for _ in range(2))
        found = signed_distances(first, second, T, U, margin)
        expected = {}
        for pose in range(len(T)):
            for i, one in enumerate(first.hulls):
                for j, other in enumerate(second.hulls):
                    # 10 m reach: the boxes of single hulls reject nothing.
                    alone = (HullSet(hulls=(one,)), HullSet(hulls=(other,)))
                    distance = signed_distances(*alone, T[pose], U[pose], 10.0).distance
                    if len(distance) and distance[0] <= margin:
                        expected[pose, i, j] = float(distance[0])
        keys = list(zip(found.pose.tolist(), found.first.tolist(), found.second.tolist(), strict=True))
        assert keys == sorted(expected)
        np.testing.assert_allclose(found.distance, [expected[key] for key in keys], atol=1e-7)


def test_sets_that_only_touch_are_near():
    one, other = (HullSet(hulls=(box_hull(np.full(3, low), np.full(3, low + 1.0)),)) for low in (0.0, 1.0))
    assert len(signed_distances(one, other, np.eye(4), np.eye(4)).distance) == 1


def test_points_within_reach_of_a_place_are_never_left_out():
    rng = np.random.default_rng(1)
    kept = []
    for count in (1, 3, 200):
        for reach in (1e-3, 0.05, 2.0):
            places = rng.uniform(-1.0, 1.0, size=(count, 3)) * [1.0, 0.3, 0.0]
            points = rng.uniform(-1.5, 1.5, size=(4000, 3))
            on_reach = places[rng.integers(0, count, 500)] + reach * np.eye(3)[rng.integers(0, 3, 500)]
            points = np.concatenate([points, on_reach, places])
            distance = np.linalg.norm(points[:, None] - places, axis=2).min(axis=1)
            found = find_near(points, places, reach)
            assert found[distance <= reach].all()
            kept.append(found.mean())
    assert min(kept) < 0.3


def test_no_place_has_nothing_near_it():
    assert not find_near(np.zeros((5, 3)), np.zeros((0, 3)), 1.0).any()


def grow_slowly(grid: np.ndarray, cell: np.ndarray, order: tuple[int, ...]) -> np.ndarray:
    """One slice of cells after the other, looked at cell by cell."""
    low, high = cell.copy(), cell + 1
    for axis in order:
        for end, step in ((low, -1), (high, 1)):
            while True:
                end[axis] += step
                inside = end.min() >= 0 and (end <= grid.shape).all()
                if not inside or not grid[tuple(map(slice, low, high))].all():
                    end[axis] -= step
                    break
    return np.stack([low, high])


def test_boxes_grow_until_the_next_slice_is_not_filled():
    from itertools import permutations

    rng = np.random.default_rng(4)
    for shape in ((9, 7, 5), (1, 6, 8)):
        grid = rng.random(shape) < 0.85
        cells = np.argwhere(grid)[::9]
        boxes = grow_boxes(count_filled(grid), cells)
        slow = [grow_slowly(grid, cell, order) for order in permutations(range(3)) for cell in cells]
        np.testing.assert_array_equal(boxes, slow)


def test_sums_without_a_box_are_those_of_what_is_left():
    rng = np.random.default_rng(5)
    values = rng.integers(0, 9, (9, 7, 5)).astype(np.int32)
    sums = count_filled(values)
    for box in ([[2, 0, 1], [5, 3, 5]], [[0, 0, 0], [9, 7, 2]], [[8, 6, 4], [9, 7, 5]]):
        empty_box(values, sums, np.array(box))
        np.testing.assert_array_equal(sums, count_filled(values))
    assert not values[2:5, :3, 1:5].any()
    assert values.any()


def test_planes_that_are_kept_cannot_be_written():
    planes = hull_planes(box_hull(np.zeros(3), np.ones(3)))
    with pytest.raises(ValueError, match="read-only"):
        planes[0, 0] = 2.0
