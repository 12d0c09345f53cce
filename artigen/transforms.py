"""Rigid transforms in numpy: rotations, quaternions (wxyz), screw motions.

``T`` is a 4 x 4 homogeneous matrix acting on column vectors; ``T_a_b`` maps coordinates in ``b``
to coordinates in ``a``. Leading dimensions broadcast everywhere.
"""

import numpy as np
from jaxtyping import Float

from artigen.types import Joint

T_ZUP_FROM_PARTNET = np.array(
    [[0.0, 0.0, -1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
"""PartNet frame (y up, front +z) to the object frame (z up, front -x): rpy (pi/2, 0, -pi/2)."""


def transform_points(T: Float[np.ndarray, "*B 4 4"], points: Float[np.ndarray, "*C N 3"]) -> np.ndarray:
    """Applies ``T`` to points; leading dimensions of both broadcast."""
    return points @ np.swapaxes(T[..., :3, :3], -1, -2) + T[..., None, :3, 3]


def transform_vectors(T: Float[np.ndarray, "*B 4 4"], vectors: Float[np.ndarray, "*C N 3"]) -> np.ndarray:
    """Applies the rotation of ``T`` to directions."""
    return vectors @ np.swapaxes(T[..., :3, :3], -1, -2)


def inverse(T: Float[np.ndarray, "*B 4 4"]) -> Float[np.ndarray, "*B 4 4"]:
    """Inverse of a rigid transform."""
    out = np.zeros_like(T)
    rotation = np.swapaxes(T[..., :3, :3], -1, -2)
    out[..., :3, :3] = rotation
    out[..., :3, 3] = -(rotation @ T[..., :3, 3:])[..., 0]
    out[..., 3, 3] = 1.0
    return out


def shift(offset: Float[np.ndarray, "3"]) -> Float[np.ndarray, "4 4"]:
    """Translation by ``offset``."""
    T = np.eye(4)
    T[:3, 3] = offset
    return T


def rotation_about(
    axis: Float[np.ndarray, "3"], angle: Float[np.ndarray, "*B"]
) -> Float[np.ndarray, "*B 3 3"]:
    """Rotation matrices by ``angle`` (radians) about a unit ``axis`` (Rodrigues)."""
    angle = np.asarray(angle, dtype=np.float64)[..., None, None]
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)


def screw_motion(
    axis: Float[np.ndarray, "3"],
    origin: Float[np.ndarray, "3"],
    angle: Float[np.ndarray, "*B"],
    travel: Float[np.ndarray, "*B"],
) -> Float[np.ndarray, "*B 4 4"]:
    """Rotation by ``angle`` (radians) about the line (``origin``, ``axis``) and translation by ``travel``."""
    angle, travel = np.broadcast_arrays(np.asarray(angle, np.float64), np.asarray(travel, np.float64))
    T = np.zeros((*angle.shape, 4, 4))
    T[..., :3, :3] = rotation_about(axis, angle)
    T[..., :3, 3] = origin - T[..., :3, :3] @ origin + travel[..., None] * axis
    T[..., 3, 3] = 1.0
    return T


def joint_motion(joint: Joint, q: Float[np.ndarray, "*B"]) -> Float[np.ndarray, "*B 4 4"]:
    """Displacement of a part by its own joint at coordinate ``q``, in the object frame at rest."""
    q = np.asarray(q, dtype=np.float64)
    still = np.zeros_like(q)
    match joint.type:
        case "fixed":
            return screw_motion(joint.axis, joint.origin, still, still)
        case "prismatic":
            return screw_motion(joint.axis, joint.origin, still, q)
        case "revolute" | "continuous":
            return screw_motion(joint.axis, joint.origin, q, still)
        case "screw":
            return screw_motion(joint.axis, joint.origin, q, joint.pitch * q)


def quat_from_matrix(R: Float[np.ndarray, "*B 3 3"]) -> Float[np.ndarray, "*B 4"]:
    """Unit quaternions (wxyz, w >= 0) of rotation matrices, numerically stable for every angle."""
    m = np.asarray(R, dtype=np.float64)
    trace = np.trace(m, axis1=-2, axis2=-1)
    # Bar-Itzhack: the quaternion is the dominant eigenvector of this symmetric matrix.
    K = np.zeros((*m.shape[:-2], 4, 4))
    K[..., 0, 0] = trace
    K[..., 0, 1] = K[..., 1, 0] = m[..., 2, 1] - m[..., 1, 2]
    K[..., 0, 2] = K[..., 2, 0] = m[..., 0, 2] - m[..., 2, 0]
    K[..., 0, 3] = K[..., 3, 0] = m[..., 1, 0] - m[..., 0, 1]
    K[..., 1:, 1:] = m + np.swapaxes(m, -1, -2) - trace[..., None, None] * np.eye(3)
    quat = np.linalg.eigh(K)[1][..., -1]
    return np.where(quat[..., :1] < 0, -quat, quat)


def matrix_from_quat(quat: Float[np.ndarray, "*B 4"]) -> Float[np.ndarray, "*B 3 3"]:
    """Rotation matrices of unit quaternions (wxyz)."""
    w, x, y, z = np.moveaxis(np.asarray(quat, dtype=np.float64), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def quat_multiply(a: Float[np.ndarray, "*B 4"], b: Float[np.ndarray, "*B 4"]) -> Float[np.ndarray, "*B 4"]:
    """Hamilton product: the rotation ``b`` followed by ``a``."""
    aw, ax, ay, az = np.moveaxis(np.asarray(a, np.float64), -1, 0)
    bw, bx, by, bz = np.moveaxis(np.asarray(b, np.float64), -1, 0)
    return np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=-1,
    )


def matrix_from_rpy(rpy: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """URDF roll, pitch, yaw (fixed axes x, y, z) as a rotation matrix."""
    roll, pitch, yaw = rpy
    x, y, z = np.eye(3)
    return rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)


def rpy_from_matrix(R: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "3"]:
    """URDF roll, pitch, yaw (radians) of a rotation; yaw is 0 where the pitch is a right angle."""
    level = float(np.hypot(R[0, 0], R[1, 0]))
    pitch = np.arctan2(-R[2, 0], level)
    if level < 1e-9:
        return np.array([np.arctan2(-R[1, 2], R[1, 1]), pitch, 0.0])
    return np.array([np.arctan2(R[2, 1], R[2, 2]), pitch, np.arctan2(R[1, 0], R[0, 0])])


def frame_along(direction: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """Rows of a rotation whose third row is the unit vector ``direction``."""
    first = np.cross(np.eye(3)[int(np.abs(direction).argmin())], direction)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(direction, first), direction])


def thin_direction(points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "3"]:
    """Axis of least extent of centred points; a principal direction if no axis is clearly the thinnest."""
    extents = np.ptp(points, axis=0)
    if extents.min() < 0.5 * np.sort(extents)[1]:
        return np.eye(3)[int(extents.argmin())]
    return np.linalg.svd(points, full_matrices=False)[2][2]


def line_distance(
    point_a: Float[np.ndarray, "3"], axis_a: Float[np.ndarray, "3"],
    point_b: Float[np.ndarray, "3"], axis_b: Float[np.ndarray, "3"],
) -> float:  # fmt: skip
    """Shortest distance between two lines given by a point and a unit direction each."""
    normal = np.cross(axis_a, axis_b)
    length = np.linalg.norm(normal)
    between = point_b - point_a
    if length < 1e-6:
        return float(np.linalg.norm(between - (between @ axis_a) * axis_a))
    return float(abs(between @ normal) / length)
