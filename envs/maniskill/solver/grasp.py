"""Grasps of a handle: poses of a two-fingered gripper, from the annotated box and grasp line."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.transforms import rotation_about
from sim_export.package import HandleAnnotation, Hull

from ..robots import RobotSpec

YAWS = np.radians([0.0, 25.0, -25.0, 45.0, -45.0, 65.0, -65.0])
"""Rotations about the closing direction of the fingers: the bar stays flat between them."""
TILTS = np.radians([0.0, 20.0, -20.0, 40.0, -40.0])
"""Rotations about the bar itself, which the fingers then hold at its edges."""
ALONG = (0.0, 0.5, -0.5)
"""Positions along half of the grasp line, from its middle."""
ACROSS = 0.05
"""Cost of closing along a short handle instead of across it."""
LEAST_HUB = 0.010
"""Smallest protrusion of a hub from the rest of a handle, metres."""
EVEN = 0.003
"""Distance from the foremost hull within which hulls belong to the hub, metres."""
TIP, TIP_GAP = 0.009, 0.002
"""Length of the fingers beyond the middle of their tips, and their clearance from what is behind, metres."""
HUB_YAWS = np.radians([0.0, 15.0, -15.0, 30.0, -30.0])
ROOMY = 0.024
"""Opening of the fingers beyond the handle's width, metres, limited because neighbours may be close."""
SPARE = 0.008
"""Smallest opening of the gripper beyond the handle's width, metres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Grasps:
    """Poses of the gripper in the object frame at rest: x points, y is the closing direction.

    ``cost`` ranks them: small rotations first. ``width`` is the opening of the fingers before they close,
    metres.
    """

    poses: Float[np.ndarray, "G 4 4"]
    cost: Float[np.ndarray, "G"]
    width: float


def find_grasps(handle: HandleAnnotation, held: tuple[Hull, ...], robot: RobotSpec) -> Grasps:
    """All grasps of a handle that fit into the gripper.

    A wheel that is too thick is grasped at its hub, if that protrudes; empty if there is no such place.
    """
    if handle.width + SPARE > robot.opening:
        return _hub_grasps(handle, held, robot)
    middle = handle.grasp_line.mean(axis=0)
    half = (handle.grasp_line[1] - handle.grasp_line[0]) / 2.0
    length = float(np.linalg.norm(half))
    bar = half / length if length > 1e-6 else across(handle.normal)
    point = -handle.normal + (handle.normal @ bar) * bar
    point /= np.linalg.norm(point)
    close = np.cross(bar, point)
    poses, cost = [], []
    for along in ALONG if length > 0.02 else (0.0,):
        for yaw in YAWS:
            for tilt in TILTS:
                turn = rotation_about(bar, tilt) @ rotation_about(close, yaw)
                for sign in (1.0, -1.0):
                    ahead, between = turn @ point, sign * (turn @ close)
                    poses.append(gripper_pose(ahead, between, middle + along * half))
                    cost.append(0.1 * abs(along) + 0.3 * abs(yaw) + 0.6 * abs(tilt))
    width, long = handle.width, float(np.ptp(handle.corners @ bar))
    if long + SPARE <= robot.opening:  # knob or short pull: neighbours may leave room one way only
        width = max(width, long)
        for yaw in HUB_YAWS:
            for sign in (1.0, -1.0):
                turn = rotation_about(bar, yaw)
                poses.append(gripper_pose(turn @ point, sign * bar, middle))
                cost.append(ACROSS + 0.3 * abs(yaw))
    width = min(robot.opening, width + ROOMY)
    return Grasps(poses=np.array(poses), cost=np.array(cost), width=width)


def _hub_grasps(handle: HandleAnnotation, held: tuple[Hull, ...], robot: RobotSpec) -> Grasps:
    """Grasps of the foremost part of a thick handle, straight from the front, vertical or horizontal."""
    none = Grasps(poses=np.zeros((0, 4, 4)), cost=np.zeros(0), width=robot.opening)
    if not held:
        return none
    reach = np.array([(hull.vertices @ handle.normal).max() for hull in held])
    foremost = reach > reach.max() - EVEN
    behind = float(reach[~foremost].max(initial=(handle.corners @ handle.normal).min()))
    if reach.max() - behind < LEAST_HUB:
        return none
    hub = np.concatenate([hull.vertices for hull, flag in zip(held, foremost, strict=True) if flag])
    level = across(handle.normal)
    poses, cost = [], []
    for close in (level, np.cross(handle.normal, level)):
        if np.ptp(hub @ close) + SPARE > robot.opening:
            continue
        middle = (hub.min(axis=0) + hub.max(axis=0)) / 2.0
        middle += (behind + TIP + TIP_GAP - middle @ handle.normal) * handle.normal
        for yaw in HUB_YAWS:
            for sign in (1.0, -1.0):
                ahead = rotation_about(close, yaw) @ -handle.normal
                poses.append(gripper_pose(ahead, sign * close, middle))
                cost.append(0.3 * abs(yaw))
    return Grasps(poses=np.array(poses), cost=np.array(cost), width=robot.opening) if poses else none


def gripper_pose(
    point: Float[np.ndarray, "3"],
    close: Float[np.ndarray, "3"],
    place: Float[np.ndarray, "3"],
    robot: RobotSpec | None = None,
) -> Float[np.ndarray, "4 4"]:
    """Pose with x along a pointing and y along a closing direction, or the pose of a robot's tool there."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = np.stack([point, close, np.cross(point, close)], axis=1), place
    if robot is not None:
        T[:3, :3] = T[:3, :3] @ robot.tool_axes.T
    return T


def across(direction: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """A unit vector perpendicular to a direction, horizontal if possible."""
    side = np.cross(direction, [0.0, 0.0, 1.0])
    length = float(np.linalg.norm(side))
    return side / length if length > 1e-3 else np.array([0.0, 1.0, 0.0])
