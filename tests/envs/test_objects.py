"""Several objects in one environment: equal spaces, a choice by name, an evaluation, a split."""

from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from sample_packages import SAMPLE_PARTS, build_package

from artigen.errors import ArtigenError
from sim_export.files.folders import name_folders, pick_folder
from sim_export.files.write import write_package

pytest.importorskip("mani_skill")
from mani_skill.utils.wrappers.gymnasium import CPUGymWrapper

import envs
from envs.actuate import ActuateConfig
from envs.evaluate import evaluate
from envs.split import split_objects

pytestmark = pytest.mark.sim
DRAWERS = [part for part in SAMPLE_PARTS if part.name not in ("door", "door_handle", "lock")]
TASK = {"sim_backend": "physx_cpu", "render_backend": "none", "validation": "any", "obs_mode": "state"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Two objects: ``large`` has more joints than ``small``."""
    top = tmp_path_factory.mktemp("objects")
    write_package(build_package(SAMPLE_PARTS), top / "large")
    write_package(build_package(DRAWERS), top / "small")
    return top


@pytest.mark.parametrize("name", envs.ENVIRONMENT_IDS)
def test_objects_with_different_joints_share_a_vector_environment(folder, name):
    vector = gym.make_vec(f"envs:{name}", num_envs=4, vectorization_mode="sync", package=str(folder))
    seen = set()
    for seed in range(3):
        observation, info = vector.reset(seed=10 * seed)
        seen |= set(info["object"])
        assert observation["open_fraction"].shape == (4, 4)
        small = info["object"] == "small"
        assert not observation["open_fraction"][small, 2:].any()
    observation, reward, *_ = vector.step(vector.action_space.sample())
    assert reward.shape == (4,)
    assert seen == {"large", "small"}


def test_a_padded_object_moves_as_it_does_alone(folder):
    alone = gym.make(
        "envs:ArtiGen/Actuate-v0", package=str(folder / "small"), cfg=ActuateConfig(joint="joint_0")
    )
    padded = gym.make("envs:ArtiGen/Actuate-v0", package=str(folder), cfg=ActuateConfig(joint="joint_0"))
    a, _ = alone.reset(seed=0)
    b, info = padded.reset(seed=5, options={"object": "small"})
    assert info["object"] == "small"
    for _ in range(10):
        for key, values in a.items():
            np.testing.assert_array_equal(b[key][: len(values)], values)
        a, b = (env.step(np.ones(1, np.float32))[0] for env in (alone, padded))


def test_maniskill_tasks_in_a_vector_environment_have_no_axis_of_scenes(folder):
    vector = gym.make_vec(
        "envs:ArtiGen-OpenPart-v1", num_envs=2, vectorization_mode="sync", wrappers=[CPUGymWrapper],
        packages=str(folder), part="drawer", **TASK,
    )  # fmt: skip
    observation, info = vector.reset(seed=0)
    assert observation.shape == vector.observation_space.shape == (2, observation.shape[-1])
    assert set(info["object"]) <= {"large", "small"}


def test_every_object_is_played_once_and_what_a_policy_does_counts(folder):
    env = gym.make("envs:ArtiGen/Actuate-v0", package=str(folder), cfg=ActuateConfig(joint="joint_0"))
    pulls = evaluate(env, lambda _: np.ones(1, np.float32), repeats=2)
    assert [(trial.object, trial.seed) for trial in pulls] == [
        ("large", 0), ("large", 1), ("small", 0), ("small", 1),
    ]  # fmt: skip
    assert all(trial.success and trial.reward >= 0.9 and trial.steps < 100 for trial in pulls)
    rests = evaluate(env, lambda _: np.zeros(1, np.float32))
    assert [(trial.success, trial.steps) for trial in rests] == [(False, 100)] * 2
    task = gym.make("ArtiGen-OpenPart-v1", packages=str(folder), part="drawer", **TASK)
    still = evaluate(gym.wrappers.TimeLimit(task, 3), lambda _: task.action_space.sample() * 0)
    assert [(trial.object, trial.success, trial.steps) for trial in still] == [
        ("large", False, 3), ("small", False, 3),
    ]  # fmt: skip


def test_a_task_takes_the_object_that_is_asked_for(folder):
    env = gym.make("ArtiGen-OpenPart-v1", packages=str(folder), part="drawer", **TASK)
    for seed in range(3):
        for name in ("small", "large"):
            assert env.reset(seed=seed, options={"object": name})[1]["object"] == [name]
            assert env.step(env.action_space.sample())[4]["object"] == [name]
    with pytest.raises(ArtigenError, match=r"object 'huge': 0 of 2 have that name.*large"):
        env.reset(seed=0, options={"object": "huge"})


def test_objects_of_one_name_are_told_apart_by_the_folders_above(tmp_path):
    folders = [tmp_path / "a" / "oven", tmp_path / "b" / "oven", tmp_path / "b" / "sink"]
    names = name_folders(folders)
    assert names == ("a/oven", "b/oven", "sink")
    assert [pick_folder(folders, name) for name in names] == folders
    with pytest.raises(ArtigenError, match="2 of 3 have that name"):
        pick_folder(folders, "oven")


def test_a_split_is_disjoint_complete_and_independent_of_order(tmp_path):
    for number in range(10):
        (tmp_path / str(number)).mkdir()
        (tmp_path / str(number) / "mobility.urdf").touch()
    folders = [tmp_path / str(number) for number in range(10)]
    split = split_objects(tmp_path, 0.3)
    assert len(split.unseen) == 3
    assert sorted((*split.train, *split.unseen)) == folders
    assert set(split_objects(folders[::-1], 0.3).unseen) == set(split.unseen)
    assert set(split_objects(tmp_path, 0.3, seed=1).unseen) != set(split.unseen)
    with pytest.raises(ArtigenError, match=r"0.01 of 10 objects is 0"):
        split_objects(tmp_path, 0.01)
