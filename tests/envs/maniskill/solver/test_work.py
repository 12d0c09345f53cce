"""Which poses and paths among obstacles are exact."""

import numpy as np
import pytest
from one_joint import crank, ground, moved_tool, swinging, turned_tool

from envs.maniskill.robots import RobotSpec
from envs.maniskill.solver import work
from envs.maniskill.solver.body import Obstacle
from envs.maniskill.solver.chain import Chain
from envs.maniskill.solver.work import Work, free_poses, free_ways

READY = RobotSpec.__new__(RobotSpec)
object.__setattr__(READY, "ready", np.zeros(1))


def free_work(chain: Chain) -> Work:
    obstacle = Obstacle(field=ground(), T_field_root=np.eye(4))
    return Work(chain=chain, robot=READY, body=swinging(0.01), obstacles=(obstacle,))


@pytest.mark.parametrize(("offset", "exact"), [(0.0039, True), (0.0041, False)])
def test_poses_among_obstacles_are_exact_to_four_millimetres(offset, exact):
    chain = crank(0.3)
    target = moved_tool(chain, offset)
    assert bool(len(free_poses(free_work(chain), target, np.zeros(1), 5)[0])) == exact
    assert free_ways(free_work(chain), np.stack([target, target]), np.zeros((1, 1)))[1][0] == exact


@pytest.mark.parametrize(("angle", "exact"), [(0.099, True), (0.101, False)])
def test_poses_among_obstacles_are_exact_to_a_tenth_of_a_radian(angle, exact):
    chain = crank(0.3, limit=1e-6)
    target = turned_tool(chain, angle)
    assert bool(len(free_poses(free_work(chain), target, np.zeros(1), 5)[0])) == exact
    assert free_ways(free_work(chain), np.stack([target, target]), np.zeros((1, 1)))[1][0] == exact


@pytest.mark.parametrize(("angle", "exact"), [(0.0442, True), (0.0447, False)])
def test_on_ways_among_obstacles_a_radian_counts_as_thirty_centimetres(angle, exact):
    """At a lever of 10 cm the tool turns by nine tenths of what it should, and is off by as much."""
    chain = crank(0.1)
    targets = np.stack([turned_tool(chain, 0.0), turned_tool(chain, angle)])
    assert free_ways(free_work(chain), targets, np.zeros((1, 1)))[1][0] == exact


@pytest.mark.parametrize(
    ("miss", "turn", "kept"), [(0.249, 0.249, True), (0.251, 0, False), (0, 0.251, False)]
)
def test_what_is_off_by_a_quarter_after_some_steps_is_abandoned(monkeypatch, miss, turn, kept):
    def solve(chain, targets, start, *, iterations):
        left = (float(miss), float(turn)) if iterations < 20 else (0.0, 0.0)
        return (start, *(np.full(len(targets), x) for x in left))

    monkeypatch.setattr(work, "solve", solve)
    chain = crank(0.1)
    assert bool(len(free_poses(free_work(chain), moved_tool(chain, 0.0), np.zeros(1), 5)[0])) == kept
