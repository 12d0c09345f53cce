"""Places to push at and ways there: behind a leaf that stands ajar, drawn back, beyond the goal."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
from one_joint import ground as ground_field

from artigen.types import Joint
from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver.body import HAND_GAP, Body
from envs.maniskill.solver.chain import Chain, tool_pose
from envs.maniskill.solver.contacts import MOST_POINTS, Contacts, _spread, pinch_grasps, push_contacts
from envs.maniskill.solver.field import build_field
from envs.maniskill.solver.opening import BEYOND, LAG, UNLATCHED, Opening, path_fractions
from envs.maniskill.solver.plan_open import NoPlan
from envs.maniskill.solver.plan_touch import push_places
from envs.maniskill.solver.reach import BACK, drawn_back, reach
from sim_export.geometry.hulls import box_hull
from sim_export.package import Hull

PANDA = ROBOTS["panda"]
LEAF = box_hull(np.zeros(3), np.array([0.02, 0.4, 0.4]))
CUPBOARD = box_hull(np.array([0.021, 0.0, 0.0]), np.array([0.4, 0.4, 0.4]))
GRIP = np.array([0.0, 0.35, 0.2])
SWING = Joint(
    name="hinge", type="revolute", parent="base", child="leaf",
    origin=np.zeros(3), axis=np.array([0.0, 0.0, 1.0]), upper=1.5,
)  # fmt: skip
SLIDE = replace(SWING, type="prismatic", axis=np.array([-1.0, 0.0, 0.0]))


def leaf_part(**changes) -> Any:
    """A leaf in front of a cupboard, hinged at y = 0, that opens towards -x."""
    fields = {"joint": SWING, "grip": GRIP, "own": (LEAF,), "span": 1.5, "kind": "door", "grip_latch": None}
    return SimpleNamespace(**fields | changes)


def leaf_opening(part: Any) -> Opening:
    """The leaf and a hand that is one thin finger of 10 cm."""
    finger = -np.linspace(0.0, 0.1, 6)[:, None] * PANDA.tool_axes[:, 0]
    hand = Body(points=finger, carrier=np.zeros(6, dtype=int), gap=np.full(6, HAND_GAP))
    box = np.stack([GRIP - 0.25, GRIP + 0.25])
    others, carried = build_field((CUPBOARD,), box, 0.005), build_field((LEAF,), box, 0.005)
    return Opening(
        chain=MagicMock(before=np.eye(4)[None], tool=np.eye(4)), robot=PANDA, body=hand, closed=hand,
        part=part, T_root_object=np.eye(4), others=others, carried=carried,
        near_others=others, near_carried=carried, turned=0.0,
    )  # fmt: skip


def test_a_leaf_is_pushed_from_behind_only_when_it_stands_ajar():
    opening = leaf_opening(leaf_part())
    assert len(push_contacts(opening, 0.0, 1.0).poses) == 0
    ajar = push_contacts(opening, 0.5, 1.0)
    assert len(ajar.poses) > 0
    np.testing.assert_allclose(ajar.normals, np.tile([1.0, 0.0, 0.0], (len(ajar.normals), 1)), atol=1e-9)
    shut = push_contacts(opening, 0.5, -1.0)
    np.testing.assert_allclose(shut.normals, np.tile([-1.0, 0.0, 0.0], (len(shut.normals), 1)), atol=1e-9)


def test_places_to_push_at_are_spread_over_the_leaf():
    grid = np.stack([np.zeros(1600), *np.indices((40, 40)).reshape(2, -1) * 0.012], axis=1)
    order = np.argsort(np.linalg.norm(grid, axis=1), kind="stable")
    kept = _spread(grid, order)
    assert 0.3 * MOST_POINTS < len(kept) <= MOST_POINTS
    assert kept[0] == order[0]
    assert np.linalg.norm(grid[:, None] - grid[kept], axis=2).min(axis=1).max() < 0.12
    np.testing.assert_array_equal(_spread(grid, order[:MOST_POINTS]), order[:MOST_POINTS])


@pytest.mark.parametrize(("angle", "held"), [(0.099, True), (0.101, False)])
def test_a_leaf_is_held_by_its_latch_up_to_a_tenth_of_a_radian(angle, held):
    part = leaf_part(grip_latch=object())
    opening = leaf_opening(part)
    assert UNLATCHED * part.span > 0.1
    assert opening.is_latched(angle / part.span) == held
    assert not leaf_opening(leaf_part()).is_latched(0.0)
    if held:
        with pytest.raises(NoPlan, match="latch holds it"):
            push_places(opening, angle / part.span, 1.0)


@pytest.mark.parametrize(("span", "beyond"), [(0.05, LAG / 0.05), (0.2, BEYOND)])
def test_a_path_goes_beyond_its_goal_by_a_share_of_the_range_or_what_the_arm_lags(span, beyond):
    drawer = leaf_part(joint=replace(SWING, type="prismatic"), span=span)
    assert path_fractions(drawer, 0.0, 0.5)[-1] == pytest.approx(0.5 + beyond)
    assert path_fractions(drawer, 0.5, 0.3)[-1] == pytest.approx(0.3 - beyond)
    assert path_fractions(drawer, 0.0, 1.0)[-1] == pytest.approx(1.0 + beyond)
    assert path_fractions(drawer, 0.0, 0.99)[-1] == 1.0


def flat_arm() -> Chain:
    """Three joints about z with links of 30 cm, and the tool of a Panda's fingers pointing along the last."""
    before = np.tile(np.eye(4), (3, 1, 1))  # the first turns x towards z
    before[0, :3, :3] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    before[1:, :3, 3] = [0.0, 0.3, 0.0]
    tool = np.eye(4)
    tool[:3, 3] = [0.0, 0.3, 0.0]
    tool[:3, :3] = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]) @ PANDA.tool_axes.T
    limit = np.full(3, 2.9)
    return Chain(before=before, tool=tool, lower=-limit, upper=limit, columns=(0, 1, 2))


def test_a_gripper_is_drawn_back_along_its_fingers():
    chain, q = flat_arm(), np.array([0.2, 0.9, -0.8])
    before, after = tool_pose(chain, q[None])[0], tool_pose(chain, drawn_back(chain, PANDA, q)[None])[0]
    point = before[:3, :3] @ PANDA.tool_axes[:, 0]
    np.testing.assert_allclose(after[:3, 3], before[:3, 3] - BACK * point, atol=2e-3)
    np.testing.assert_allclose(after[:3, :3], before[:3, :3], atol=2e-2)


def test_only_free_postures_are_reached():
    chain = flat_arm()
    q = np.array([[0.2, 0.9, -0.8]])
    target, starts = tool_pose(chain, q), np.stack([q[0], [0.2 + 0.9, -0.9, 0.1]])
    every = reach(chain, target, np.zeros(1), starts)[0]
    left = reach(chain, target, np.zeros(1), starts, lambda found: found[:, 1] < 0.0)[0]
    assert len(every) > len(left)
    assert (left[:, 1] < 0.0).all()


def stud(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Hull:
    """A cube of a millimetre, with one place to touch on each face."""
    return box_hull(np.array([x, y, z]) - 0.0005, np.array([x, y, z]) + 0.0005)


def studs_opening(
    *own: Hull, grip: np.ndarray | None = None, ground: float = -np.inf, behind: float = 0.0, **changes
) -> Opening:
    """Studs, by default on a drawer that opens to the front, and a hand that is one point ``behind`` its
    tip."""
    part = leaf_part(joint=replace(SLIDE, **changes), own=own, grip=np.zeros(3) if grip is None else grip)
    hand = Body(
        points=(0.009 - behind) * PANDA.tool_axes[:, 0][None], carrier=np.zeros(1, dtype=int),
        gap=np.full(1, 0.008),
    )  # fmt: skip
    return replace(
        leaf_opening(part),
        body=hand,
        closed=hand,
        near_others=ground_field(ground),
        near_carried=ground_field(),
    )


def straight(contacts: Contacts) -> np.ndarray:
    """Poses that push along the normal."""
    point = contacts.poses[:, :3, :3] @ PANDA.tool_axes[:, 0]
    return contacts.poses[(point * contacts.normals).sum(axis=1) < -0.999]


@pytest.mark.parametrize(("away", "some"), [(0.192, True), (0.204, False)])
def test_places_to_push_at_are_within_twenty_centimetres_of_the_grip(away, some):
    assert bool(len(push_contacts(studs_opening(stud(y=away)), 0.0, 1.0).poses)) == some


@pytest.mark.parametrize(("height", "some"), [(0.0101, True), (0.0099, False)])
def test_a_centimetre_in_front_of_a_place_to_push_at_is_free(height, some):
    lift = studs_opening(stud(), ground=-0.0005 - height, axis=np.array([0.0, 0.0, 1.0]))
    assert bool(len(push_contacts(lift, 0.0, 1.0).poses)) == some


@pytest.mark.parametrize(("cosine", "some"), [(0.76, True), (0.74, False)])
def test_a_push_is_along_the_motion(cosine, some):
    aslant = studs_opening(stud(), axis=np.array([-cosine, np.sqrt(1.0 - cosine**2), 0.0]))
    assert bool(len(push_contacts(aslant, 0.0, 1.0).poses)) == some


@pytest.mark.parametrize(("lever", "some"), [(0.0576, True), (0.0516, False)])
def test_a_place_to_push_at_is_not_close_to_the_axis(lever, some):
    """The other one is 15.6 cm away from it, so that the least distance is 5.46 cm."""
    leaf = studs_opening(stud(y=lever), stud(y=0.156), type="revolute", axis=np.array([0.0, 0.0, 1.0]))
    pushed = straight(push_contacts(leaf, 0.0, 1.0))[:, 1, 3]
    assert (np.abs(pushed - 0.156) < 0.001).any()
    assert (np.abs(pushed - lever) < 0.001).any() == some
    pinched = pinch_grasps(leaf).poses[:, 1, 3]
    assert (np.abs(pinched - lever) < 0.003).any() == some


def test_fingers_touch_with_their_tip_or_lean_on_their_flank_at_a_cost():
    found = push_contacts(studs_opening(stud(), grip=np.array([0.0, 0.096, 0.0])), 0.0, 1.0)
    point = found.poses[:, :3, :3] @ PANDA.tool_axes[:, 0]
    lean = np.arccos(np.clip(-(point * found.normals).sum(axis=1), -1.0, 1.0))
    np.testing.assert_allclose(np.unique(np.round(np.degrees(lean))), [0.0, 30.0, 60.0, 90.0])
    off = (found.poses[:, :3, 3] * found.normals).sum(axis=1) - 0.0005
    np.testing.assert_allclose(off, 0.009 * np.cos(lean) ** 2 + 0.011 * np.sin(lean), atol=1e-6)
    np.testing.assert_allclose(found.cost, 0.5 * 0.096 + 0.15 * lean, atol=5e-4)


def test_a_place_costs_half_its_distance_and_more_the_closer_it_is_to_the_axis():
    """A fifth on the axis itself."""
    leaf = studs_opening(
        stud(y=0.108), stud(y=0.156), grip=np.array([0.0, 0.108, 0.0]), type="revolute",
        axis=np.array([0.0, 0.0, 1.0]),
    )  # fmt: skip
    near, far = 0.2 * (1.0 - 0.108 / 0.156), 0.5 * 0.048
    pinched = pinch_grasps(leaf)
    close = np.abs(pinched.poses[:, 1, 3] - 0.108) < 0.003
    assert pinched.cost[close].min() == pytest.approx(near, abs=2e-3)
    assert pinched.cost[~close].min() == pytest.approx(far, abs=2e-3)
    pushed = push_contacts(leaf, 0.0, 1.0)
    close = np.abs(pushed.poses[:, 1, 3] - 0.108) < 0.001
    assert pushed.cost[close].min() == pytest.approx(near, abs=2e-3)
    assert pushed.cost.min() == pytest.approx(far, abs=1e-3)


@pytest.mark.parametrize(("behind", "some"), [(0.0219, True), (0.0221, False)])
def test_only_the_ends_of_the_fingers_may_touch(behind, some):
    """What is farther back is below the ground."""
    lift = studs_opening(stud(), ground=-0.012, behind=behind, axis=np.array([0.0, 0.0, 1.0]))
    assert bool(len(straight(push_contacts(lift, 0.0, 1.0)))) == some


def test_a_pinch_from_below_costs_a_tenth_more():
    grasps = pinch_grasps(studs_opening(stud(), grip=np.array([0.0, 0.096, 0.0])))
    upwards = np.maximum(grasps.poses[:, 2, 0], 0.0)
    assert upwards.max() > 0.99
    np.testing.assert_allclose(grasps.cost, 0.5 * 0.096 + 0.1 * upwards, atol=5e-4)


@pytest.mark.parametrize(("height", "some"), [(0.0187, True), (0.0173, False)])
def test_fingers_that_close_need_eighteen_millimetres_behind_their_ends(height, some):
    grasps = pinch_grasps(studs_opening(stud(), ground=-height))
    assert (grasps.poses[:, 2, 0] > 0.99).any() == some
