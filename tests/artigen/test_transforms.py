"""Laws of rotations, quaternions and screw motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from artigen.transforms import (
    T_ZUP_FROM_PARTNET,
    frame_along,
    inverse,
    joint_motion,
    line_distance,
    matrix_from_quat,
    matrix_from_rpy,
    quat_from_matrix,
    quat_multiply,
    rotation_about,
    rpy_from_matrix,
    screw_motion,
    transform_points,
    transform_vectors,
)
from artigen.types import FIXED, Joint

ATOL = 1e-9
seeds = st.integers(0, 2**32 - 1)
angles = st.floats(-6.0, 6.0)


def random_unit(rng: np.random.Generator) -> np.ndarray:
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def random_rigid(rng: np.random.Generator) -> np.ndarray:
    return screw_motion(
        random_unit(rng), rng.normal(size=3), np.array(rng.uniform(-3, 3)), np.array(rng.normal())
    )


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_rigid_transforms_form_a_group(seed):
    rng = np.random.default_rng(seed)
    a, b, c = (random_rigid(rng) for _ in range(3))
    np.testing.assert_allclose((a @ b) @ c, a @ (b @ c), atol=ATOL)
    np.testing.assert_allclose(a @ inverse(a), np.eye(4), atol=ATOL)
    np.testing.assert_allclose(inverse(a @ b), inverse(b) @ inverse(a), atol=ATOL)
    np.testing.assert_allclose(a[:3, :3].T @ a[:3, :3], np.eye(3), atol=ATOL)
    assert np.linalg.det(a[:3, :3]) == pytest.approx(1.0)


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_points_and_vectors_are_acted_on_by_the_group(seed):
    rng = np.random.default_rng(seed)
    a, b, points = random_rigid(rng), random_rigid(rng), rng.normal(size=(5, 3))
    twice = transform_points(a, transform_points(b, points))
    np.testing.assert_allclose(transform_points(a @ b, points), twice, atol=ATOL)
    difference = transform_points(a, points)[1:] - transform_points(a, points)[:1]
    np.testing.assert_allclose(transform_vectors(a, points[1:] - points[:1]), difference, atol=ATOL)


@settings(max_examples=30, deadline=None)
@given(seeds, angles, angles)
def test_screws_about_one_line_add_up(seed, first, second):
    rng = np.random.default_rng(seed)
    axis, origin, pitch = random_unit(rng), rng.normal(size=3), rng.normal()

    def screw(angle):
        return screw_motion(axis, origin, np.array(angle), np.array(pitch * angle))

    np.testing.assert_allclose(screw(first) @ screw(second), screw(first + second), atol=ATOL)
    on_line = (origin + 0.7 * axis)[None]
    np.testing.assert_allclose(
        transform_points(screw(first), on_line), on_line + pitch * first * axis, atol=ATOL
    )


@settings(max_examples=30, deadline=None)
@given(seeds, angles)
def test_a_moved_screw_is_the_conjugate_of_the_screw(seed, angle):
    rng = np.random.default_rng(seed)
    axis, origin, T = random_unit(rng), rng.normal(size=3), random_rigid(rng)
    plain = screw_motion(axis, origin, np.array(angle), np.array(0.3))
    moved = screw_motion(
        T[:3, :3] @ axis, transform_points(T, origin[None])[0], np.array(angle), np.array(0.3)
    )
    np.testing.assert_allclose(moved, T @ plain @ inverse(T), atol=1e-8)


@settings(max_examples=30, deadline=None)
@given(seeds, angles)
def test_rotations_agree_with_an_independent_library(seed, angle):
    axis = random_unit(np.random.default_rng(seed))
    other = Rotation.from_rotvec(angle * axis)
    np.testing.assert_allclose(rotation_about(axis, np.array(angle)), other.as_matrix(), atol=ATOL)
    x, y, z, w = other.as_quat()
    quat = quat_from_matrix(other.as_matrix())
    assert abs(quat @ np.array([w, x, y, z])) == pytest.approx(1.0)
    assert quat[0] >= 0


@pytest.mark.parametrize("turn", [0.0, 1e-9, np.pi / 2, np.pi - 1e-9, np.pi])
def test_quaternions_survive_the_round_trip_at_every_angle(turn):
    for seed in range(5):
        R = rotation_about(random_unit(np.random.default_rng(seed)), np.array(turn))
        np.testing.assert_allclose(matrix_from_quat(quat_from_matrix(R)), R, atol=1e-8)


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_quaternion_product_is_composition(seed):
    rng = np.random.default_rng(seed)
    A, B = random_rigid(rng)[:3, :3], random_rigid(rng)[:3, :3]
    product = quat_multiply(quat_from_matrix(A), quat_from_matrix(B))
    np.testing.assert_allclose(matrix_from_quat(product), A @ B, atol=1e-8)


def test_roll_pitch_yaw_is_about_fixed_axes():
    rpy = np.array([0.3, -0.7, 1.9])
    np.testing.assert_allclose(matrix_from_rpy(rpy), Rotation.from_euler("xyz", rpy).as_matrix(), atol=ATOL)


def test_partnet_frame_becomes_ours():
    R = T_ZUP_FROM_PARTNET[:3, :3]
    np.testing.assert_allclose(R, matrix_from_rpy(np.array([np.pi / 2, 0.0, -np.pi / 2])), atol=ATOL)
    np.testing.assert_allclose(R @ [0, 1, 0], [0, 0, 1], atol=ATOL)  # up
    np.testing.assert_allclose(R @ [0, 0, 1], [-1, 0, 0], atol=ATOL)  # front


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_line_distance_is_symmetric_and_rigid(seed):
    rng = np.random.default_rng(seed)
    p, q, a, b, T = (
        rng.normal(size=3),
        rng.normal(size=3),
        random_unit(rng),
        random_unit(rng),
        random_rigid(rng),
    )
    distance = line_distance(p, a, q, b)
    assert line_distance(q, b, p, a) == pytest.approx(distance)
    assert line_distance(p + 2.5 * a, a, q - 1.5 * b, -b) == pytest.approx(distance)
    moved = transform_points(T, np.stack([p, q]))
    assert line_distance(moved[0], T[:3, :3] @ a, moved[1], T[:3, :3] @ b) == pytest.approx(
        distance, abs=1e-9
    )
    along = np.linspace(-50, 50, 201)
    apart = np.linalg.norm((p + along[:, None] * a)[:, None] - (q + along[:, None] * b)[None], axis=-1).min()
    assert distance <= apart + 1e-9


def test_line_distance_of_parallel_lines():
    x, z = np.eye(3)[0], np.eye(3)[2]
    assert line_distance(np.zeros(3), z, 3 * x + 7 * z, z) == pytest.approx(3.0)
    assert line_distance(np.zeros(3), z, 7 * z, -z) == pytest.approx(0.0, abs=1e-12)


def test_joint_motions_in_closed_form():
    axis, origin, q = np.array([0.0, 0.0, 1.0]), np.array([1.0, 2.0, 0.0]), np.array(np.pi / 2)
    point = np.array([[2.0, 2.0, 5.0]])

    def moved(kind, **extra):
        return transform_points(joint_motion(Joint(type=kind, axis=axis, origin=origin, **extra), q), point)[
            0
        ]

    np.testing.assert_allclose(moved("revolute", upper=2.0), [1, 3, 5], atol=ATOL)
    np.testing.assert_allclose(moved("continuous", upper=2 * np.pi), [1, 3, 5], atol=ATOL)
    np.testing.assert_allclose(moved("prismatic", upper=2.0), [2, 2, 5 + np.pi / 2], atol=ATOL)
    np.testing.assert_allclose(moved("screw", upper=2.0, pitch=2.0), [1, 3, 5 + np.pi], atol=ATOL)
    np.testing.assert_allclose(transform_points(joint_motion(FIXED, q), point)[0], point[0])


def test_motions_broadcast_over_coordinates():
    joint = Joint(type="screw", axis=np.array([0.0, 1.0, 0.0]), origin=np.ones(3), upper=3.0, pitch=0.2)
    q = np.linspace(0, 3, 6).reshape(2, 3)
    many = joint_motion(joint, q)
    assert many.shape == (2, 3, 4, 4)
    np.testing.assert_allclose(many[1, 2], joint_motion(joint, q[1, 2]))


@pytest.mark.parametrize("pitch", [-np.pi / 2, -0.7, 0.0, 1.2, np.pi / 2])
def test_roll_pitch_yaw_of_a_rotation_give_it_back(pitch):
    for roll, yaw in ((0.3, 1.9), (-2.8, -0.4), (0.0, 3.1)):
        R = matrix_from_rpy(np.array([roll, pitch, yaw]))
        np.testing.assert_allclose(matrix_from_rpy(rpy_from_matrix(R)), R, atol=ATOL)


@pytest.mark.parametrize(
    "direction", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, -0.8), (0.48, 0.6, 0.64)]
)
def test_a_frame_along_a_direction_is_a_rotation_whose_third_row_it_is(direction):
    frame = frame_along(np.array(direction))
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=ATOL)
    np.testing.assert_allclose(np.linalg.det(frame), 1.0, atol=ATOL)
    np.testing.assert_array_equal(frame[2], direction)
