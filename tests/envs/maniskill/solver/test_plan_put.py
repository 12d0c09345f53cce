"""Poses from which a cube is picked and put down, and which of them are preferred."""

from types import SimpleNamespace

import numpy as np
import pytest
from one_joint import crank, ground, swinging

from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver import plan_put as module
from envs.maniskill.solver.body import Obstacle
from envs.maniskill.solver.plan_put import NoPutPlan, plan_put
from envs.maniskill.solver.work import Work

PANDA = ROBOTS["panda"]
UP, INWARDS = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
AIM = np.array([0.5, 0.0, 0.0])
STEEP = np.cos(np.pi / 6.0), np.sin(np.pi / 6.0)
"""A hand that points down by 30 degrees."""


@pytest.fixture
def put(monkeypatch):
    """The place of a plan, and all paths that were looked at: of picks, of lifts, and of places.

    ``ways`` are places to choose from: rank of the aim, turn, height, joint angles along the path.
    """

    def make(*, down=False, ways=(), found=True):
        asked, gaps = [], []

        def free_poses(work, targets, q, most):
            gaps.append(work.body.gap)
            asked.append([])
            if len(asked) % 2 == 0 and ways:
                order = np.array([choice(targets, *way[:3]) for way in ways])
                return np.array([[way[3][0]] for way in ways]), order
            count = len(targets) if found else 0
            return np.zeros((count, 1)), np.arange(count)

        def choice(targets, rank, turn, height):
            point = targets[:, :3, :3] @ PANDA.tool_axes[:, 0]
            at = AIM + np.array([0.0, 0.1 * rank, height])
            ahead = [STEEP[0] * np.cos(turn), STEEP[0] * np.sin(turn), -STEEP[1]]
            near = np.linalg.norm(targets[:, :3, 3] - at, axis=1) + np.linalg.norm(point - ahead, axis=1)
            assert near.min() < 1e-6
            return int(near.argmin())

        def free_ways(work, targets, hold):
            asked[-1].append(targets.swapaxes(0, 1))
            q = np.tile(hold, (len(targets), 1, 1))
            if len(asked) % 2 == 0 and ways:
                for k, way in enumerate(ways):
                    q[1:, k, 0] = np.r_[way[3][1:], np.full(len(q) - len(way[3]), way[3][-1])]
            return q, np.ones(len(hold), dtype=bool)

        for name, stub in (("free_poses", free_poses), ("free_ways", free_ways)):
            monkeypatch.setattr(module, name, stub)
        monkeypatch.setattr(module, "detour", lambda work, begin, end: end[None])
        work = Work(
            chain=crank(0.3), robot=PANDA, body=swinging(0.016),
            obstacles=(Obstacle(field=ground(), T_field_root=np.eye(4)),),
        )  # fmt: skip
        aims = AIM + np.arange(2)[:, None] * [0.0, 0.1, 0.0]
        plan = None
        if found:
            plan = plan_put(work, np.zeros(1), np.eye(4), size=0.04, aims=aims, inwards=INWARDS, down=down)
        else:
            with pytest.raises(NoPutPlan, match="no free pose of the arm reaches the cube on its stand"):
                plan_put(work, np.zeros(1), np.eye(4), size=0.04, aims=aims, inwards=INWARDS, down=down)
        return SimpleNamespace(plan=plan, asked=asked, gaps=gaps)

    return make


def test_a_cube_is_taken_above_its_middle_from_behind_and_lifted(put):
    (behind, lifted), _ = put().asked
    point = behind[:, 0, :3, :3] @ PANDA.tool_axes[:, 0]
    back = np.array([0.0, 0.03, 0.08, 0.14])[None, :, None] * point[:, None]
    np.testing.assert_allclose(behind[:, :, :3, 3], 0.006 * UP - back, atol=1e-9)
    heights = np.tile([0.006, 0.046, 0.096], (len(lifted), 1))
    np.testing.assert_allclose(lifted[:, :, 2, 3], heights)
    slopes = np.degrees(np.arcsin(np.clip(-point[:, 2], -1.0, 1.0)))
    np.testing.assert_allclose(np.unique(np.round(slopes, 6)), [0.0, 15.0, 30.0, 45.0, 65.0, 90.0])


@pytest.mark.parametrize(
    ("down", "heights", "least", "rise"), [(True, [0.02, 0.06, 0.12], 30.0, 1.0), (False, [0.02], 0.0, 0.1)]
)
def test_a_cube_enters_a_drawer_from_above_and_a_compartment_almost_level(put, down, heights, least, rise):
    _, (ways,) = put(down=down).asked
    np.testing.assert_allclose(np.unique(np.round(ways[:, 0, 2, 3], 9)), heights)
    back = rise * UP - (0.0 if down else 1.0) * INWARDS
    lengths = np.array([0.0, 0.03, 0.06, 0.10, 0.14, 0.18])
    along = ways[:, :, :3, 3] - ways[:, :1, :3, 3]
    np.testing.assert_allclose(along, np.tile(lengths[:, None] * back, (len(ways), 1, 1)), atol=1e-9)
    point = ways[:, 0, :3, :3] @ PANDA.tool_axes[:, 0]
    slopes = np.degrees(np.arcsin(np.clip(-point[:, 2], -1.0, 1.0)))
    assert slopes.min() == pytest.approx(least)
    heading = np.degrees(np.arctan2(point[:, 1], point[:, 0]))[slopes < 80.0]
    np.testing.assert_allclose(np.unique(np.abs(np.round(heading, 6))), [0.0, 20.0, 45.0, 90.0])


def test_all_clearances_are_kept_or_else_two_fifths_of_them_but_always_that_of_the_cube(put):
    assert [x.tolist() for x in put(found=False).gaps] == [[0.016], [0.4 * 0.016]]
    first, loaded = put().gaps
    np.testing.assert_allclose(first, 0.016)
    np.testing.assert_allclose(loaded[1:], 0.003)


TURN = np.radians(20.0)


@pytest.mark.parametrize(
    ("way", "cost"),
    [
        ((1, 0.0, 0.02), 0.1),
        ((0, TURN, 0.02), 0.3 * np.pi / 9.0),
        ((0, 0.0, 0.06), 0.16),
    ],
)
@pytest.mark.parametrize("share", [0.98, 1.02])
@pytest.mark.parametrize("kind", ["travel", "distance"])
def test_places_off_the_first_one_cost_as_much_as_some_motion_of_the_arm(put, way, cost, share, kind):
    """To another aim, to the side, or from higher up; a radian on the way, or to it, costs 0.3."""
    angle = share * cost / 0.3
    moved = (0.0, angle / 2.0, 0.0) if kind == "travel" else (angle, angle)
    plan = put(down=True, ways=((0, 0.0, 0.02, moved), (*way, (0.001, 0.001)))).plan
    assert plan.place[-1, 0] == pytest.approx(moved[0] if share < 1.0 else 0.001)
