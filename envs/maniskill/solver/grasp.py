"""Ways to take hold of a handle: poses of a two-fingered gripper, from the annotated box and grasp line."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.transforms import rotation_about
from sim_export.package import HandleAnnotation

from ..robots import RobotSpec

YAWS = np.radians([0.0, 25.0, -25.0, 45.0, -45.0, 65.0, -65.0])
"""Turns about the direction in which the fingers close: the bar stays flat between them."""
TILTS = np.radians([0.0, 20.0, -20.0, 40.0, -40.0])
"""Turns about the bar itself, which the fingers then hold at its edges."""
ALONG = (0.0, 0.5, -0.5)
"""Where along half of the grasp line, from its middle."""
SPARE = 0.008
"""How much wider than the handle the open gripper has to be, metres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Grasps:
    """Poses of the gripper in the object frame at rest: x points, y is where the fingers close.

    ``cost`` ranks them: small turns first.
    """

    poses: Float[np.ndarray, "G 4 4"]
    cost: Float[np.ndarray, "G"]


def find_grasps(handle: HandleAnnotation, robot: RobotSpec) -> Grasps:
    """Every grasp of a handle that the gripper opens wide enough for; none if it is too thick."""
    if handle.width + SPARE > robot.opening:
        return Grasps(poses=np.zeros((0, 4, 4)), cost=np.zeros(0))
    middle = handle.corners.mean(axis=0)
    half = (handle.grasp_line[1] - handle.grasp_line[0]) / 2.0
    length = float(np.linalg.norm(half))
    bar = half / length if length > 1e-6 else _across(handle.normal)
    point = -handle.normal + (handle.normal @ bar) * bar
    point /= np.linalg.norm(point)
    close = np.cross(bar, point)
    poses, cost = [], []
    for along in ALONG if length > 0.02 else (0.0,):
        for yaw in YAWS:
            for tilt in TILTS:
                turn = rotation_about(bar, tilt) @ rotation_about(close, yaw)
                for sign in (1.0, -1.0):
                    T = np.eye(4)
                    T[:3, 0], T[:3, 1] = turn @ point, sign * (turn @ close)
                    T[:3, 2] = np.cross(T[:3, 0], T[:3, 1])
                    T[:3, 3] = middle + along * half
                    poses.append(T)
                    cost.append(0.1 * abs(along) + 0.3 * abs(yaw) + 0.6 * abs(tilt))
    return Grasps(poses=np.array(poses), cost=np.array(cost))


def _across(normal: np.ndarray) -> np.ndarray:
    """A horizontal direction along a panel, for a knob that has no long side."""
    side = np.cross(normal, [0.0, 0.0, 1.0])
    length = float(np.linalg.norm(side))
    return side / length if length > 1e-3 else np.array([0.0, 1.0, 0.0])
