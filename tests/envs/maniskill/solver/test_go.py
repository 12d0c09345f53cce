"""Fetch drives around what stands in a room, over its rug, to where a goal says."""

from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from bare_room import ROOM

import envs  # noqa: F401 (registers the task)
from envs.goals.file import write_goals
from envs.goals.goal import BaseGoal, Goal
from envs.rooms.file import write_room
from envs.rooms.map import CELL, find_path
from envs.rooms.room import Fixture

WALL = Fixture(name="bench", low=(1.2, 1.5, 0.0), high=(2.8, 1.6, 0.6), color=(0.5, 0.5, 0.5))
RUG = Fixture(name="rug", low=(0.2, 0.3, 0.0005), high=(3.8, 1.3, 0.006), color=(0.5, 0.3, 0.3))


@pytest.mark.sim
def test_fetch_drives_behind_a_bench(tmp_path: Path):
    pytest.importorskip("mani_skill")
    from envs.maniskill.solver.go import solve_go

    room = replace(ROOM, fixtures=(*ROOM.fixtures, WALL, RUG))
    goal = Goal(words="go behind it", family="go", bases=(BaseGoal(places=((2.0, 2.4),), reach=0.1),))
    write_room(room, tmp_path)
    write_goals((goal,), tmp_path)
    env = gym.make(
        "ArtiGen-Room-v1", scenes=tmp_path, goal=goal.words, robot_uids="fetch", reward_mode="sparse",
        obs_mode="none", sim_backend="physx_cpu", render_backend="none", control_mode="pd_joint_pos",
    )  # fmt: skip
    outcome = solve_go(env, 0)
    env.close()
    assert outcome.success, outcome.reason


@pytest.mark.parametrize(("gap", "least"), [(slice(0, 40), 2.0), (slice(0, 1), 4.63)])
def test_a_way_is_the_shortest_over_free_cells(gap: slice, least: float):
    """From one side of a wall to the other, through an opening that is everywhere, or at its far end, with 18
    steps along the wall and 20 across on each side."""
    reach = np.ones((40, 41), dtype=bool)
    reach[:, 20] = False
    reach[gap, 20] = True
    way = find_path(reach, (1.925, 0.025), (1.925, 2.025))
    steps = np.linalg.norm(np.diff(way, axis=0), axis=1)
    assert (reach[tuple((way / CELL).astype(int).T)]).all()
    assert steps.max() < 1.5 * CELL
    assert least - 0.01 < steps.sum() < 1.1 * least
    np.testing.assert_allclose(way[[0, -1]], [[1.925, 0.025], [1.925, 2.025]])
