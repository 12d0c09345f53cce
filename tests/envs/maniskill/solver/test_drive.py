"""Control steps and gripper actions."""

from unittest.mock import MagicMock

import numpy as np
import pytest

from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver.drive import Driver, finger_action, move


@pytest.mark.parametrize(
    ("robot", "width", "action"), [("panda", 0.02, -0.2), ("panda", 0.06, 0.6), ("fetch", 0.04, 0.0)]
)
def test_a_gripper_opens_in_proportion_from_a_centimetre_below_shut(robot, width, action):
    assert finger_action(ROBOTS[robot], width) == pytest.approx(action)


@pytest.mark.parametrize(
    ("angle", "speed", "steps"), [(0.209, 1.0, 3), (0.211, 1.0, 4), (0.139, 0.5, 4), (0.141, 0.5, 5)]
)
def test_a_joint_turns_by_seven_hundredths_of_a_radian_a_step(angle, speed, steps):
    env = MagicMock()
    env.step.return_value = (None, 0.0, False, False, {})
    driver = Driver(
        env=env, task=MagicMock(), robot=ROBOTS["panda"], chain=MagicMock(), body=MagicMock(),
        closed=MagicMock(), begin=0.0, target=np.zeros(2), gripper=1.0, info={}, over=False, steps=0,
    )  # fmt: skip
    move(driver, np.array([0.01, angle]), speed)
    assert driver.steps == steps
