"""The scripted robot's geometry: arm kinematics, distances, ways around obstacles, grasps; no simulator."""

from dataclasses import replace
from itertools import pairwise
from unittest.mock import MagicMock

import numpy as np
import pytest
from sample_packages import SAMPLE_PARTS, build_package

from artigen.transforms import rotation_about
from envs.maniskill.hulls import ground_under, hulls_at, open_above_ground, opened_qpos
from envs.maniskill.objects import TaskObject, read_object
from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver import opening
from envs.maniskill.solver.body import Body, Obstacle, holding, is_free, spare_room, surface_points
from envs.maniskill.solver.chain import Chain, joint_frames, pose_error, solve, tool_pose
from envs.maniskill.solver.detour import RESOLUTION, between, find_detour
from envs.maniskill.solver.drive import finger_action
from envs.maniskill.solver.field import AROUND, build_field, distances
from envs.maniskill.solver.grasp import find_grasps
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull, move_hull
from sim_export.package import HandleAnnotation


@pytest.fixture(scope="module")
def cabinet(tmp_path_factory: pytest.TempPathFactory) -> TaskObject:
    return read_object(write_package(build_package(SAMPLE_PARTS), tmp_path_factory.mktemp("s") / "c"), "any")


def arm(joints: int = 4) -> Chain:
    """An arm with links of 30 cm whose joints turn about changing directions."""
    before = np.tile(np.eye(4), (joints, 1, 1))
    before[:, :3, 3] = [0.3, 0.0, 0.05]
    for k in range(joints):
        before[k, :3, :3] = rotation_about(np.array([0.0, 0.0, 1.0]), np.array(0.5 + k))
    tool = np.eye(4)
    tool[:3, 3] = [0.1, 0.0, 0.2]
    limit = np.full(joints, 2.5)
    return Chain(before=before, tool=tool, lower=-limit, upper=limit, columns=tuple(range(joints)))


def test_solved_angles_reach_their_poses():
    chain, rng = arm(6), np.random.default_rng(0)
    q = rng.uniform(-1.0, 1.0, (20, 6))
    targets = tool_pose(chain, q)
    found, miss, turn = solve(chain, targets, q + rng.uniform(-0.2, 0.2, q.shape), iterations=60)
    assert miss.max() < 1e-3
    assert turn.max() < 1e-2
    error = pose_error(tool_pose(chain, found), targets)
    np.testing.assert_allclose(np.linalg.norm(error[:, :3], axis=1), miss, atol=1e-9)
    np.testing.assert_allclose(joint_frames(chain, q)[:, -1] @ chain.tool, targets, atol=1e-12)


def test_a_small_turn_moves_the_tool_as_the_joint_frame_says():
    chain = arm()
    q = np.array([[0.3, -0.4, 0.5, 0.2]])
    frames, at = joint_frames(chain, q)[0], tool_pose(chain, q)[0, :3, 3]
    for k in range(4):
        moved = q.copy()
        moved[0, k] += 1e-6
        speed = (tool_pose(chain, moved)[0, :3, 3] - at) / 1e-6
        np.testing.assert_allclose(speed, np.cross(frames[k, :3, 0], at - frames[k, :3, 3]), atol=1e-5)


def test_distances_are_those_to_a_box():
    low, high = np.array([-0.1, -0.2, 0.0]), np.array([0.1, 0.2, 0.3])
    field = build_field((box_hull(low, high),))
    points = np.random.default_rng(0).uniform(low - 0.1, high + 0.1, (500, 3))
    true = np.linalg.norm(np.maximum(np.maximum(low - points, points - high), 0.0), axis=1)
    assert (true > 0.02).sum() > 100
    np.testing.assert_allclose(distances(field, points), true, atol=1.5 * field.cell)
    assert distances(field, np.array([5.0, 0.0, 0.0])) == pytest.approx(AROUND)
    with pytest.raises(ValueError, match="no hulls"):
        build_field(())


def test_thin_panels_are_solid():
    panel = box_hull(np.array([0.0, -0.3, 0.0]), np.array([0.002, 0.3, 0.5]))
    field = build_field((panel,))
    points = np.c_[np.full(50, 0.001), np.linspace(-0.29, 0.29, 50), np.full(50, 0.25)]
    assert distances(field, points).max() <= field.cell


def test_surface_points_cover_a_hull():
    size = np.array([0.2, 0.1, 0.06])
    points = surface_points(box_hull(-size, size).vertices, 0.03)
    assert (np.abs(np.abs(points) / size).max(axis=1) > 1.0 - 1e-9).all()
    rng = np.random.default_rng(0)
    there = rng.uniform(-size, size, (300, 3))
    side = rng.integers(3, size=300)
    there[np.arange(300), side] = np.sign(there[np.arange(300), side]) * size[side]
    nearest = np.linalg.norm(there[:, None] - points, axis=2).min(axis=1)
    assert nearest.max() < 0.04


def test_an_arm_is_free_where_its_points_keep_their_gaps():
    chain = arm()
    body = Body(points=np.zeros((1, 3)), carrier=np.array([3]), gap=np.array([0.02]))
    q = np.random.default_rng(1).uniform(-2.0, 2.0, (40, 4))
    at = joint_frames(chain, q)[:, 3, :3, 3]
    field = build_field((box_hull(at[0] - 0.05, at[0] + 0.05),))
    obstacle = Obstacle(field=field, T_field_root=np.eye(4))
    room = spare_room(chain, body, (obstacle,), q)
    np.testing.assert_allclose(room, distances(field, at) - 0.02, atol=1e-6)
    assert not is_free(chain, body, (obstacle,), q)[0]
    # What moves along with the arm is as far away in every pose.
    moving = Obstacle(field=field, T_field_root=np.linalg.inv(joint_frames(chain, q)[:, 3]))
    along = spare_room(chain, body, (moving,), q)
    np.testing.assert_allclose(along, along[0], atol=1e-6)
    held = holding(body, chain, box_hull(np.full(3, -0.02), np.full(3, 0.02)).vertices, 0.0)
    assert len(held.points) > 8
    assert np.abs(held.points[1:] - chain.tool[:3, 3]).max() <= 0.02 + 1e-9


def wall(q: np.ndarray, slack: float = 0.0) -> np.ndarray:
    """A wall across the first two joints, open for the second above 1.5; ``slack`` makes it smaller."""
    return (np.abs(q[:, 0]) > 0.2 - slack) | (q[:, 1] > 1.5 - slack)


def test_a_detour_leads_around_a_wall():
    chain = arm()
    begin, end = np.array([-1.0, 0.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0, 0.0])
    way = find_detour(chain, wall, begin, end)
    assert way is not None
    np.testing.assert_array_equal(way[[0, -1]], [begin, end])
    # Corners are cut between poses that were looked at, so the way may graze the wall by less than a step.
    assert all(wall(between(a, b), RESOLUTION).all() for a, b in pairwise(way))
    assert way[:, 1].max() > 1.5
    np.testing.assert_array_equal(way, find_detour(chain, wall, begin, end))
    straight = find_detour(chain, wall, begin, begin + 0.1)
    assert straight is not None
    assert len(straight) == 2


def test_there_is_no_detour_out_of_something_solid():
    begin, end = np.array([0.0, 0.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0, 0.0])
    assert find_detour(arm(), wall, begin, end) is None


def wheel() -> tuple[HandleAnnotation, tuple]:
    """A wheel of 20 cm, 2 cm thick, with a hub of 5 cm that stands out by 2 cm, in front of x = 0."""
    rim = box_hull(np.array([-0.02, -0.1, -0.1]), np.array([0.0, 0.1, 0.1]))
    hub = box_hull(np.array([-0.04, -0.025, -0.025]), np.array([0.0, 0.025, 0.025]))
    corners = np.array([[x, y, z] for x in (-0.04, 0.0) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])
    line = np.array([[-0.02, 0.0, -0.08], [-0.02, 0.0, 0.08]])
    front = np.array([-1.0, 0.0, 0.0])
    handle = HandleAnnotation(
        link="wheel", part="wheel_0", corners=corners, grasp_line=line, width=0.2, normal=front,
        clearance=0.0, opening_direction=front, gapart="",
    )  # fmt: skip
    return handle, (rim, hub)


def test_a_wheel_is_taken_at_its_hub():
    handle, hulls = wheel()
    grasps = find_grasps(handle, hulls, ROBOTS["panda"])
    assert len(grasps.poses)
    best = grasps.poses[grasps.cost.argmin()]
    np.testing.assert_allclose(best[:3, 0], [1.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(best[1:3, 3], 0.0, atol=1e-9)
    assert -0.04 < best[0, 3] < -0.02 - 0.005  # on the hub, the finger tips off the rim
    flat = move_hull(hulls[1], np.array([[0.5, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]))
    assert not len(find_grasps(handle, (hulls[0], flat), ROBOTS["panda"]).poses)


@pytest.mark.parametrize("long", [0.02, 0.05, 0.3])
def test_a_handle_on_posts_is_taken_at_its_bar(long):
    corners = np.array([[x, y, z] for x in (0.0, 0.013) for y in (-0.1, 0.1) for z in (-long, 0.0)])
    line, up = np.array([[0.0065, -0.09, -0.01], [0.0065, 0.09, -0.01]]), np.array([0.0, 0.0, 1.0])
    handle = HandleAnnotation(
        link="grip", part="grip_0", corners=corners, grasp_line=line, width=0.013, normal=up,
        clearance=0.1, opening_direction=up, gapart="",
    )  # fmt: skip
    places = find_grasps(handle, (), ROBOTS["panda"]).poses[:, :3, 3]
    assert len(places)
    np.testing.assert_allclose(places[:, 0], 0.0065, atol=1e-9)
    np.testing.assert_allclose(places[:, 2], -0.01, atol=1e-9)


@pytest.mark.parametrize("robot", ["panda", "fetch"])
def test_fingers_open_from_shut_to_wide(robot):
    spec = ROBOTS[robot]
    assert finger_action(spec, spec.opening) == 1.0
    widths = [finger_action(spec, width) for width in (0.0, 0.02, 0.05, spec.opening)]
    assert (np.diff(widths) > 0.0).all()
    assert widths[0] > -1.0


def test_hulls_follow_the_joint(cabinet):
    part = next(part for part in cabinet.parts if part.kind == "drawer")
    closed, others = hulls_at(cabinet, part, {})
    opened, still = hulls_at(cabinet, part, opened_qpos(cabinet, part, 1.0))
    assert len(closed)
    for a, b in zip(closed, opened, strict=True):
        np.testing.assert_allclose(b.vertices, a.vertices + part.span * part.joint.axis, atol=1e-9)
    for a, b in zip(others, still, strict=True):
        np.testing.assert_array_equal(a.vertices, b.vertices)
    slab = ground_under(cabinet, closed + others)
    assert slab.vertices[:, 2].max() == pytest.approx(cabinet.floor)


def test_a_leaf_that_would_meet_the_ground_opens_less(cabinet):
    part = next(part for part in cabinet.parts if part.joint.type == "revolute")
    assert open_above_ground(cabinet, part, 1.0) == 1.0
    moved = part.moved - [0.0, 0.0, part.moved[:, 2].min() - cabinet.floor]
    hinge = np.array([moved[:, 0].max(), 0.0, cabinet.floor])  # behind the leaf's face, at the ground
    joint = replace(part.joint, axis=np.array([0.0, -1.0, 0.0]), origin=hinge)
    opened = open_above_ground(cabinet, replace(part, joint=joint, moved=moved), 1.0)
    assert opened < 0.1


@pytest.mark.parametrize(("skip", "place", "chosen"), [(0, 11, 11), (0, 12, 0), (1, 12, 0), (1, 13, 1)])
def test_of_the_twelve_cheapest_ways_the_one_that_presses_least_is_taken(monkeypatch, skip, place, chosen):
    """All ways but one press by a metre, and of ``skip`` better ones as many more are compared."""
    monkeypatch.setattr(opening, "_pressure", lambda _, ways, *rest: ways[0, :, 0])
    ways = np.ones((1, 20, 1))
    ways[0, place] = 0.0
    best, pressed = opening.least_pressing(
        MagicMock(), ways, np.eye(4)[None], np.arange(20.0), np.arange(20), skip=skip
    )
    assert best == chosen
    assert pressed == ways[0, chosen, 0]
