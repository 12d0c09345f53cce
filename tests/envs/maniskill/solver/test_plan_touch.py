"""How fingers come to a place to push at, how far they push, and what counts as on the way."""

from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
from one_joint import crank, swinging

from artigen.types import Joint
from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver import plan_touch as module
from envs.maniskill.solver.contacts import Contacts
from envs.maniskill.solver.plan_open import NoPlan
from envs.maniskill.solver.plan_touch import plan_touch

PANDA = ROBOTS["panda"]
STILL = np.tile(np.eye(4), (2, 1, 1))


def joint(kind: Any = "prismatic", spring: float = 0.0, lever: float = 0.0) -> Joint:
    return Joint(
        name="j", type=kind, parent="a", child="b", origin=np.array([0.0, lever, 0.0]),
        axis=np.array([1.0, 0.0, 0.0]), upper=0.1, spring=spring,
    )  # fmt: skip


@pytest.fixture
def touch(monkeypatch):
    """The best of the places in a plan, and what was asked for: targets and weights along the path and on
    the way there, and clearances."""

    def make(cost=(0.0,), missed=(0.0,), lost=(0.0,), turned=(0.0,), moved=None):
        count, asked, gaps = len(cost), [], []
        pose, normal = np.eye(4), np.array([-1.0, 0.0, 0.0])
        pose[:3, :3] = PANDA.tool_axes.T  # points along x
        found = Contacts(
            poses=np.tile(pose, (count, 1, 1)), cost=np.array(cost), normals=np.tile(normal, (count, 1))
        )

        def follow(chain, targets, hold, turn_weight):
            asked.append((targets.copy(), turn_weight))
            names = np.tile(np.arange(count)[:, None], (len(targets), 1, 1)).astype(float)
            return names, np.array(missed if len(asked) == 1 else lost), np.array(turned)

        def is_free(chain, body, obstacles, q):
            gaps.append(body.gap)
            return np.ones(len(q), dtype=bool)

        def reach(chain, targets, cost, starts, free):
            return np.zeros((count, 1)), np.arange(count)[free(np.zeros((count, 1)))]

        def cheapest(opening, path, motions, cost, good, *, skip, body):
            return int(good[cost[good].argmin()]), 0.0

        for name, stub in (("follow", follow), ("is_free", is_free), ("reach", reach)):
            monkeypatch.setattr(module, name, stub)
        monkeypatch.setattr(module, "least_pressing", cheapest)
        monkeypatch.setattr(module, "starts_of", lambda *_: np.zeros((1, 1)))
        monkeypatch.setattr(module, "way_around", lambda *_: np.zeros((1, 1)))
        opening = MagicMock(
            robot=PANDA, chain=crank(0.3), closed=swinging(0.016, 0.008),
            part=SimpleNamespace(joint=moved or joint()),
        )  # fmt: skip
        opening.motions.return_value = STILL
        opening.way.return_value = SimpleNamespace(held=STILL, carried=STILL)
        plan = plan_touch(opening, found, np.zeros(1), 0.0, 1.0)
        return SimpleNamespace(best=int(plan.path[0, 0]), path=asked[0], back=asked[1], gaps=gaps)

    return make


def test_fingers_come_from_before_the_surface_and_are_drawn_back_before_that(touch):
    targets, weight = touch().back
    np.testing.assert_allclose(targets[:, 0, :3, 3], [[0, 0, 0], [-0.02, 0, 0], [-0.09, 0, 0]], atol=1e-9)
    assert weight == 0.02


@pytest.mark.parametrize(
    ("kind", "spring", "lever", "beyond"),
    [
        ("prismatic", 0.0, 0.0, 0.008),
        ("prismatic", -5.0, 0.0, 0.008),
        ("prismatic", 5.0, 0.0, 0.016),
        ("revolute", 1.0, 0.4, 0.012),
        ("revolute", 0.1, 0.01, 0.016),
        ("revolute", 0.1, 0.021, 0.008 + 0.00016 / 0.021),
    ],
)
def test_fingers_push_beyond_the_path_and_more_against_a_spring(touch, kind, spring, lever, beyond):
    """The arm yields by 0.8 mm a newton, to twice the spring's force; a lever is 2 cm long at least."""
    targets, weight = touch(moved=joint(kind, spring, lever)).path
    np.testing.assert_allclose(targets[:, 0, :3, 3], [[0.0, 0.0, 0.0], [beyond, 0.0, 0.0]], atol=1e-9)
    assert weight == 0.02


def test_two_millimetres_are_kept_on_the_way_to_a_surface(touch):
    """Of the arm at the surface, and of all on the way to it."""
    assert [x.tolist() for x in touch().gaps] == [[0.002], [0.002, 0.002]]


@pytest.mark.parametrize(("name", "most"), [("missed", 0.006), ("turned", 1.3), ("lost", 0.036)])
def test_fingers_miss_turn_and_come_near_enough(touch, name, most):
    assert touch(**{name: (most - 1e-4,)}).best == 0
    with pytest.raises(NoPlan, match="0 ways to push it"):
        touch(**{name: (most + 1e-4,)})


@pytest.mark.parametrize(("name", "value"), [("missed", 0.005), ("lost", 0.02), ("turned", 1.0 / 3.0)])
@pytest.mark.parametrize(("cost", "best"), [(0.98, 1), (1.02, 0)])
def test_five_millimetres_off_cost_as_much_as_twenty_before_the_surface(touch, name, value, cost, best):
    """And as much as a third of a radian: a tenth."""
    assert touch(cost=(0.0, 0.1 * cost), **{name: (value, 0.0)}, **others(name)).best == best


def others(name: str) -> dict[str, tuple[float, float]]:
    return {other: (0.0, 0.0) for other in ("missed", "lost", "turned") if other != name}
