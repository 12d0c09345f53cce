"""Distances between hulls agree with the Minkowski difference, and with closed forms on boxes."""

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial import ConvexHull

from artigen.transforms import matrix_from_quat, screw_motion, transform_points
from sim_export.geometry.contacts import FEW_POSES, HullSet, penetration_depths, signed_distances
from sim_export.geometry.hulls import box_hull, clip_hull, convex_hull, hull_planes, hull_volume
from sim_export.package import Hull

IDENTITY = np.eye(4)


def box_set(*boxes) -> HullSet:
    return HullSet(hulls=tuple(box_hull(np.array(low, float), np.array(high, float)) for low, high in boxes))


def ball(radius: float, center=(0.0, 0.0, 0.0), count: int = 400) -> Hull:
    turn = np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    ring = np.sqrt(1.0 - z * z)
    return convex_hull(radius * np.stack([ring * np.cos(turn), ring * np.sin(turn), z], 1) + np.array(center))


def random_pose(rng: np.random.Generator, spread: float) -> np.ndarray:
    quat = rng.normal(size=4)
    T = np.eye(4)
    T[:3, :3] = matrix_from_quat(quat / np.linalg.norm(quat))
    T[:3, 3] = spread * rng.normal(size=3)
    return T


def random_hull(rng: np.random.Generator) -> Hull:
    kind = rng.integers(3)
    if kind == 0:
        size = rng.uniform(0.1, 0.8, size=3)
        size[rng.integers(3)] = 0.001  # a plate as thin as hulls may be
        return box_hull(-size / 2, size / 2)
    if kind == 1:
        return convex_hull(10.0 ** rng.uniform(-3.0, -0.5) * rng.uniform(-1, 1, size=(12, 3)))
    return ball(10.0 ** rng.uniform(-3.0, -0.5), count=40)


def reference_distance(a: np.ndarray, b: np.ndarray) -> float:
    """Distance of the origin to the surface of the Minkowski difference, negative inside."""
    difference = ConvexHull((b[None] - a[:, None]).reshape(-1, 3))
    inside = difference.equations[:, 3].max()
    if inside < 0:
        return float(inside)
    corners = difference.points[difference.vertices]
    weights, _ = nnls(
        np.vstack([corners.T, np.full(len(corners), 1e3)]), np.array([0, 0, 0, 1e3]), maxiter=10000
    )
    return float(np.linalg.norm(corners.T @ (weights / weights.sum())))


def test_random_hulls_match_the_minkowski_difference():
    rng = np.random.default_rng(0)
    overlaps = 0
    for _ in range(200):
        a, b = random_hull(rng), random_hull(rng)
        T_a, T_b = random_pose(rng, 0.0), random_pose(rng, rng.choice([0.0, 0.01, 0.1, 0.3]))
        found = signed_distances(HullSet(hulls=(a,)), HullSet(hulls=(b,)), T_a, T_b, 10.0)
        expected = reference_distance(transform_points(T_a, a.vertices), transform_points(T_b, b.vertices))
        assert abs(found.distance[0] - expected) < 1e-5
        overlaps += expected < 0
    assert 20 < overlaps < 180


@pytest.mark.parametrize("depth", [0.3, 0.01, 1e-4])
def test_boxes_overlap_by_their_known_depth(depth):
    a = box_set(((0, 0, 0), (1, 1, 1)))
    b = box_set(((1 - depth, 0.2, 0.3), (2, 0.7, 0.8)))
    found = signed_distances(a, b, IDENTITY, IDENTITY)
    assert -found.distance.min() == pytest.approx(depth, abs=1e-9)
    normal = found.normal[found.distance.argmin()]
    np.testing.assert_allclose(normal, [1, 0, 0], atol=1e-9)
    # The promise of the normal: this translation makes the two just touch.
    apart = np.eye(4)
    apart[:3, 3] = depth * normal
    assert penetration_depths(a, b, IDENTITY, apart)[0] < 1e-9


def test_a_box_corner_in_a_plate_penetrates_by_its_height():
    plate = box_set(((-1, -1, -0.05), (1, 1, 0)))
    cube = box_set(((-0.1, -0.1, -0.1), (0.1, 0.1, 0.1)))
    T = screw_motion(np.array([0.0, 1.0, 0.0]), np.zeros(3), np.array(np.pi / 4), np.array(0.0))
    T[2, 3] = 0.1 * np.sqrt(2.0) - 0.02
    assert penetration_depths(plate, cube, IDENTITY, T) == pytest.approx(0.02, abs=1e-6)


def test_balls_are_apart_by_center_distance_less_radii():
    found = signed_distances(
        HullSet(hulls=(ball(0.2),)), HullSet(hulls=(ball(0.3, (0.0, 0.6, 0.0)),)), IDENTITY, IDENTITY, 1.0
    )
    assert found.distance[0] == pytest.approx(0.1, abs=0.003)
    np.testing.assert_allclose(found.normal[0], [0, 1, 0], atol=0.05)
    assert signed_distances(
        HullSet(hulls=(ball(0.2),)), HullSet(hulls=(ball(0.3, (0, 0.6, 0)),)), IDENTITY, IDENTITY, 0.05
    ).distance.size == 0  # fmt: skip


def test_touching_boxes_do_not_penetrate():
    a = box_set(((0, 0, 0), (1, 1, 1)))
    for low in ([1, 0, 0], [1, 1, 0], [1, 1, 1], [0, 0, 1]):
        b = box_set((low, np.add(low, 1)))
        found = signed_distances(a, b, IDENTITY, IDENTITY)
        assert found.distance[0] == pytest.approx(0.0, abs=1e-12)
        assert np.linalg.norm(found.normal[0]) == pytest.approx(1.0)


def test_distances_are_symmetric_and_do_not_see_a_common_motion():
    rng = np.random.default_rng(1)
    a = HullSet(hulls=tuple(random_hull(rng) for _ in range(5)))
    b = HullSet(hulls=tuple(random_hull(rng) for _ in range(4)))
    T_a = np.stack([random_pose(rng, 0.1) for _ in range(20)])
    T_b = np.stack([random_pose(rng, 0.1) for _ in range(20)])
    forth, back = signed_distances(a, b, T_a, T_b, 0.1), signed_distances(b, a, T_b, T_a, 0.1)
    assert len(forth.distance) > 10
    depth = dict(zip(zip(forth.pose, forth.first, forth.second, strict=True), forth.distance, strict=True))
    turned = dict(zip(zip(back.pose, back.second, back.first, strict=True), back.distance, strict=True))
    assert depth.keys() == turned.keys()
    for key, value in depth.items():
        assert value == pytest.approx(turned[key], abs=2e-6)
    common = random_pose(rng, 1.0)
    moved = signed_distances(a, b, common @ T_a, common @ T_b, 0.1)
    np.testing.assert_allclose(moved.distance, forth.distance, atol=2e-6)
    np.testing.assert_array_equal(moved.first, forth.first)
    np.testing.assert_allclose(
        moved.distance[:, None] * moved.normal, moved.points[:, 1] - moved.points[:, 0], atol=1e-5
    )


def test_a_sweep_is_the_sum_of_its_poses():
    a = box_set(((0, 0, 0), (1, 1, 0.02)), ((0, 0, 0), (0.02, 1, 1)))
    b = box_set(((0.2, 0.2, 0.05), (0.8, 0.8, 0.3)), ((0.2, 0.2, 0.3), (0.8, 0.8, 0.32)))
    T = np.tile(np.eye(4), (21, 1, 1))
    T[:, 2, 3] = -np.linspace(0, 0.1, 21)
    depths = penetration_depths(a, b, IDENTITY, T)
    np.testing.assert_allclose(depths, np.clip(-T[:, 2, 3] - 0.03, 0, None), atol=1e-9)
    assert [float(penetration_depths(a, b, IDENTITY, pose)[0]) for pose in T] == pytest.approx(depths)


def test_empty_sets_and_no_overlap_give_nothing():
    a, none = box_set(((0, 0, 0), (1, 1, 1))), HullSet(hulls=())
    for first, second in ((a, none), (none, a), (a, box_set(((2, 2, 2), (3, 3, 3))))):
        assert penetration_depths(first, second, IDENTITY, IDENTITY).tolist() == [0.0]
        assert not len(signed_distances(first, second, IDENTITY, IDENTITY).distance)


def test_cutting_a_hull_splits_its_volume():
    rng = np.random.default_rng(2)
    for _ in range(50):
        hull = random_hull(rng)
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        offset = float(normal @ hull.vertices.mean(axis=0))
        below, above = clip_hull(hull, normal, offset), clip_hull(hull, -normal, -offset)
        assert below is not None
        assert above is not None
        assert hull_volume(below) + hull_volume(above) == pytest.approx(hull_volume(hull), rel=1e-6)
        assert (below.vertices @ normal).max() <= offset + 1e-9
        planes = hull_planes(below)
        assert (below.vertices @ planes[:, :3].T <= planes[:, 3] + 1e-9).all()
    box = box_hull(np.zeros(3), np.ones(3))
    assert clip_hull(box, np.array([1.0, 0, 0]), -0.1) is None
    assert clip_hull(box, np.array([1.0, 0, 0]), 1.1) is box


def test_many_poses_of_a_pair_give_what_each_pose_gives_alone():
    still, moved = HullSet(hulls=(ball(0.1),)), HullSet(hulls=(ball(0.05, count=40),))
    poses = np.tile(IDENTITY, (2 * FEW_POSES, 1, 1))
    poses[:, 0, 3] = np.linspace(-0.3, 0.3, len(poses))
    found = signed_distances(still, moved, IDENTITY, poses, 0.02)
    alone = [signed_distances(still, moved, IDENTITY, pose, 0.02).distance for pose in poses]
    assert found.pose.tolist() == [index for index, distance in enumerate(alone) if len(distance)]
    np.testing.assert_allclose(found.distance, np.concatenate(alone), atol=1e-12)
    assert 0 < len(found.pose) < len(poses)
