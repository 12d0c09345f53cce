"""When a cube is inside, at rest and released, where it starts, and where it may lie."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from envs.maniskill.containers import Container

pytest.importorskip("mani_skill")
import torch
from mani_skill.utils.structs import Pose

import envs  # noqa: F401  registers the tasks
from envs.maniskill import put_inside
from envs.maniskill.objects import TaskError, TaskObject, TaskPart, read_object
from envs.maniskill.put_inside import PutInsideEnv, resting_places
from envs.maniskill.robots import ROBOTS

pytestmark = pytest.mark.sim
SETTINGS: dict[str, Any] = {"sim_backend": "physx_cpu", "render_backend": "none", "validation": "any"}


@pytest.fixture(scope="module", params=["panda", "fetch"])
def task(request: pytest.FixtureRequest, folder: Path) -> Any:
    """The task with a drawer and one of the robots; nothing in these tests moves by itself."""
    env = gym.make(
        "ArtiGen-PutInside-v1", packages=str(folder), part="drawer", obs_mode="state", reward_mode="dense",
        robot_uids=request.param, **SETTINGS,
    )  # fmt: skip
    env.reset(seed=0)
    yield env.unwrapped
    env.close()


def part_of(folder: Path, kind: str) -> tuple[TaskObject, TaskPart]:
    entry = read_object(folder, "any")
    return entry, next(part for part in entry.parts if part.kind == kind)


def put(task: Any, p: torch.Tensor, speed: float = 0.0) -> dict[str, torch.Tensor]:
    """What the task makes of a cube at a place, with a speed along x."""
    task.cube.set_pose(Pose.create_from_pq(p.reshape(1, 3)))
    task.cube.set_linear_velocity(torch.tensor([[speed, 0.0, 0.0]]))
    return task.evaluate()


@pytest.mark.parametrize(("beyond", "inside"), [(0.0098, True), (0.0102, False)])
@pytest.mark.parametrize("side", [0, 1])
def test_a_cube_is_inside_up_to_a_centimetre_beyond_the_region(task, beyond, inside, side):
    entry, part = task.drawn[0]
    region = task.containers[0].region + part.span * part.joint.axis - [0.0, 0.0, entry.floor]
    for axis in range(3):
        at = region.mean(axis=0)
        at[axis] = region[side, axis] + (beyond if side else -beyond)
        assert bool(put(task, torch.tensor(at).float())["inside"][0]) == inside


@pytest.mark.parametrize(("speed", "still"), [(0.0199, True), (0.0201, False)])
def test_a_cube_is_still_below_two_centimetres_a_second(task, speed, still):
    assert bool(put(task, task.aims[0], speed)["cube_still"][0]) == still


@pytest.mark.parametrize(("away", "released"), [(0.0601, True), (0.0599, False)])
def test_a_cube_is_released_six_centimetres_away_from_the_gripper(task, away, released):
    at = task.agent.tcp.pose.p[0] + torch.tensor([0.0, 0.0, away])
    assert bool(put(task, at)["released"][0]) == released


def test_a_cube_inside_lies_still_for_ten_steps(task):
    put(task, task.aims[0], speed=1.0)
    task._after_control_step()
    put(task, task.aims[0])
    for _ in range(9):
        task._after_control_step()
    assert not task.evaluate()["success"]
    task._after_control_step()
    assert task.evaluate()["success"]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_everything_starts_within_its_noise(task, monkeypatch, sign):
    """2 cm and a twentieth of a radian around the stand, a fiftieth at each joint of the arm; the cube 2 cm
    and half a quarter turn."""

    class Extreme:
        def __getitem__(self, _):
            return SimpleNamespace(uniform=lambda low, high, size: np.full((1, size), sign * high))

    spec, stand = task.robot_spec, task.stands[0]
    monkeypatch.setattr(task, "_batched_episode_rng", Extreme())
    task._initialize_episode(torch.tensor([0]), {})
    names = [joint.name for joint in task.agent.robot.active_joints]
    qpos = task.agent.robot.get_qpos()[0].numpy()
    arm = qpos[[names.index(name) for name in spec.arm]]
    np.testing.assert_allclose(arm, spec.ready + sign * 0.02, atol=1e-5)
    pose = task.agent.robot.pose
    base = [*pose.p[0, :2].tolist(), 2.0 * float(torch.atan2(pose.q[0, 3], pose.q[0, 0]))]
    base = qpos[:3] if spec.name == "fetch" else np.array(base)
    turned = (base[2] - stand.yaw + np.pi) % (2.0 * np.pi) - np.pi
    np.testing.assert_allclose(
        [*(base[:2] - [stand.x, stand.y]), turned], sign * np.array([0.02, 0.02, 0.05]), atol=1e-4
    )
    cube, spot = task.cube.pose, task._spots[0].numpy()
    np.testing.assert_allclose(cube.p[0].numpy() - spot, sign * np.array([0.02, 0.02, 0.0]) + [0, 0, 0.02],
                               atol=1e-5)  # fmt: skip
    turn = 2.0 * float(torch.atan2(cube.q[0, 3], cube.q[0, 0]))
    assert turn == pytest.approx(sign * np.pi / 4.0, abs=1e-4)
    under = task.cube_stand.pose.p[0].numpy()
    np.testing.assert_allclose(under + np.array([0.0, 0.0, 1.02]), cube.p[0].numpy(), atol=1e-5)


def test_the_cube_stands_beside_the_robot(task):
    angle, distance, height = {"panda": (100.0, 0.45, 0.42), "fetch": (75.0, 0.65, 0.50)}[
        task.robot_spec.name
    ]
    stand, spot = task.stands[0], task._spots[0].numpy()
    away = spot[:2] - [stand.x, stand.y]
    turn = np.arctan2(away[1], away[0]) - stand.yaw
    assert np.linalg.norm(away) == pytest.approx(distance, abs=1e-5)
    assert np.cos(turn) == pytest.approx(np.cos(np.radians(angle)), abs=1e-5)
    assert spot[2] - stand.z - stand.lift == pytest.approx(height, abs=1e-5)


@pytest.mark.parametrize("better", [0, 1])
def test_the_cube_stands_on_the_side_with_more_room_to_ten_centimetres_above_it(task, monkeypatch, better):
    heights, sides = [], []

    def free_radius(entry, part, spots, column, fractions):
        heights.append(column)
        sides.append(spots)
        return np.eye(2)[better]

    monkeypatch.setattr(put_inside, "free_radius", free_radius)
    spot = task._cube_spot(*task.drawn[0], task.stands[0])
    assert heights[0] == pytest.approx({"panda": 0.52, "fetch": 0.6}[task.robot_spec.name])
    np.testing.assert_allclose(spot[:2], sides[0][better, :2])


def test_a_cube_weighs_32_grams_on_a_column_of_5_centimetres_and_all_have_a_friction_of_one(task):
    assert float(task.cube.mass[0]) == pytest.approx(500.0 * 0.04**3)
    box = task.cube_stand._bodies[0].collision_shapes[0]
    np.testing.assert_allclose(box.half_size, [0.025, 0.025, 1.0])
    shapes = [x for link in task.built[0]._objs[0].links for x in link.collision_shapes]
    for shape in (*shapes, *task.cube._bodies[0].collision_shapes):
        material = shape.physical_material
        assert (material.static_friction, material.dynamic_friction, material.restitution) == (1.0, 1.0, 0.0)


def test_the_reward_is_that_of_reaching_of_bringing_and_of_being_inside(task):
    tcp, aim = task.agent.tcp.pose.p[0], task.aims[0]
    for at in (tcp + torch.tensor([0.1, 0.0, 0.0]), aim + torch.tensor([0.01, 0.0, 0.0])):
        info = put(task, at)
        inside, off = float(info["inside"][0]), float(torch.linalg.norm(aim - at))
        reach = 1.0 if inside else 1.0 - np.tanh(5.0 * float(torch.linalg.norm(tcp - at)))
        expected = reach + 2.0 * (1.0 - np.tanh(3.0 * off)) + inside
        assert float(task.compute_dense_reward(None, None, info)[0]) == pytest.approx(expected, abs=1e-4)
        info["success"] = torch.tensor([True])
        assert float(task.compute_dense_reward(None, None, info)[0]) == 6.0


@pytest.mark.parametrize("size", [0.0099, 0.0601])
def test_a_cube_fits_into_the_grippers(size, tmp_path):
    with pytest.raises(ValueError, match=r"expected 0\.01 to 0\.06"):
        PutInsideEnv(packages=tmp_path, cube_size=size)
    with pytest.raises(TaskError):  # the empty folder is what is wrong
        PutInsideEnv(packages=tmp_path, cube_size=float(np.clip(size, 0.0101, 0.0599)))


@pytest.mark.parametrize(
    ("part", "heights", "path"),
    [("drawer", (0.04, 0.10, 0.15), (0.05, None)), ("door", (0.04,), (0.05, 0.15))],
)
def test_arms_need_room_over_a_floor(folder, monkeypatch, part, heights, path):
    """If there is none, a place in reach of a path from 5 cm above it to 10 cm above a drawer is taken."""
    asked: list[Any] = []

    def no_stand(*_, goal, **__):
        asked.append(goal.places)

    def stand(entry, part, robot, fractions, path, reach):
        asked.append(path)
        raise StopIteration

    monkeypatch.setattr(put_inside, "find_putting_stand", no_stand)
    monkeypatch.setattr(put_inside, "find_stand", stand)
    monkeypatch.setattr(put_inside, "sample_postures", lambda *_: None)
    env = PutInsideEnv.__new__(PutInsideEnv)
    entry = part_of(folder, part)
    env.initial_open, env.cube_size, env.robot_spec = 1.0, 0.04, ROBOTS["panda"]
    env._known_fields = {}
    env.__dict__["_postures"] = None
    with pytest.raises(StopIteration):
        env._look_for_stand(*entry)
    container = env.container_of(*entry)
    assert container is not None
    places = resting_places(*entry, container, 1.0)
    hands, way = asked
    expected = np.concatenate([places + np.array([0.0, 0.0, height]) for height in heights])
    np.testing.assert_allclose(hands, expected)
    top = path[1] or float(np.ptp(container.region[:, 2])) + 0.1
    np.testing.assert_allclose(way - places[0], [[0.0, 0.0, 0.05], [0.0, 0.0, top]], atol=1e-9)


def test_a_cube_may_lie_nearer_to_the_front_or_to_the_sides(folder):
    """By 4 and 7 tenths of the way to the front, and half of the way to each side."""
    entry, part = part_of(folder, "door")
    low, high = np.array([-0.1, -0.2, 0.1]), np.array([0.1, 0.2, 0.3])
    container = Container(
        link=part.joint.parent, region=np.stack([low, high]), aim=np.array([0.0, 0.0, 0.1]),
        inwards=np.array([1.0, 0.0, 0.0]), down=False,
    )  # fmt: skip
    places = resting_places(entry, part, container, 1.0) - [0.0, 0.0, 0.1 - entry.floor]
    ways = [(0.0, 0.0), (-0.04, 0.0), (-0.07, 0.0), (0.0, 0.1), (0.0, -0.1)]
    ways += [(x, y) for x in (-0.04, -0.07) for y in (0.1, -0.1)]
    np.testing.assert_allclose(places, [[x, y, 0.0] for x, y in ways], atol=1e-9)
