"""A package that version 0.1 wrote (21 November 2026) is read, checked, stepped and written by this one."""

import tarfile
from pathlib import Path

import numpy as np
import pytest

import artigen
from envs.sim.load import load

ARCHIVE = Path(__file__).parents[1] / "data/microwave_0_1.tar.xz"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("old")
    with tarfile.open(ARCHIVE) as archive:
        archive.extractall(root, filter="data")
    return root / "Microwave_3"


def test_it_passes_every_check(folder: Path):
    old = artigen.load(folder)
    assert "0.1.0" in (folder / "provenance.json").read_text()
    assert old.validate().passed


@pytest.mark.parametrize("engine", ["sapien", "mujoco"])
def test_its_door_opens(folder: Path, engine: str):
    microwave = load(folder, engine)
    microwave.reset({"joint_0": 0.5})
    for _ in range(300):
        microwave.step({"joint_0": 2.0})
    assert microwave.positions()["joint_0"] > 0.8


def test_written_anew_it_is_the_same_object(folder: Path, tmp_path: Path):
    old = artigen.load(folder)
    old.export(tmp_path / "new")
    new = artigen.load(tmp_path / "new")
    assert new.joints == old.joints
    assert new.mass == pytest.approx(old.mass)
    pose = dict.fromkeys(old.joints, 0.5)
    for part, moved in old.at(pose).items():
        np.testing.assert_allclose(new.at(pose)[part], moved, atol=1e-9)
