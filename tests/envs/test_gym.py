"""The gymnasium environments: they keep gymnasium's rules, repeat, and mean what their docstrings say."""

import warnings
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

pytest.importorskip("sapien")
from envs import ENVIRONMENT_IDS
from envs.actuate import ActuateConfig
from envs.joint_sweep import JointSweepConfig
from envs.settle import SettleConfig
from envs.sim.scene import NoRenderDevice, has_render_device

pytestmark = pytest.mark.sim


def make(name: str, folder: Path, **kwargs) -> gym.Env:
    return gym.make(f"envs:ArtiGen/{name}-v0", package=str(folder), **kwargs)


def play(env: gym.Env, action: np.ndarray, steps: int = 200):
    """Repeats one action to the end of the episode; returns the return, the last info and the steps."""
    total, info = 0.0, {}
    for step in range(steps):
        _, reward, terminated, truncated, info = env.step(action)
        total += float(reward)
        if terminated or truncated:
            return total, info, step + 1
    return total, info, steps


@pytest.mark.parametrize("name", ENVIRONMENT_IDS)
def test_gymnasium_accepts_it(folder, name):
    env = gym.make(f"envs:{name}", package=folder)
    assert env.spec is not None
    assert env.spec.max_episode_steps in (100, 200)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*(infinity|not have a symmetric).*")
        check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("name", ENVIRONMENT_IDS)
def test_equal_seeds_stay_in_lock_step(folder, name):
    first, second = (gym.make(f"envs:{name}", package=folder) for _ in range(2))
    second.reset(seed=1)
    second.step(second.action_space.sample())  # history that must not matter
    first.action_space.seed(3)
    a, b = first.reset(seed=7), second.reset(seed=7)
    for _ in range(25):
        np.testing.assert_equal(a, b)
        action = first.action_space.sample()
        a, b = first.step(action), second.step(action)
        if a[2]:
            break


def test_a_pull_opens_and_a_rest_does_not(folder):
    for joint in ("joint_0", "joint_1", "joint_2", "joint_3"):
        env = make("Actuate", folder, cfg=ActuateConfig(joint=joint))
        env.reset(seed=0)
        total, info, steps = play(env, np.ones(1, dtype=np.float32))
        assert info["success"]
        assert info["joint"] == joint
        assert steps < 100
        assert total == pytest.approx(info["opened"], abs=1e-4)
        assert total >= 0.9
        env.reset(seed=0)
        total, info, steps = play(env, np.zeros(1, dtype=np.float32))
        assert (info["success"], steps) == (False, 100)
        assert abs(total) < 0.01


def test_the_handle_moves_along_the_opening_direction(folder):
    env = make("Actuate", folder, cfg=ActuateConfig(joint="joint_1"))
    before, _ = env.reset(seed=0)
    after, *_ = env.step(np.ones(1, dtype=np.float32))
    moved = after["handle_position"] - before["handle_position"]
    assert np.linalg.norm(moved) > 1e-4
    mean = before["opening_direction"] + after["opening_direction"]
    assert moved @ mean / np.linalg.norm(moved) / np.linalg.norm(mean) > 0.999


def test_the_handle_is_the_annotated_one(folder, package):
    env = make("Actuate", folder, cfg=ActuateConfig(joint="joint_0"))
    observation, _ = env.reset(seed=0)
    (handle,) = (handle for handle in package.handles if handle.link == "link_0")
    np.testing.assert_allclose(observation["handle_position"], handle.corners.mean(axis=0), atol=1e-5)
    np.testing.assert_allclose(observation["opening_direction"], handle.opening_direction, atol=1e-5)


def test_an_unknown_joint_is_named(folder):
    with pytest.raises(ValueError, match=r"no joint 'lid'; it has joint_0, joint_1, joint_2, joint_3"):
        make("Actuate", folder, cfg=ActuateConfig(joint="lid"))


def test_what_is_required_stands_open(folder):
    env = make("Actuate", folder, cfg=ActuateConfig(joint="joint_3"))
    observation, _ = env.reset(seed=0)
    np.testing.assert_allclose(observation["open_fraction"], [0.0, 1.0, 0.0, 0.0], atol=1e-5)


def sweep(env: gym.Env, order: list[int]):
    """Opens the joints fully, one after the other."""
    env.reset(seed=0)
    total, info = 0.0, {}
    for joint in order:
        for _ in range(10):
            action = np.zeros(len(order), dtype=np.float32)
            action[joint] = 1.0
            _, reward, done, _, info = env.step(action)
            total += float(reward)
            if done:
                return total, info
    return total, info


def test_a_sweep_in_the_right_order_is_perfect(folder):
    env = make("JointSweep", folder, cfg=JointSweepConfig(step=0.1))
    total, info = sweep(env, [1, 3, 0, 2])
    assert info == {"object": "cabinet", "success": True, "covered": 1.0}
    assert total == pytest.approx(1.0)


def test_a_tray_through_a_closed_door_is_no_success(folder):
    env = make("JointSweep", folder)
    total, info = sweep(env, [3, 1, 0, 2])
    assert not info["success"]
    assert info["covered"] == 1.0
    assert total < 0.0


def test_left_alone_it_settles(folder):
    env = make("Settle", folder)
    observation, _ = env.reset(seed=2)
    assert observation["height"][0] == pytest.approx(0.02, abs=1e-4)
    total, info, steps = play(env, np.zeros(3, dtype=np.float32))
    assert info["success"]
    assert total == 10.0
    assert steps < 100


def test_leaned_beyond_its_edge_it_falls(folder):
    env = make("Settle", folder, cfg=SettleConfig(lean_degrees=44.0))
    starts = {seed: env.reset(seed=seed)[1]["tilt_degrees"] for seed in range(30)}
    seed = max(starts, key=lambda seed: starts[seed])  # the cabinet's edges carry it up to 39 degrees
    assert 40.0 < starts[seed] < 45.0
    env.reset(seed=seed)
    total, info, steps = play(env, np.zeros(3, dtype=np.float32))
    assert (info["success"], total) == (False, 0.0)
    assert info["tilt_degrees"] > 45.0
    assert steps < 100


def test_a_push_moves_it(folder):
    env = make("Settle", folder, cfg=SettleConfig(push_ratio=0.6))
    env.reset(seed=0)
    observation, *_ = env.step(np.array([0.0, 1.0, 0.0], dtype=np.float32))
    assert observation["linear_velocity"][1] > 0.1
    assert abs(observation["linear_velocity"][0]) < 0.05


@pytest.mark.slow
def test_pictures_need_a_device_and_say_so(folder):
    if has_render_device():
        env = make("Actuate", folder, render_mode="rgb_array")
        env.reset(seed=0)
        picture = np.asarray(env.render())
        assert picture.shape == (256, 256, 3)
        assert np.ptp(picture) > 0
    else:
        with pytest.raises(NoRenderDevice, match="Vulkan"):
            make("Actuate", folder, render_mode="rgb_array")
