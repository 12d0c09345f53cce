"""Paths of a part, when a latch holds it, and how an arm that presses is judged."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
from one_joint import crank, ground, lifted, swinging

from artigen.types import Joint
from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver import opening
from envs.maniskill.solver.body import Body
from envs.maniskill.solver.field import Field
from envs.maniskill.solver.opening import Opening, least_pressing, path_fractions, way_around

UP = np.array([0.0, 0.0, 1.0])
FLOOR = -0.5
"""Height of the ground, in the frame of the arm with one joint."""


def part(span: float, lever: float | None = None, **changes) -> Any:
    """A drawer, or a part that turns about z with its grip at a distance from the axis."""
    kind = "prismatic" if lever is None else "revolute"
    joint = Joint(
        name="j", type=kind, parent="a", child="b", origin=np.zeros(3), axis=UP, upper=span,
    )  # fmt: skip
    grip = np.array([lever or 0.0, 0.0, 0.3])
    return SimpleNamespace(joint=joint, span=span, grip=grip, **{"grip_latch": None} | changes)


def pressing(others: Field, carried: Field, *gaps: float) -> Opening:
    """The arm with one joint, whose points are arm or hand by clearance; one more of both is far off."""
    body, far = swinging(*gaps), swinging(0.016, 0.008)
    body = Body(
        points=np.concatenate([body.points, 0.0 * far.points]), carrier=np.repeat(0, len(gaps) + 2),
        gap=np.concatenate([body.gap, far.gap]),
    )  # fmt: skip
    return Opening(
        chain=crank(1.0), robot=ROBOTS["panda"], body=body, closed=body, part=MagicMock(),
        T_root_object=np.eye(4), others=others, carried=carried, near_others=others, near_carried=carried,
        turned=0.0,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("span", "lever", "beyond"),
    [(0.2, None, 0.06), (0.05, None, 0.12), (0.2, 0.0, 0.2), (0.2, 0.149, 0.2), (0.2, 0.2, 0.15)],
)
def test_a_path_goes_on_by_six_hundredths_of_the_range_or_six_millimetres(span, lever, beyond):
    """A knob that turns in place moves its grip by 15 cm a radian at least."""
    assert path_fractions(part(span, lever), 0.0, 0.5)[-1] == pytest.approx(0.5 + beyond)


@pytest.mark.parametrize(("span", "steps"), [(0.01, 4), (0.178, 4), (0.179, 5), (1.0, 23)])
def test_a_step_along_a_path_is_twenty_five_millimetres_and_there_are_four(span, steps):
    """The way is 56 hundredths of the range."""
    path = path_fractions(part(max(span, 0.1)), 0.0, 0.5 * span / max(span, 0.1))
    assert len(path) == steps + 1


@pytest.mark.parametrize(("span", "least"), [(0.5, 0.05), (1.5, 0.1)])
def test_a_latch_lets_go_after_a_tenth_of_the_range_or_of_a_radian(span, least):
    leaf = replace(pressing(ground(), ground(), 0.01), part=part(span, 0.3, grip_latch=object()))
    assert leaf.is_latched((least - 1e-3) / span)
    assert not leaf.is_latched((least + 1e-3) / span)


@pytest.mark.parametrize(
    ("gap", "height", "pressed"),
    [(0.016, 0.0121, 0.0), (0.016, 0.010, 0.004), (0.0081, 0.010, 0.004), (0.008, 0.0041, 0.0),
     (0.008, 0.003, 0.002)],
)  # fmt: skip
def test_an_arm_presses_below_twelve_millimetres_and_a_hand_below_four(gap, height, pressed):
    """What presses by the same everywhere counts twice, for its maximum and for its mean."""
    state = pressing(ground(FLOOR), ground(), gap)
    path = lifted(FLOOR + height)[None]
    result = least_pressing(state, path, np.eye(4)[None], np.zeros(1), np.zeros(1, dtype=int))
    assert result[1] == pytest.approx(pressed, abs=1e-9)


@pytest.mark.parametrize(("gap", "pressed"), [(0.016, 0.024), (0.008, 0.0)])
def test_only_the_hand_may_touch_the_part(gap, pressed):
    state, path = pressing(ground(), ground(FLOOR), gap), lifted(FLOOR)[None]
    result = least_pressing(state, path, np.eye(4)[None], np.zeros(1), np.zeros(1, dtype=int))
    assert result[1] == pytest.approx(pressed)


@pytest.mark.parametrize(("cost", "chosen"), [(0.19, 1), (0.21, 0)])
def test_a_centimetre_of_pressing_costs_a_fifth(cost, chosen):
    state, path = pressing(ground(FLOOR), ground(), 0.016), lifted(FLOOR + 0.007, FLOOR + 0.05)[None]
    assert least_pressing(state, path, np.eye(4)[None], np.array([0.0, cost]), np.arange(2))[0] == chosen


def test_half_of_the_clearance_is_kept_on_the_way_to_a_handle(monkeypatch):
    monkeypatch.setattr(opening, "detour", lambda work, *_: work.body.gap[None])
    state = replace(pressing(ground(), ground(), 0.01), part=part(0.3))
    np.testing.assert_allclose(way_around(state, 0.0, np.zeros(1), np.zeros(1)), [[0.005, 0.008, 0.004]])
