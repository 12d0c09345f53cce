"""Ways around obstacles: how finely they are checked, how long branches are, how far joints turn."""

import numpy as np
import pytest
from one_joint import crank

from envs.maniskill.solver.detour import between, find_detour


@pytest.mark.parametrize(("angle", "poses"), [(0.179, 3), (0.181, 4)])
def test_poses_on_a_way_are_six_hundredths_of_a_radian_apart(angle, poses):
    assert len(between(np.zeros(2), np.array([angle, 0.1]))) == poses


def looked_at(limit: float) -> list[np.ndarray]:
    """Poses that a search looks at, one array a call, from 0 to a goal that nothing leads to."""
    seen = []

    def free(q: np.ndarray) -> np.ndarray:
        seen.append(q)
        return np.abs(q[:, 0] - 1.0) > 0.1

    assert find_detour(crank(0.1, limit), free, np.zeros(1), np.array([1.2])) is None
    return seen


def test_a_branch_is_six_tenths_of_a_radian_long_at_most():
    ends, straight, *branches = looked_at(9.0)
    assert (len(ends), len(straight)) == (2, 20)
    tree = [x for x in branches if abs(x[0, 0]) < 0.06 + 1e-9]  # those that begin at 0
    assert max(np.abs(x).max() for x in tree) == pytest.approx(0.6)


def test_joints_without_limits_turn_by_two_radians_and_nine_tenths():
    farthest = np.abs(np.concatenate(looked_at(np.inf))).max()
    assert 2.85 < farthest <= 2.9
