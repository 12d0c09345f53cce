"""Drives Fetch to an object of a room: along the shortest way over the map of the room."""

import gymnasium as gym
import numpy as np

from envs.rooms.map import drive_map, find_path, start_place

from ..robots import FETCH
from ..scene import RoomEnv
from .solve import Outcome

AHEAD = 0.25
"""Distance (m) on its way at which the robot aims."""
SPEED, TURN = 0.5, 1.2
"""Largest speed (m/s) and rate of turning (rad/s)."""
FACING = 0.5
"""Angle (rad) to its way from which on the robot turns in place."""
FOLD = 20
"""Steps in which the arm is folded."""
SLOW = 3.0
"""How much more time than at full speed it has."""


def solve_go(env: gym.Env, seed: int) -> Outcome:
    """Plays one episode of ``ArtiGen-Room-v1`` with a goal of the family ``go``, with Fetch and the control
    mode ``pd_joint_pos``; its arm is folded first.

    Args:
        env: The task, one scene on the CPU, wrapped or not.
        seed: Seed of the episode.
    """
    _, info = env.reset(seed=seed)
    task = env.unwrapped
    assert isinstance(task, RoomEnv)
    room, goal = task.furnished.rooms[0], task.goals[0]
    assert goal is not None
    (base,) = goal.bases
    reach = drive_map(room)
    way = min((find_path(reach, start_place(room), place) for place in base.places), key=len)
    robot = task.agent.robot
    most, steps, at = 2 * FOLD + int(SLOW * len(way) * 0.07 / SPEED * task.control_freq), 0, 0
    x, y, yaw = robot.get_qpos()[0, :3].tolist()
    while steps < most and not bool(info["success"][0]):
        x, y, yaw = robot.get_qpos()[0, :3].tolist()
        while at < len(way) - 1 and np.hypot(*(way[at] - (x, y))) < AHEAD:
            at += 1
        aim = way[at] - (x, y)
        off = (np.arctan2(aim[1], aim[0]) - yaw + np.pi) % (2.0 * np.pi) - np.pi
        forward = SPEED * (steps > FOLD) * max(0.0, 1.0 - abs(off) / FACING)
        turn = (steps > FOLD) * float(np.clip(3.0 * off, -TURN, TURN)) / np.pi
        action = np.concatenate([FETCH.ready, [1.0], np.zeros(3), [forward, turn]]).astype(np.float32)
        _, _, _, _, info = env.step(action)
        steps += 1
    done = bool(info["success"][0])
    left = float(np.hypot(*(way[-1] - (x, y))))
    return Outcome(
        success=done, steps=steps, open_fraction=0.0, reason="" if done else f"{left:.2f} m before its place"
    )
