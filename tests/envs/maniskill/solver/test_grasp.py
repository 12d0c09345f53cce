"""Which handles a gripper takes, where, and at what cost."""

import numpy as np
import pytest

from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver.grasp import Grasps, find_grasps
from sim_export.geometry.hulls import box_hull
from sim_export.package import HandleAnnotation, Hull

PANDA = ROBOTS["panda"]
FRONT, SIDE = np.array([-1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])


def bar(width: float = 0.02, line: float = 0.2, long: float = 0.3) -> HandleAnnotation:
    """A handle in front of x = 0 with its middle at 0, along y; half of its grasp line is ``line``."""
    corners = np.array(
        [[x, y, z] for x in (-0.02, 0.0) for y in (-long / 2, long / 2) for z in (-width / 2, width / 2)]
    )
    return HandleAnnotation(
        link="a", part="a", corners=corners, grasp_line=np.stack([-line * SIDE, line * SIDE]), width=width,
        normal=FRONT, clearance=0.1, opening_direction=FRONT, gapart="",
    )  # fmt: skip


def of_hub(held: tuple[Hull, ...]) -> Grasps:
    """Grasps of a handle that is too thick and ends 20 cm behind its front."""
    return find_grasps(bar(width=0.5), held, PANDA)


def block(front: float, low: float, high: float) -> Hull:
    """From x = 0 to ``front`` before it, and from ``low`` to ``high`` along y."""
    return box_hull(np.array([-front, low, -0.01]), np.array([0.0, high, 0.01]))


@pytest.mark.parametrize(("robot", "most"), [("panda", 0.072), ("fetch", 0.092)])
def test_a_handle_wider_than_the_gripper_is_no_grasp(robot, most):
    assert len(find_grasps(bar(most - 1e-4), (), ROBOTS[robot]).poses)
    assert not len(find_grasps(bar(most + 1e-4), (), ROBOTS[robot]).poses)


@pytest.mark.parametrize(("width", "opened"), [(0.02, 0.044), (0.055, 0.079), (0.057, 0.08)])
def test_fingers_open_a_little_wider_than_the_handle(width, opened):
    assert find_grasps(bar(width), (), PANDA).width == pytest.approx(opened)


@pytest.mark.parametrize(("long", "ways"), [(0.0719, 80), (0.0721, 70)])
def test_a_handle_as_short_as_the_gripper_is_wide_is_also_held_at_its_ends(long, ways):
    grasps = find_grasps(bar(line=0.0, long=long), (), PANDA)
    assert len(grasps.poses) == ways
    ends = np.abs(grasps.poses[:, :3, 1] @ SIDE) > 0.99
    assert ends.sum() == ways - 70
    yaw = np.arccos(np.clip(grasps.poses[ends, 0, 0], -1.0, 1.0))
    np.testing.assert_allclose(grasps.cost[ends], 0.05 + 0.3 * yaw, atol=1e-6)


@pytest.mark.parametrize(("line", "shares"), [(0.0199, [0.0]), (0.0201, [-0.5, 0.0, 0.5])])
def test_a_longer_handle_is_also_taken_halfway_to_its_ends(line, shares):
    places = find_grasps(bar(line=line), (), PANDA).poses[:, 1, 3] / line
    np.testing.assert_allclose(np.unique(np.round(places, 6)), shares)


def test_a_grasp_costs_what_it_is_turned_and_off_the_middle():
    grasps = find_grasps(bar(line=0.1), (), PANDA)
    ahead, off = grasps.poses[:, :3, 0], np.abs(grasps.poses[:, 1, 3]) / 0.1
    yaw, tilt = np.arcsin(np.abs(ahead[:, 1])), np.arctan2(np.abs(ahead[:, 2]), ahead[:, 0])
    np.testing.assert_allclose(grasps.cost, 0.1 * off + 0.3 * yaw + 0.6 * tilt, atol=1e-9)
    np.testing.assert_allclose(np.degrees([yaw.max(), tilt.max()]), [65.0, 40.0])


@pytest.mark.parametrize(("ahead", "held"), [(0.0099, False), (0.0101, True)])
def test_a_hub_stands_out_by_a_centimetre(ahead, held):
    rim, hub = block(0.02, -0.1, 0.1), block(0.02 + ahead, -0.025, 0.025)
    assert bool(len(of_hub((rim, hub)).poses)) == held


@pytest.mark.parametrize(("behind", "middle"), [(0.0029, [0.035]), (0.0031, [])])
def test_what_is_within_three_millimetres_of_the_front_belongs_to_the_hub(behind, middle):
    places = of_hub((block(0.04, 0.0, 0.02), block(0.04 - behind, 0.05, 0.07))).poses[:, 1, 3]
    np.testing.assert_allclose(np.unique(np.round(places, 9)), middle)


def test_fingers_at_a_hub_stay_clear_of_the_rim():
    grasps = of_hub((block(0.02, -0.1, 0.1), block(0.05, -0.025, 0.025)))
    np.testing.assert_allclose(grasps.poses[:, 0, 3], -(0.02 + 0.011))
    yaw = np.arccos(np.clip(grasps.poses[:, 0, 0], -1.0, 1.0))
    np.testing.assert_allclose(grasps.cost, 0.3 * yaw, atol=1e-6)
    assert np.degrees(yaw.max()) == pytest.approx(30.0)
