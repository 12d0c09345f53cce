"""examples/train_policy.py: what the policy sees does not depend on the world's heading, and it learns."""

import importlib.util

import numpy as np
import pytest
import torch
from project import ROOT
from scipy.spatial.transform import Rotation

from artigen.datasets.lerobot import Episode, write_lerobot

pytest.importorskip("pyarrow")
SPEC = importlib.util.spec_from_file_location("train_policy", ROOT / "examples" / "train_policy.py")
policy = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(policy)


def state(rng: np.random.Generator, count: int, turn: Rotation) -> tuple[np.ndarray, ...]:
    """Random states of a hand, in a world that is turned."""
    pose = Rotation.random(count, random_state=rng)
    places, ways, pulls = rng.normal(size=(3, count, 3))
    quats = (turn * pose).as_quat(scalar_first=True)
    tcp = np.concatenate([turn.apply(places), quats], axis=1)
    return rng.normal(size=(count, 9)), tcp, turn.apply(ways), turn.apply(pulls), rng.uniform(size=(count, 1))


def test_only_gravity_gives_the_world_a_direction():
    straight, turned, tilted = (
        policy.see(*state(np.random.default_rng(0), 20, Rotation.from_euler(axis, angle)))
        for axis, angle in (("z", 0.0), ("z", 1.3), ("x", 1.3))
    )
    np.testing.assert_allclose(turned, straight, atol=1e-5)
    assert np.abs(tilted - straight).max() > 0.1


@pytest.mark.slow
def test_it_learns_what_is_always_done(tmp_path):
    rng, step = np.random.default_rng(0), np.linspace(-0.2, 0.2, 7)
    names = {"tcp_pose": 7, "open_fraction": 1, "grip_position": 3, "tcp_to_grip": 3, "pull_direction": 3}

    def episode() -> Episode:
        qpos, tcp, way, pull, opened = state(rng, 30, Rotation.identity())
        qpos = np.repeat(qpos[:1], 30, axis=0)
        seen = np.concatenate([tcp, opened, tcp[:, :3] + way, way, pull], axis=1)
        action = np.concatenate([qpos[:, :7] + step, np.full((30, 1), -1.0)], axis=1)
        arrays = {"observation.state": qpos, "observation.environment_state": seen, "action": action}
        return Episode(task="pull", arrays=arrays, pictures={}, about={})

    told = {"observation.environment_state": [f"{name}_{k}" for name, n in names.items() for k in range(n)]}
    told["observation.state"] = [f"joint_{k}" for k in range(9)]
    write_lerobot((episode() for _ in range(8)), tmp_path / "data", fps=20, robot="panda", names=told)
    torch.manual_seed(0)
    model = policy.train(tmp_path / "data", 0.05, None)
    seen, *_ = policy.load(tmp_path / "data")
    drawn = model.draw(seen[:50])
    wanted = torch.tensor([*step, -1.0]).expand_as(drawn)
    assert (drawn - wanted).abs().mean() < 0.02
