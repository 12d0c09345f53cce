"""An arm with one joint, whose errors and heights have closed forms."""

import numpy as np

from artigen.transforms import rotation_about
from envs.maniskill.solver.body import Body
from envs.maniskill.solver.chain import X_AXIS, Chain, tool_pose
from envs.maniskill.solver.field import Field


def crank(lever: float, limit: float = 3.0) -> Chain:
    """A joint about x with the tool at y = ``lever``."""
    tool = np.eye(4)
    tool[1, 3] = lever
    return Chain(
        before=np.eye(4)[None], tool=tool, lower=np.array([-limit]), upper=np.array([limit]), columns=(0,)
    )


def turned_tool(chain: Chain, angle: float) -> np.ndarray:
    """The tool at angle 0, turned about its own place by ``angle`` about x."""
    T = tool_pose(chain, np.zeros((1, 1)))
    T[:, :3, :3] = rotation_about(X_AXIS, np.array(angle)) @ T[:, :3, :3]
    return T


def moved_tool(chain: Chain, offset: float) -> np.ndarray:
    """The tool at angle 0, moved along the joint's axis, where the arm cannot follow."""
    T = tool_pose(chain, np.zeros((1, 1)))
    T[:, 0, 3] += offset
    return T


def swinging(*gaps: float) -> Body:
    """Points on the moving link that are as high as the sine of the joint's angle, with their clearances."""
    count = len(gaps)
    points = np.tile([0.0, 1.0, 0.0], (count, 1))
    return Body(points=points, carrier=np.zeros(count, dtype=int), gap=np.array(gaps))


def lifted(*heights: float) -> np.ndarray:
    """Angles at which these points are at heights."""
    return np.arcsin(heights)[:, None]


def ground(height: float = -np.inf) -> Field:
    """Nothing but the ground; all the rest is 12 cm away from everything."""
    far = np.full((1, 1, 1), 0.12, dtype=np.float32)
    return Field(low=np.full(3, 1e3), cell=0.01, distance=far, ground=height)
