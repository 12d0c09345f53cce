"""Which grasps a plan accepts along the path, and which of them it prefers."""

from unittest.mock import MagicMock

import numpy as np
import pytest
from one_joint import crank

from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver import plan_open as module
from envs.maniskill.solver.grasp import Grasps
from envs.maniskill.solver.plan_open import NoPlan, plan_open


@pytest.fixture
def plan(monkeypatch):
    """A plan with grasps of given costs, whose ways miss and turn by given amounts, with each weight."""

    def make(cost: list[float], missed: list[float], turned: list[float]):
        count, weights = len(cost), []
        grasps = Grasps(poses=np.tile(np.eye(4), (count, 1, 1)), cost=np.array(cost), width=0.05)

        def follow(chain, targets, hold, turn_weight=0.1):
            weights.append(turn_weight)
            chosen = slice(count) if len(weights) == 1 else slice(count, None)
            names = np.arange(2 * count)[chosen, None]
            return np.stack([names, names]), np.array(missed)[chosen], np.array(turned)[chosen]

        def cheapest(opening, path, motions, cost, good, *, skip):
            return int(good[cost[good].argmin()]), 0.0

        monkeypatch.setattr(module, "reach", lambda *_: (np.zeros((count, 1)), np.arange(count)))
        monkeypatch.setattr(module, "starts_of", lambda *_: np.zeros((1, 1)))
        monkeypatch.setattr(module, "follow", follow)
        monkeypatch.setattr(module, "least_pressing", cheapest)
        monkeypatch.setattr(module, "way_around", lambda *_: np.zeros((1, 1)))
        way = MagicMock(held=np.tile(np.eye(4), (2, 1, 1)), carried=np.tile(np.eye(4), (2, 1, 1)))
        opening = MagicMock(robot=ROBOTS["panda"], chain=crank(0.3))
        opening.way.return_value = way
        found = plan_open(opening, grasps, np.zeros(1), 0.0, 1.0)
        return int(found.path[0, 0]), weights

    return make


@pytest.mark.parametrize(("miss", "turn"), [(0.0121, 0.0), (0.0, 0.901)])
def test_a_grasp_keeps_to_its_path_to_twelve_millimetres_and_turns_by_nine_tenths(plan, miss, turn):
    assert plan([0.0], [0.0119, 1.0], [0.899, 1.0])[0] == 0
    with pytest.raises(NoPlan, match="0 grasps can be carried along the path within 12 mm"):
        plan([0.0], [miss, 1.0], [turn, 1.0])


def test_grippers_follow_firmly_and_then_loosely(plan):
    assert plan([0.0], [0.0, 0.0], [0.0, 0.0])[1] == [0.1, 0.01]


@pytest.mark.parametrize(("cost", "best"), [(0.19, 1), (0.21, 0)])
@pytest.mark.parametrize(("miss", "turn"), [(0.01, 0.0), (0.0, 0.2)])
def test_a_centimetre_off_the_path_costs_a_fifth_and_a_radian_one(plan, cost, best, miss, turn):
    assert plan([0.0, cost], [miss, 0.0, 1.0, 1.0], [turn, 0.0, 2.0, 2.0])[0] == best
