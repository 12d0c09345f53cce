"""Grasps by geometry: contacts that oppose, widths, room at rest and along the motion, and what is said."""

from dataclasses import replace

import numpy as np
import pytest
from pulled_drawer import TRAVEL, pulled_drawer

import artigen
from artigen.transforms import transform_points
from sim_export.errors import PackageError
from sim_export.geometry.contacts import HullSet, penetration_depths
from sim_export.geometry.hulls import box_hull, convex_hull
from sim_export.grasps.boxes import carried_boxes
from sim_export.grasps.carry import carry, joint_range
from sim_export.grasps.find import SHORTEST, find_grasps, find_on
from sim_export.grasps.gripper import FRANKA, GRIPPERS, find_gripper
from sim_export.grasps.pairs import FRICTION, find_pairs
from sim_export.grasps.room import Solids, meet
from sim_export.grasps.score import APART, spread_poses
from sim_export.grasps.targets import find_targets

HANDS = tuple(GRIPPERS.values())


def hand_hulls(gripper, grasp, inset: float = 1e-3) -> HullSet:
    """The closed gripper at a grasp, a little smaller so that its pads only touch."""
    boxes = carried_boxes(gripper, np.array([grasp.width]), -inset)[0]
    return HullSet(hulls=tuple(
        convex_hull(transform_points(grasp.pose, box_hull(low, high).vertices)) for low, high in boxes
    ))  # fmt: skip


def cylinder(radius: float, length: float):
    turns = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    rim = radius * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    return convex_hull(np.concatenate([np.c_[rim, np.full(24, z)] for z in (0.0, length)]))


@pytest.mark.parametrize("draft", [0.0, 0.1])
def test_contacts_oppose_within_the_cone_of_friction_also_on_a_wedge(draft: float):
    low, high = 0.03, 0.03 * (1.0 - draft)
    wedge = convex_hull(
        np.array([[x * r, y * r, z] for z, r in ((0, low), (0.05, high)) for x in (-1, 1) for y in (-1, 1)])
    )
    for hull in (wedge, cylinder(0.02, 0.05)):
        pairs = find_pairs((hull,), None, np.array([0.0, 0.0, 1.0]))
        inwards = (-pairs.normal_first * pairs.axis).sum(axis=1)
        assert len(pairs) > 8
        assert inwards.min() >= np.cos(np.arctan(FRICTION)) - 1e-9
        assert (pairs.normal_second * pairs.axis).sum(axis=1).min() >= np.cos(np.arctan(FRICTION)) - 1e-9


def test_the_width_of_a_cylinder_is_its_diameter_across_and_its_length_along():
    pairs = find_pairs((cylinder(0.02, 0.05),), None, np.array([0.0, 0.0, 1.0]))
    along = np.abs(pairs.axis[:, 2]) > 0.99
    np.testing.assert_allclose(pairs.width[along], 0.05, atol=1e-6)
    assert np.all((pairs.width[~along] > 0.0385) & (pairs.width[~along] < 0.0401))


@pytest.mark.parametrize("gripper", HANDS, ids=lambda hand: hand.name)
def test_grasps_fit_the_gripper_and_it_meets_nothing_from_closed_to_open(gripper):
    package = pulled_drawer()
    (found,) = find_grasps(package, gripper)
    assert len(found.grasps) >= 3
    joint = found.target.joint
    T = carry(package, joint, np.linspace(0.0, 0.95, 7))
    for grasp in found.grasps:
        assert 0.0099 <= grasp.width <= gripper.opening
        hand = hand_hulls(gripper, grasp)
        for index, link in enumerate(package.links):
            depth = penetration_depths(HullSet(hulls=link.hulls), hand, T[:, index], T[:, 1])
            assert depth.max() <= 1e-3


def test_the_gripper_moves_with_its_link():
    package = pulled_drawer()
    (found,) = find_grasps(package, FRANKA)
    T = carry(package, found.target.joint, [0.0, 1.0])[:, 1] @ found.grasps[0].pose
    np.testing.assert_allclose(T[1, :3, 3] - T[0, :3, 3], [-TRAVEL, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(T[1, :3, :3], T[0, :3, :3], atol=1e-12)
    assert joint_range(replace(found.target.joint, type="continuous")) == (0.0, np.pi / 2)


def test_a_wall_before_the_open_drawer_leaves_no_grasp_and_that_is_said():
    wall = box_hull(np.array([-0.28, -1.0, -0.5]), np.array([-0.27, 1.0, 0.5]))
    assert find_grasps(pulled_drawer(), FRANKA)[0].grasps
    (found,) = find_grasps(pulled_drawer(0.012, wall), FRANKA)
    assert not found.grasps
    assert "as it opens" in found.reason


def test_a_handle_wider_than_the_gripper_has_no_grasp_and_that_is_said():
    package = pulled_drawer(0.17)
    hand = find_gripper("parallel:0.009")
    (found,) = find_grasps(package, hand)
    assert not found.grasps
    assert "narrowest" in found.reason
    assert "opens to 9 mm" in found.reason


def test_boxes_meet_solids_exactly_where_an_oracle_says_so():
    rng = np.random.default_rng(0)
    solid = convex_hull(rng.uniform(-0.5, 0.5, (20, 3)))
    box = np.array([[-0.2, -0.1, -0.3], [0.2, 0.1, 0.3]])
    T = np.tile(np.eye(4), (300, 1, 1))
    T[:, :3, :3] = np.linalg.qr(rng.normal(size=(300, 3, 3)))[0]
    T[:, :3, :3] *= np.linalg.det(T[:, :3, :3])[:, None, None]
    T[:, :3, 3] = rng.uniform(-0.9, 0.9, (300, 3))
    says = meet(T, np.tile(box, (300, 1, 1, 1)), Solids(hulls=(solid,), T=np.eye(4)[None]))
    depth = penetration_depths(HullSet(hulls=(solid,)), HullSet(hulls=(box_hull(*box),)), np.eye(4), T)
    assert np.all(says[depth > 1e-9])  # none is missed
    assert says.mean() < (depth > 0).mean() + 0.05


def test_buttons_are_pressed_and_not_grasped():
    package = pulled_drawer()
    pressed = replace(package.handles[0], gapart="slider_button", normal=np.array([1.0, 0.0, 0.0]))
    assert len(find_targets(package)) == 1
    assert not [x for x in find_targets(replace(package, handles=(pressed,))) if x.region is not None]


@pytest.mark.parametrize("name", ["hand", "parallel", "parallel:0", "parallel:0.5", "parallel:nan"])
def test_an_unknown_gripper_is_refused_with_those_that_exist(name: str):
    with pytest.raises(PackageError, match=r"expected franka, robotiq_2f85 or parallel:WIDTH"):
        find_gripper(name)


def test_a_pedal_is_pressed_and_a_lever_turns_the_pivot_that_it_hangs_on():
    package = pulled_drawer()
    slide = package.joints[0]
    turn = replace(slide, name="turn", type="revolute", child="pivot", spring=0.0)
    lever = replace(slide, name="lever", type="revolute", parent="pivot", child="link_0")
    knob = replace(package.handles[0], gapart="hinge_knob")
    hung = replace(
        package,
        links=(package.links[0], replace(package.links[1], name="pivot"), package.links[1]),
        joints=(turn, lever),
        handles=(replace(knob, link="pivot", part="pivot"), knob),
    )
    found = [(x.link, x.part, x.joint.name) for x in find_targets(hung) if x.joint and x.region is not None]
    assert found == [("link_0", "pull", "turn"), ("link_0", "pull", "lever")]
    pedal = replace(package, joints=(replace(lever, parent="body", spring=1.0),), handles=(knob,))
    assert not [x for x in find_targets(pedal) if x.region is not None]
    plain = replace(pedal, joints=(replace(lever, parent="body"),))
    assert [x.part for x in find_targets(plain)] == ["pull"]


def test_chosen_poses_differ_and_are_taken_from_one_end_where_the_middle_leaves_too_few():
    T = np.tile(np.eye(4), (4, 1, 1))
    T[:, 1, 3] = 1.001 * APART * np.array([0.9, 0.0, 1.0, 2.0])
    assert spread_poses(T, 12).tolist() == [0, 3]
    assert spread_poses(T, 12, least=3).tolist() == [3, 2, 1]
    assert spread_poses(T, 1, least=3).tolist() == [0]


@pytest.mark.slow
def test_a_dial_near_the_worktop_takes_several_strokes_with_room_along_each():
    package = artigen.sample("Toaster", seed=8100).package
    dial = next(target for target in find_targets(package) if target.part == "browning")
    found = find_on(package, dial, FRANKA)
    begins, ends = np.array([each.stroke for each in found]).T
    assert len(found) > 1
    assert (begins[0], ends[-1]) == (0.0, 1.0)
    np.testing.assert_allclose(begins[1:], (begins + 0.9 * (ends - begins))[:-1])  # proven to come to there
    assert (ends - begins)[:-1].min() >= SHORTEST
    own = [link.name for link in package.links].index(dial.link)
    for each in found:
        assert len(each.grasps) >= 3
        begin, end = each.stroke
        T = carry(package, dial.joint, np.linspace(begin, end if end < 1.0 else 0.05 * begin + 0.95, 5))
        hand = hand_hulls(FRANKA, each.grasps[-1])
        for index, link in enumerate(package.links):
            if index != own:
                depth = penetration_depths(HullSet(hulls=link.hulls), hand, T[:, index], T[:, own])
                assert depth.max() <= 1e-3
