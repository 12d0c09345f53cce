"""The ManiSkill tasks: they reset and step, repeat, mean their success, and reward what leads to it."""

import json
from pathlib import Path
from typing import Any

import gymnasium as gym
import h5py
import numpy as np
import pytest
from sample_packages import SAMPLE_PARTS, build_package

from sim_export.files.write import write_package

pytest.importorskip("mani_skill")
import torch
from mani_skill.utils.structs import Pose

from envs.maniskill.checks import check_tasks
from envs.maniskill.objects import TaskError
from envs.maniskill.solver.record import record_episodes
from envs.maniskill.solver.solve import solve_open_part, solve_put_inside

pytestmark = pytest.mark.sim
CPU = {"sim_backend": "physx_cpu", "render_backend": "none", "validation": "any"}
OURS = ("ArtiGen-OpenPart-v1", "ArtiGen-PutInside-v1")
STOCK = ("ArtiGen-OpenCabinetDrawer-v1", "ArtiGen-OpenCabinetDoor-v1")


def make(name: str, folder: Path, **kwargs) -> gym.Env:
    settings: dict[str, Any] = CPU | {"obs_mode": "state"} | kwargs
    return gym.make(name, packages=str(folder), **settings)


def task_of(env: gym.Env) -> Any:
    """The task inside its wrappers, whose attributes gymnasium's types do not know."""
    return env.unwrapped


def set_open(env: gym.Env, fraction: float) -> dict:
    """Puts the part at a fraction of its range, at rest, and says what the task makes of it."""
    task = task_of(env)
    qpos = task.object.get_qpos().clone()
    qpos[task._rows, task._columns] = task._lower + fraction * task._span
    task.object.set_qpos(qpos)
    task.object.set_qvel(torch.zeros_like(qpos))
    return task.evaluate()


@pytest.mark.parametrize(("name", "robot"), [(OURS[0], "panda"), (OURS[0], "fetch"), (STOCK[0], "fetch")])
def test_a_robot_touches_every_link(folder, name, robot):
    """SAPIEN ignores contact of shapes that share a bit of group 2 and the number in group 3."""
    env = make(name, folder, robot_uids=robot)
    env.reset(seed=0)
    task = task_of(env)
    thing = task.cabinet if name in STOCK else task.object
    groups = [
        [shape.get_collision_groups() for link in x._objs[0].links for shape in link.collision_shapes]
        for x in (thing, task.agent.robot)
    ]
    assert all(groups)
    for mine in groups[0]:
        assert not any(mine[2] & its[2] and mine[3] & 0xFFFF == its[3] & 0xFFFF for its in groups[1])
    assert len({mine[3] for mine in groups[0]}) == 1
    env.close()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "robot"),
    [(name, robot) for name in OURS for robot in ("panda", "fetch")] + [(name, "fetch") for name in STOCK],
)
def test_resets_and_random_steps_stay_finite(folder, name, robot):
    env = make(name, folder, robot_uids=robot)
    env.action_space.seed(0)
    for seed in range(2):
        observation, _ = env.reset(seed=seed)
        assert torch.isfinite(observation).all()
        for _ in range(10):
            observation, reward, *_ = env.step(env.action_space.sample())
            assert torch.isfinite(observation).all()
            assert np.isfinite(float(reward))
    env.close()


@pytest.mark.slow
@pytest.mark.parametrize("name", OURS)
def test_equal_seeds_stay_in_lock_step(folder, name):
    first, second = make(name, folder), make(name, folder)
    second.reset(seed=5)
    second.step(second.action_space.sample())  # history that must not matter
    first.action_space.seed(3)
    a, b = first.reset(seed=7)[0], second.reset(seed=7)[0]
    for _ in range(25):
        torch.testing.assert_close(a, b, rtol=0.0, atol=1e-6)
        action = first.action_space.sample()
        a, b = first.step(action)[0], second.step(action)[0]
    assert not torch.equal(first.reset(seed=8)[0], first.reset(seed=9)[0])


def test_open_is_success_and_closed_is_not(folder):
    env = make("ArtiGen-OpenPart-v1", folder)
    env.reset(seed=0)
    assert not set_open(env, 0.0)["success"]
    assert not set_open(env, 0.74)["success"]
    assert set_open(env, 0.76)["success"]
    env = make("ArtiGen-OpenPart-v1", folder, goal="close")
    _, info = env.reset(seed=0)
    assert float(info["open_fraction"][0]) == pytest.approx(0.75, abs=1e-5)
    assert not info["success"]
    assert set_open(env, 0.04)["success"]


@pytest.mark.parametrize("goal", ["open", "close"])
def test_the_reward_grows_on_the_way(folder, goal):
    env = make("ArtiGen-OpenPart-v1", folder, goal=goal, reward_mode="dense")
    env.reset(seed=0)
    way = np.linspace(0.0, 0.7, 6) if goal == "open" else np.linspace(0.75, 0.1, 6)
    rewards = [float(task_of(env).get_reward({}, None, set_open(env, x))[0]) for x in way]
    # The gripper stands still, so its own share of the reward may shrink by a little as the part moves.
    assert (np.diff(rewards) > 0.2).all()
    best = set_open(env, 0.8 if goal == "open" else 0.0)
    assert float(task_of(env).get_reward({}, None, best)[0]) == 5.0


def test_the_sparse_reward_is_the_success(folder):
    env = make("ArtiGen-OpenPart-v1", folder, reward_mode="sparse")
    env.reset(seed=0)
    assert float(task_of(env).get_reward({}, None, set_open(env, 0.1))) == 0.0
    assert float(task_of(env).get_reward({}, None, set_open(env, 0.9))) == 1.0


def test_the_grip_is_the_annotated_handle(folder):
    env = make("ArtiGen-OpenPart-v1", folder, part="drawer")
    env.reset(seed=0)
    entry, part = task_of(env).drawn[0]
    expected = part.handle.corners.mean(axis=0) - [0.0, 0.0, entry.floor]
    np.testing.assert_allclose(task_of(env).grip_position[0].numpy(), expected, atol=1e-5)
    set_open(env, 1.0)
    moved = expected + part.joint.upper * part.joint.axis
    np.testing.assert_allclose(task_of(env).grip_position[0].numpy(), moved, atol=1e-5)


def test_friction_and_damping_are_the_packages(folder):
    env = make("ArtiGen-OpenPart-v1", folder, part="drawer")
    env.reset(seed=0)
    _, part = task_of(env).drawn[0]
    assert part.joint.friction > 0.0
    for joint in task_of(env).built[0]._objs[0].active_joints:
        if joint.name.endswith(part.joint.name):
            assert joint.force_limit == pytest.approx(part.joint.friction, rel=1e-5)


def test_a_cube_dropped_inside_is_success_and_beside_is_not(folder):
    env = make("ArtiGen-PutInside-v1", folder, part="drawer")
    for inside in (True, False):
        env.reset(seed=0)
        task = task_of(env)
        place = task.aims[0] + torch.tensor([0.0, 0.0, 0.03]) - (0.0 if inside else torch.tensor([0.5, 0, 0]))
        task.cube.set_pose(Pose.create_from_pq(place[None]))
        info: dict[str, Any] = {}
        for _ in range(30):
            _, _, terminated, _, info = env.step(None)
            if terminated:
                break
        assert bool(info["success"][0]) is inside
        assert bool(info["inside"][0]) is inside


def test_wrong_arguments_are_named(folder, tmp_path):
    with pytest.raises(ValueError, match="robot_uids 'ur5', expected one of fetch, panda"):
        make("ArtiGen-OpenPart-v1", folder, robot_uids="ur5")
    with pytest.raises(ValueError, match=r"initial_open is 1\.5, expected a fraction"):
        make("ArtiGen-PutInside-v1", folder, initial_open=1.5)
    with pytest.raises(ValueError, match="nothing is left to do"):
        make("ArtiGen-OpenPart-v1", folder, initial_open=0.9)
    with pytest.raises(TaskError, match="no mobility"):
        make("ArtiGen-OpenPart-v1", tmp_path)


def test_the_stock_task_succeeds_when_open(folder):
    env = make("ArtiGen-OpenCabinetDrawer-v1", folder, robot_uids="fetch")
    env.reset(seed=0)
    task = task_of(env)
    assert not task.evaluate()["success"]
    limits = task.cabinet.get_qlimits()
    task.cabinet.set_qpos(torch.nan_to_num(limits[..., 1], posinf=0.0))
    task.cabinet.set_qvel(torch.zeros_like(limits[..., 1]))
    assert task.evaluate()["success"]


def test_the_solver_opens_a_drawer_and_its_demonstration_is_kept(folder, tmp_path):
    env = make("ArtiGen-OpenPart-v1", folder, part="drawer", control_mode="pd_joint_pos")
    (outcome,) = record_episodes(env, solve_open_part, [0], tmp_path)
    assert outcome.success, outcome
    episode = json.loads((tmp_path / "demonstrations.json").read_text())["episodes"][0]
    assert (episode["episode_seed"], episode["success"]) == (0, True)
    with h5py.File(tmp_path / "demonstrations.h5") as file:
        actions = np.asarray(file["traj_0/actions"])
        assert bool(np.asarray(file["traj_0/success"])[-1])
    # The recorded actions alone, without the solver, do it again.
    env = make("ArtiGen-OpenPart-v1", folder, part="drawer", control_mode="pd_joint_pos")
    env.reset(seed=0)
    assert len(actions) == outcome.steps
    success = [bool(env.step(action)[4]["success"]) for action in actions]
    assert success[-1]
    assert not any(success[:-1])


@pytest.mark.slow
def test_the_solver_puts_a_cube_into_a_drawer(folder):
    env = make("ArtiGen-PutInside-v1", folder, part="drawer", control_mode="pd_joint_pos")
    outcome = solve_put_inside(env, 0)
    assert outcome.success, outcome


@pytest.mark.slow
def test_checks_l4_pass_on_a_good_package(tmp_path):
    parts = [part for part in SAMPLE_PARTS if part.name not in ("door", "door_handle", "lock")]
    folder = write_package(build_package(parts), tmp_path / "drawers")
    checks = {check.id: check for check in check_tasks(folder)}
    assert sorted(checks) == ["V401", "V402", "V404"]
    assert {check.verdict for check in checks.values()} == {"pass"}, checks
    assert all(check.level == "L4" for check in checks.values())
