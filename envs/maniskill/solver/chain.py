"""Forward and inverse kinematics of a robot arm.

Read once from the engine, so that it agrees with it. Inverse kinematics uses damped least squares on batches:
many starts and many targets are solved at once.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.transforms import rotation_about

from ...hand import pose_matrix
from ..robots import RobotSpec

if TYPE_CHECKING:
    from sapien.physx import PhysxArticulation

X_AXIS = np.array([1.0, 0.0, 0.0])
DAMPING = 0.05
LARGEST_STEP = 0.3
"""Largest change of a joint in one iteration, radians."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Chain:
    """Turning joints from a robot's root to its tool. Joint k turns about the x axis of the frame that
    ``before[k]`` gives relative to the frame after joint k-1; ``tool`` follows the last joint. ``lower`` and
    ``upper`` are limits in radians; ``columns`` are the joints' indices in the articulation's ``qpos``."""

    before: Float[np.ndarray, "J 4 4"]
    tool: Float[np.ndarray, "4 4"]
    lower: Float[np.ndarray, "J"]
    upper: Float[np.ndarray, "J"]
    columns: tuple[int, ...]


def read_arm(articulation: "PhysxArticulation", robot: RobotSpec) -> Chain:
    """The arm of a robot in the engine, with all other joints fixed at their current position."""
    link = next(link for link in articulation.links if link.name.endswith(robot.tool))
    prefix = link.name.removesuffix(robot.tool)
    qpos = np.asarray(articulation.qpos, dtype=np.float64)
    columns = {joint.name: index for index, joint in enumerate(articulation.active_joints)}
    way = []
    while link.parent is not None:
        way.append(link.joint)
        link = link.parent
    before, limits, moving = [], [], []
    constant = np.eye(4)
    for joint in reversed(way):
        constant = constant @ pose_matrix(joint.pose_in_parent)
        if joint.name.removeprefix(prefix) in robot.arm:
            before.append(constant)
            limits.append(np.asarray(joint.limit, dtype=np.float64).reshape(-1)[:2])
            moving.append(columns[joint.name])
            constant = np.eye(4)
        elif joint.name in columns:
            constant = constant @ held_motion(joint.type, float(qpos[columns[joint.name]]))
        constant = constant @ np.linalg.inv(pose_matrix(joint.pose_in_child))
    lower, upper = np.array(limits).T
    return Chain(before=np.stack(before), tool=constant, lower=lower, upper=upper, columns=tuple(moving))


def tool_pose(chain: Chain, q: Float[np.ndarray, "B J"]) -> Float[np.ndarray, "B 4 4"]:
    """``T_root_tool`` for joint angles."""
    return _forward(chain, np.asarray(q, dtype=np.float64))[0]


def joint_frames(chain: Chain, q: Float[np.ndarray, "B J"]) -> Float[np.ndarray, "B J 4 4"]:
    """``T_root_frame`` of the frame after every joint; the joint's axis is its x axis."""
    steps = np.zeros((*q.shape, 4, 4))
    steps[..., :3, :3] = rotation_about(X_AXIS, q)
    steps[..., 3, 3] = 1.0
    steps = chain.before @ steps
    out = np.empty_like(steps)
    out[:, 0] = steps[:, 0]
    for k in range(1, len(chain.before)):
        np.matmul(out[:, k - 1], steps[:, k], out=out[:, k])
    return out


def solve(
    chain: Chain,
    targets: Float[np.ndarray, "B 4 4"],
    start: Float[np.ndarray, "B J"],
    *,
    iterations: int,
    turn_weight: float = 0.3,
) -> tuple[Float[np.ndarray, "B J"], Float[np.ndarray, "B"], Float[np.ndarray, "B"]]:
    """Joint angles that bring the tool to ``targets`` (in the root's frame), from ``start``.

    Args:
        targets: Poses of the tool.
        start: Initial posture.
        iterations: Fixed number of steps.
        turn_weight: Cost in metres of a radian of orientation error.

    Returns:
        Joint angles within the limits, and the remaining errors in metres and radians.
    """
    q = np.clip(np.asarray(start, dtype=np.float64), chain.lower, chain.upper)
    weights = np.array([1.0, 1.0, 1.0, turn_weight, turn_weight, turn_weight])
    for _ in range(iterations):
        reached, jacobian = _forward(chain, q)
        error = pose_error(reached, targets) * weights
        A = jacobian * weights[None, :, None]
        H = np.swapaxes(A, 1, 2) @ A + DAMPING**2 * 0.05 * np.eye(q.shape[1])
        change = np.linalg.solve(H, np.einsum("bij,bi->bj", A, error)[..., None])[..., 0]
        q = np.clip(q + np.clip(change, -LARGEST_STEP, LARGEST_STEP), chain.lower, chain.upper)
    left = pose_error(_forward(chain, q)[0], targets)
    return q, np.linalg.norm(left[:, :3], axis=1), np.linalg.norm(left[:, 3:], axis=1)


def pose_error(
    reached: Float[np.ndarray, "B 4 4"], targets: Float[np.ndarray, "B 4 4"]
) -> Float[np.ndarray, "B 6"]:
    """Translation (m) and rotation vector (rad), in the common frame, from one pose to another."""
    R = targets[:, :3, :3] @ np.swapaxes(reached[:, :3, :3], 1, 2)
    skew = 0.5 * np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    sine = np.linalg.norm(skew, axis=1)
    angle = np.arctan2(sine, (np.trace(R, axis1=1, axis2=2) - 1.0) / 2.0)
    turn = skew * np.where(sine > 1e-6, angle / np.maximum(sine, 1e-9), 1.0)[:, None]
    return np.concatenate([targets[:, :3, 3] - reached[:, :3, 3], turn], axis=1)


def _forward(chain: Chain, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tool poses and geometric Jacobians ``[B, 6, J]``."""
    frames = joint_frames(chain, q)
    T = frames[:, -1] @ chain.tool
    axes = frames[..., :3, 0]
    arms = np.cross(axes, T[:, None, :3, 3] - frames[..., :3, 3])
    return T, np.concatenate([arms, axes], axis=2).swapaxes(1, 2)


def held_motion(kind: str, value: float) -> Float[np.ndarray, "4 4"]:
    """Motion of a SAPIEN joint (axis x) at a coordinate in m or rad."""
    T = np.eye(4)
    if kind == "prismatic":
        T[0, 3] = value
    else:
        T[:3, :3] = rotation_about(X_AXIS, np.array(value))
    return T
