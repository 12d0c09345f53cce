"""Moves a robot through a task's actions: the solver has no other access to the simulation."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import gymnasium as gym
import numpy as np
import torch
from jaxtyping import Float

from artigen.transforms import inverse, shift
from sim_export.package import Hull

from ...hand import pose_matrix
from ..hulls import hulls_at
from ..objects import TaskPart
from ..robots import RobotSpec
from .body import Body, read_body
from .chain import Chain, read_arm

if TYPE_CHECKING:
    from ..task import PackageTask

CONTROL_MODE = "pd_joint_pos"
FINGERS_SHUT = -0.01
"""Finger position of ManiSkill's grippers at action -1, metres."""
JOINT_STEP = 0.07
"""Largest change of an arm joint in one control step, rad: 1.4 rad/s."""


@dataclass(kw_only=True, eq=False)
class Driver:
    """One robot in one scene on the CPU, driven by absolute arm angles.

    ``body`` is its arm with the gripper open, ``closed`` with the fingers shut, ``begin`` the initial open
    fraction of the part. ``gripper`` is 1 open and -1 closed; ``info`` and ``over`` are those of the last
    step.
    """

    env: gym.Env
    task: "PackageTask"
    robot: RobotSpec
    chain: Chain
    body: Body
    closed: Body
    begin: float
    target: Float[np.ndarray, "J"]
    gripper: float
    info: dict
    over: bool
    steps: int

    @property
    def succeeded(self) -> bool:
        """Whether the task counts as solved after the last step."""
        return bool(self.info["success"][0])


def start(env: gym.Env, info: dict) -> Driver:
    """A driver for an environment that has just been reset.

    Raises:
        ValueError: If it is not one scene on the CPU with the control mode ``pd_joint_pos``.
    """
    task: PackageTask = env.unwrapped  # type: ignore[assignment]
    if task.num_envs != 1 or task.gpu_sim_enabled:
        raise ValueError(f"the solver drives one scene on the CPU, this task has {task.num_envs}")
    if task.control_mode != CONTROL_MODE:
        raise ValueError(f"control_mode {task.control_mode!r}, the solver needs {CONTROL_MODE!r}")
    articulation = task.agent.robot._objs[0]
    qpos = np.asarray(articulation.qpos, dtype=np.float64)
    chain = read_arm(articulation, task.robot_spec)
    body = read_body(articulation, chain, task.robot_spec.hand)
    closed = read_body(articulation, chain, task.robot_spec.hand, closed=True)
    return Driver(
        env=env, task=task, robot=task.robot_spec, chain=chain, body=body, closed=closed,
        begin=float(task.open_fraction[0]), target=qpos[list(chain.columns)],
        gripper=1.0, info=info, over=False, steps=0,
    )  # fmt: skip


def arm_angles(driver: Driver) -> Float[np.ndarray, "J"]:
    """The arm's current joint angles, rad."""
    qpos = np.asarray(driver.task.agent.robot._objs[0].qpos, dtype=np.float64)
    return qpos[list(driver.chain.columns)]


def object_in_root(driver: Driver) -> Float[np.ndarray, "4 4"]:
    """The object frame in the frame of the robot's root link."""
    return inverse(root_pose(driver)) @ shift(np.array([0.0, 0.0, -driver.task.drawn[0][0].floor]))


def object_qpos(driver: Driver) -> dict[str, float]:
    """The object's current joint coordinates, by name."""
    names = [joint.name for joint in driver.task.built[0].active_joints]
    return dict(zip(names, driver.task.object.get_qpos()[0, : len(names)].tolist(), strict=True))


def opened(driver: Driver, part: TaskPart) -> float:
    """Current open fraction of a part."""
    return (object_qpos(driver)[part.joint.name] - part.joint.lower) / part.span


def object_hulls(driver: Driver, part: TaskPart) -> tuple[tuple[Hull, ...], tuple[Hull, ...]]:
    """All hulls of the object at its current state, in the object frame: those that move with the part, and
    the others."""
    return hulls_at(driver.task.drawn[0][0], part, object_qpos(driver))


def root_pose(driver: Driver) -> Float[np.ndarray, "4 4"]:
    """``T_world_root`` of the robot's root link."""
    return pose_matrix(driver.task.agent.robot._objs[0].root_pose)


def step(driver: Driver, target: Float[np.ndarray, "J"]) -> None:
    """One control step towards arm angles; does nothing once the episode is over."""
    if driver.over:
        return
    driver.target = target
    extra = np.zeros(5 if driver.robot.name == "fetch" else 0)  # torso, head and base stay
    action = np.concatenate([target, [driver.gripper], extra]).astype(np.float32)
    _, _, terminated, truncated, driver.info = driver.env.step(action)
    driver.steps += 1
    driver.over = bool(torch.as_tensor(terminated).any() or torch.as_tensor(truncated).any())


def move(driver: Driver, goal: Float[np.ndarray, "J"], speed: float = 1.0) -> None:
    """Moves straight in joint space to ``goal``, at a share of the usual speed."""
    begin = driver.target
    count = max(1, int(np.ceil(np.abs(goal - begin).max() / (speed * JOINT_STEP))))
    for k in range(1, count + 1):
        step(driver, begin + (goal - begin) * k / count)


def wait(driver: Driver, count: int) -> None:
    """Holds still for some control steps."""
    for _ in range(count):
        step(driver, driver.target)


def finger_action(robot: RobotSpec, width: float) -> float:
    """Action that opens a gripper to a width in metres: 1 is fully open."""
    widest = robot.opening / 2.0
    return float(np.clip(2.0 * (width / 2.0 - FINGERS_SHUT) / (widest - FINGERS_SHUT) - 1.0, -1.0, 1.0))


def grip(driver: Driver, opening: float, count: int) -> None:
    """Opens (1) or closes (-1) the gripper and waits for it."""
    driver.gripper = opening
    wait(driver, count)
