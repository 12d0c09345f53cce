"""The two robots as the tasks see them: where they may stand, how far they reach, how they start."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

RobotName = Literal["panda", "fetch"]


@dataclass(frozen=True, kw_only=True)
class Reach:
    """Where a gripper works with ease: horizontal distances from the base and heights above it, metres.

    Read off tables of solved poses; ``bands`` are several intervals of heights.
    """

    near: float
    far: float
    bands: tuple[tuple[float, float], ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotSpec:
    """Data for placing and driving a robot, in metres and radians.

    ``forward`` and ``down`` are the reach of a gripper that points there.
    ``clearance`` is the free radius around the base and ``column`` the height over which it is needed.
    ``ready`` are the angles of ``arm`` at an episode's start, the gripper open; ``heights`` are stands that
    the robot may be put on, and ``lift`` the travel of a torso. The columns of ``tool_axes`` are, in the
    frame of the link ``tool``, where the gripper points, where its fingers close, and the third direction;
    ``opening`` is the width between open fingers; the names of the links of the hand end in ``hand``.
    """

    name: RobotName
    forward: Reach
    down: Reach
    clearance: float
    column: float
    ready: Float[np.ndarray, "A"]
    heights: tuple[float, ...]
    lift: float
    arm: tuple[str, ...]
    tool: str
    tool_axes: Float[np.ndarray, "3 3"]
    opening: float
    hand: tuple[str, ...]


PANDA = RobotSpec(
    name="panda",
    forward=Reach(near=0.42, far=0.72, bands=((-0.12, 0.10), (0.42, 0.72))),
    down=Reach(near=0.38, far=0.55, bands=((0.0, 0.50),)),
    clearance=0.16,
    column=0.7,
    ready=np.array([0.0, -1.2, 0.0, -2.7, 0.0, 2.6, np.pi / 4]),
    heights=(0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0),
    lift=0.0,
    arm=tuple(f"panda_joint{k}" for k in range(1, 8)),
    tool="panda_hand_tcp",
    tool_axes=np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
    opening=0.08,
    hand=("_hand", "finger"),
)
FETCH = RobotSpec(
    name="fetch",
    forward=Reach(near=0.55, far=0.90, bands=((0.25, 1.15),)),
    down=Reach(near=0.50, far=0.75, bands=((0.30, 0.90),)),
    clearance=0.34,
    column=1.1,
    ready=np.array([1.32, 1.4, -0.2, 1.72, 0.0, 1.66, 0.0]),
    heights=(0.0,),
    lift=0.386,
    arm=(
        "shoulder_pan_joint", "shoulder_lift_joint", "upperarm_roll_joint", "elbow_flex_joint",
        "forearm_roll_joint", "wrist_flex_joint", "wrist_roll_joint",
    ),
    tool="gripper_link",
    tool_axes=np.eye(3),
    opening=0.10,
    hand=("gripper_link", "finger_link"),
)  # fmt: skip
ROBOTS: dict[str, RobotSpec] = {robot.name: robot for robot in (PANDA, FETCH)}
