"""LeRobot data sets: rows, statistics, and what the library itself reads, where it is installed."""

import importlib.util
import json
import os
import subprocess
import sys

import numpy as np
import pytest

from artigen.datasets.lerobot import Episode, write_lerobot
from artigen.errors import ArtigenError

parquet = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("pandas")
CAMERA = "observation.images.front"
LOAD = """
import json, sys
from lerobot.datasets.compute_stats import aggregate_stats, compute_episode_stats
from lerobot.datasets.lerobot_dataset import LeRobotDataset
data = LeRobotDataset("artigen/test", root=sys.argv[1], delta_timestamps={"action": [0.0, 0.1]})
item = data[4]
keys = ["action", "observation.state"]
flat = {key: [row.numpy() for row in data.hf_dataset[key]] for key in keys}
import numpy as np
own = compute_episode_stats({key: np.stack(rows) for key, rows in flat.items()}, data.features)
print(json.dumps({
    "episodes": data.num_episodes, "frames": len(data), "task": item["task"],
    "actions": item["action"].tolist(), "pad": item["action_is_pad"].tolist(),
    "picture": (item["observation.images.front"] * 255).round().int().tolist(),
    "object": data.meta.episodes[1]["object"],
    "std": {key: own[key]["std"].tolist() for key in keys},
}))
"""


def find_lerobot() -> str | None:
    """A Python that has LeRobot: this one, or that of LEROBOT_PYTHON."""
    return os.environ.get("LEROBOT_PYTHON") or (
        sys.executable if importlib.util.find_spec("lerobot") is not None else None
    )


def draw_episode(seed: int, steps: int, task: str) -> Episode:
    rng = np.random.default_rng(seed)
    return Episode(
        task=task,
        arrays={
            "observation.state": rng.normal(size=(steps, 4)).astype(np.float32),
            "action": rng.normal(size=(steps, 2)).astype(np.float32),
            "next.success": np.arange(steps) == steps - 1,
        },
        pictures={CAMERA: rng.integers(256, size=(steps, 6, 8, 3), dtype=np.uint8)},
        about={"object": f"Oven_{seed}", "seed": seed},
    )


EPISODES = [draw_episode(0, 3, "open the oven"), draw_episode(1, 5, "close the oven")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("lerobot") / "data"
    frames = write_lerobot(iter(EPISODES), out, fps=10, robot="panda", names={"action": ("arm", "hand")})
    assert frames == 8
    return out


def test_rows_are_those_of_the_episodes(folder):
    table = parquet.read_table(folder / "data").to_pydict()
    for key in EPISODES[0].arrays:
        both = np.concatenate([episode.arrays[key] for episode in EPISODES])
        np.testing.assert_array_equal(np.array(table[key], dtype=both.dtype), both)
    assert table["index"] == list(range(8))
    assert table["frame_index"] == [0, 1, 2, 0, 1, 2, 3, 4]
    rows = parquet.read_table(folder / "meta" / "episodes").to_pylist()
    assert [(row["dataset_from_index"], row["dataset_to_index"], row["object"]) for row in rows] == [
        (0, 3, "Oven_0"), (3, 8, "Oven_1"),
    ]  # fmt: skip


def test_statistics_are_those_of_all_frames_together(folder):
    stats = json.loads((folder / "meta" / "stats.json").read_text())
    both = np.concatenate([episode.arrays["action"] for episode in EPISODES]).astype(np.float64)
    for name in ("min", "max", "mean", "std"):
        np.testing.assert_allclose(stats["action"][name], getattr(both, name)(axis=0), rtol=1e-9)
    pictures = np.concatenate([episode.pictures[CAMERA] for episode in EPISODES]) / 255.0
    np.testing.assert_allclose(np.ravel(stats[CAMERA]["std"]), pictures.std(axis=(0, 1, 2)), rtol=1e-9)


def test_an_episode_of_another_shape_is_refused_and_leaves_what_was_there(folder, tmp_path):
    short = Episode(task="", arrays=EPISODES[0].arrays, pictures={}, about={})
    with pytest.raises(ArtigenError, match=r"episode 1 .*float32\[4\].*first one"):
        write_lerobot([EPISODES[0], short], folder, fps=10, robot="panda", names={})
    assert len(parquet.read_table(folder / "data")) == 8
    with pytest.raises(ArtigenError, match="no episode"):
        write_lerobot([], tmp_path / "none", fps=10, robot="panda", names={})
    assert not (tmp_path / "none").exists()


def test_lerobot_reads_it(folder):
    python = find_lerobot()
    if python is None:
        pytest.skip("no lerobot here, and no LEROBOT_PYTHON that names a Python with it")
    quiet = os.environ | {"HF_HUB_OFFLINE": "1"}
    done = subprocess.run([python, "-c", LOAD, str(folder)], capture_output=True, text=True, env=quiet)
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout.splitlines()[-1])
    assert (found["episodes"], found["frames"], found["object"]) == (2, 8, "Oven_1")
    assert found["task"] == "close the oven"
    actions = EPISODES[1].arrays["action"]
    np.testing.assert_allclose(found["actions"], actions[1:3], rtol=1e-6)
    assert found["pad"] == [False, False]
    picture = np.array(found["picture"]).transpose(1, 2, 0)
    np.testing.assert_array_equal(picture, EPISODES[1].pictures[CAMERA][1])
    stats = json.loads((folder / "meta" / "stats.json").read_text())
    for key, deviation in found["std"].items():
        np.testing.assert_allclose(stats[key]["std"], deviation, rtol=1e-4)
