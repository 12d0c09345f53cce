"""When a part counts as open, closed and still, and what a step towards that is worth."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from sample_packages import SAMPLE_PARTS, build_package

from sim_export.files.write import write_package

pytest.importorskip("mani_skill")
import torch

import envs  # noqa: F401  registers the tasks

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def make(tmp_path_factory: pytest.TempPathFactory):
    folder: Path = write_package(build_package(SAMPLE_PARTS), tmp_path_factory.mktemp("open") / "cabinet")
    made: dict[tuple[str, str], Any] = {}

    def task(part: str, goal: str) -> Any:
        if (part, goal) not in made:
            env = gym.make(
                "ArtiGen-OpenPart-v1", packages=str(folder), part=part, goal=goal, obs_mode="state",
                reward_mode="dense", sim_backend="physx_cpu", render_backend="none", validation="any",
            )  # fmt: skip
            env.reset(seed=0)
            made[part, goal] = env.unwrapped
        return made[part, goal]

    yield task
    for task_made in made.values():
        task_made.close()


def put(task: Any, fraction: float, speed: float = 0.0) -> dict[str, torch.Tensor]:
    """What the task makes of a part at a fraction of its range, at a speed."""
    qpos = task.object.get_qpos().clone()
    qpos[task._rows, task._columns] = task._lower + fraction * task._span
    qvel = torch.zeros_like(qpos)
    qvel[task._rows, task._columns] = speed
    task.object.set_qpos(qpos)
    task.object.set_qvel(qvel)
    return task.evaluate()


@pytest.mark.parametrize(("part", "most"), [("drawer", 0.1), ("door", 1.0)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_part_is_still_below_ten_centimetres_or_a_radian_a_second(make, part, most, sign):
    for share, still in ((0.99, True), (1.01, False)):
        info = put(make(part, "open"), 0.9, sign * share * most)
        assert bool(info["part_still"][0]) == bool(info["success"][0]) == still


@pytest.mark.parametrize(
    ("goal", "begin", "done", "missed"), [("open", 0.0, 0.7501, 0.7499), ("close", 0.75, 0.0499, 0.0501)]
)
def test_a_part_is_open_at_three_quarters_and_closed_at_a_twentieth(make, goal, begin, done, missed):
    task = make("drawer", goal)
    assert task._starts[0, task._columns[0]] == pytest.approx(begin * float(task._span[0]), abs=1e-6)
    assert put(task, done)["success"]
    assert not put(task, missed)["success"]


def test_the_reward_is_that_of_reaching_and_of_progress(make):
    task = make("drawer", "open")
    info = put(task, 0.5)
    off = float(torch.linalg.norm(task.agent.tcp.pose.p - info["grip_position"]))
    expected = 1.0 - np.tanh(5.0 * off) + 3.0 * 0.5 / 0.75
    assert float(task.compute_dense_reward(None, None, info)[0]) == pytest.approx(expected, abs=1e-5)
    info["grip_position"] = task.agent.tcp.pose.p + torch.tensor([[0.1, 0.0, 0.0]])
    expected = 1.0 - np.tanh(0.5) + 3.0 * 0.5 / 0.75
    assert float(task.compute_dense_reward(None, None, info)[0]) == pytest.approx(expected, abs=1e-5)
    assert float(task.compute_dense_reward(None, None, put(task, 0.9))[0]) == 5.0
