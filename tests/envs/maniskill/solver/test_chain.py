"""Steps of inverse kinematics in closed form, on an arm with one joint."""

import numpy as np
import pytest
from one_joint import crank, turned_tool

from envs.maniskill.solver.chain import solve, tool_pose


def test_a_joint_turns_by_three_tenths_of_a_radian_at_most_in_a_step():
    chain = crank(0.5)
    q = solve(chain, tool_pose(chain, np.array([[1.5]])), np.zeros((1, 1)), iterations=2)[0]
    assert q[0, 0] == pytest.approx(0.6)


def test_a_step_is_damped():
    chain = crank(0.01)
    target = tool_pose(chain, np.array([[0.1]]))
    q = solve(chain, target, np.zeros((1, 1)), iterations=1, turn_weight=0.0)[0]
    assert q[0, 0] == pytest.approx(np.sin(0.1) * 1e-4 / (1e-4 + 1.25e-4), rel=1e-6)


def test_a_radian_counts_as_thirty_centimetres():
    """The tool may turn, or stay where it is: at a lever of 30 cm it does half of both."""
    chain = crank(0.3)
    q, miss, turn = solve(chain, turned_tool(chain, 0.02), np.zeros((1, 1)), iterations=30)
    assert (q[0, 0], miss[0], turn[0]) == pytest.approx((0.01, 0.003, 0.01), rel=1e-3)
