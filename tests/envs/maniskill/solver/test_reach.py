"""Which poses count as reached, what a jump costs, and where searches start."""

from types import SimpleNamespace

import numpy as np
import pytest
from one_joint import crank, moved_tool, turned_tool

from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver.chain import Chain, tool_pose
from envs.maniskill.solver.reach import drawn_back, follow, reach, starts_of

START = np.zeros((1, 1))


@pytest.mark.parametrize(("offset", "found"), [(0.0119, 1), (0.0121, 0)])
def test_a_pose_is_reached_to_twelve_millimetres(offset, found):
    chain = crank(0.3)
    assert len(reach(chain, moved_tool(chain, offset), np.zeros(1), START)[0]) == found


@pytest.mark.parametrize(("angle", "found"), [(0.119, 1), (0.121, 0)])
def test_a_pose_is_reached_to_twelve_hundredths_of_a_radian(angle, found):
    chain = crank(0.3, limit=1e-6)
    assert len(reach(chain, turned_tool(chain, angle), np.zeros(1), START)[0]) == found


@pytest.mark.parametrize(("cost", "first"), [(0.049, 1), (0.051, 0)])
def test_a_radian_away_from_the_arms_posture_costs_a_twentieth(cost, first):
    chain = crank(0.3)
    targets = tool_pose(chain, np.array([[1.0], [0.0]]))
    assert reach(chain, targets, np.array([0.0, cost]), START)[1][0] == first


@pytest.mark.parametrize(("angle", "miss"), [(0.49, 0.0), (0.51, 0.1)])
def test_a_jump_by_more_than_half_a_radian_counts_as_ten_centimetres(angle, miss):
    chain = crank(0.3)
    targets = tool_pose(chain, np.array([[0.0], [angle]]))[:, None]
    assert follow(chain, targets, START)[1][0] == pytest.approx(miss, abs=1e-5)


def test_along_a_path_a_radian_counts_as_ten_centimetres():
    """The tool may turn, or stay where it is: at a lever of 10 cm it does half of both."""
    chain = crank(0.1)
    targets = np.stack([turned_tool(chain, 0.0), turned_tool(chain, 0.02)])
    way, miss, turn = follow(chain, targets, START)
    assert (way[1, 0, 0], miss[0], turn[0]) == pytest.approx((0.01, 0.001, 0.01), rel=1e-2)


def test_searches_start_within_two_and_a_half_radians():
    limit = np.full(60, 2.9)
    chain = Chain(
        before=np.tile(np.eye(4), (60, 1, 1)), tool=np.eye(4), lower=-limit, upper=limit,
        columns=tuple(range(60)),
    )  # fmt: skip
    starts = starts_of(chain, SimpleNamespace(ready=np.zeros(60)), np.zeros(60))  # type: ignore[arg-type]
    assert 2.4 < starts.max() <= 2.5
    assert -2.5 <= starts.min() < -2.4


def test_a_gripper_is_drawn_back_by_ten_centimetres():
    """Fetch's fingers point along x, which two joints about z take back by a rhombus of 30 cm edges."""
    before = np.tile(np.eye(4), (3, 1, 1))
    before[0, :3, :3] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    before[1:, :3, 3] = [0.0, 0.3, 0.0]
    tool = np.eye(4)
    tool[:3, :3] = before[0, :3, :3].T
    limit = np.full(3, 2.9)
    chain = Chain(before=before, tool=tool, lower=-limit, upper=limit, columns=(0, 1, 2))
    q = np.array([0.5, -1.0, 0.5])
    after = drawn_back(chain, ROBOTS["fetch"], q)
    way = (tool_pose(chain, after[None]) - tool_pose(chain, q[None]))[0, :3, 3]
    assert np.linalg.norm(way) == pytest.approx(0.10, abs=2e-3)
