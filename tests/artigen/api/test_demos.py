"""Demonstrations: recorded once, written in both formats, and repeated by their actions alone."""

import json
from dataclasses import replace

import numpy as np
import pytest
from sample_packages import SAMPLE_PARTS, build_package

from artigen.api import demos
from artigen.api.demos import DemoSettings, make_demos, replay_demos
from artigen.errors import ArtigenError
from artigen.runtime.runner import choose_runner
from envs.split import split_objects
from sim_export.files.write import write_package

h5py = pytest.importorskip("h5py")
parquet = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("mani_skill")
pytest.importorskip("pandas")
pytestmark = [pytest.mark.sim, pytest.mark.slow]
TASK = "ArtiGen-OpenPart-v1"
CFG = DemoSettings(part="drawer", pictures="none", validation="any")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Two episodes, one of each of two equal cabinets."""
    top = tmp_path_factory.mktemp("demos")
    for name in ("first", "second"):
        write_package(build_package(SAMPLE_PARTS), top / "packages" / name)
    make_demos(TASK, top / "packages", 2, top / "out", runner=choose_runner("local", 0), cfg=CFG)
    return top


def test_actions_alone_repeat_the_episodes_and_others_do_not(made, monkeypatch):
    assert [each.object for each in replay_demos(made / "out" / "lerobot", made / "packages")] == [
        "first", "second",
    ]  # fmt: skip
    assert all(each.success for each in replay_demos(made / "out" / "lerobot"))
    still = np.stack
    monkeypatch.setattr(demos.np, "stack", lambda rows: np.repeat(still(rows)[:1], len(rows), axis=0))
    assert not any(each.success for each in replay_demos(made / "out" / "lerobot", count=1))


def test_unseen_objects_are_left_out(made):
    (unseen,) = split_objects(made / "packages", 0.5).unseen
    cfg = replace(CFG, unseen=0.5)
    make_demos(TASK, made / "packages", 2, made / "half", runner=choose_runner("local", 0), cfg=cfg)
    table = parquet.read_table(made / "half" / "lerobot" / "meta" / "episodes", columns=["object"])
    assert table.to_pydict()["object"] == [name for name in ("first", "second") if name != unseen.name] * 2


def test_one_package_is_enough(made):
    only = made / "packages" / "second"
    make_demos(TASK, only, 1, made / "one", runner=choose_runner("local", 0), cfg=CFG)
    assert [each.object for each in replay_demos(made / "one" / "lerobot")] == ["second"]


def test_another_format_is_written_from_the_same_recordings(made, monkeypatch):
    monkeypatch.setattr(demos, "_play", None)  # nothing is played again
    make_demos(
        TASK, made / "packages", 2, made / "out", runner=choose_runner("local", 0), cfg=CFG,
        format="maniskill",
    )  # fmt: skip
    said = json.loads((made / "out" / "maniskill" / "demonstrations.json").read_text())
    assert said["env_info"]["env_id"] == f"envs:{TASK}"  # what mani_skill.trajectory.replay_trajectory makes
    assert [episode["object"] for episode in said["episodes"]] == ["first", "second"]
    assert all(episode["task"] == "open the drawer of the cabinet" for episode in said["episodes"])
    frames = parquet.read_table(made / "out" / "lerobot" / "data").to_pydict()
    with h5py.File(made / "out" / "maniskill" / "demonstrations.h5") as file:
        actions = np.concatenate([file[f"traj_{k}/actions"] for k in range(2)])
    np.testing.assert_array_equal(np.stack(frames["action"]), actions)


def test_what_cannot_be_demonstrated_is_said(made):
    with pytest.raises(ArtigenError, match=r"'ArtiGen-Room-v1' has no solver, expected one of ArtiGen-Open"):
        make_demos("ArtiGen-Room-v1", made, 1, made, runner=choose_runner("local", 0))
    stuck = DemoSettings(part="tray", pictures="none", validation="any")
    with pytest.raises(ArtigenError, match="none has a tray"):
        make_demos(TASK, made / "packages", 1, made / "no", runner=choose_runner("local", 0), cfg=stuck)
