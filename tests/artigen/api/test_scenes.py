"""Many scenes from one library: kept when run again, counted on a page, packed as they are."""

import json
import sys
import tarfile
from pathlib import Path

import pytest
from box_furniture import FURNITURE, write_proven

from artigen.api.batch import Part
from artigen.api.scene import furnish_room
from artigen.api.scenes import make_scenes
from artigen.datasets.packing import digest_file, read_folder, read_members
from artigen.errors import ArtigenError
from artigen.runtime.runner import LocalRunner, choose_runner
from artigen.types import SceneKind

KINDS: tuple[SceneKind, ...] = ("hall", "laundry")
HERE = LocalRunner(workers=0)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("library")
    for kind in FURNITURE:
        write_proven(kind, out)
    return out


@pytest.mark.slow
def test_scenes_share_packages_are_resumed_counted_and_packed(library: Path, tmp_path: Path):
    def run(count: int, part: Part | None = None) -> str:
        return make_scenes(
            KINDS, count, tmp_path, runner=HERE, packages=library, pictures="none", per_shard=2, part=part
        )

    assert run(2, Part(number=1, total=2)).startswith("1 of 1 scenes")
    first = tmp_path / "scenes" / "hall_000000"
    made = {path.name: path.stat().st_mtime_ns for path in first.iterdir()}
    assert {"scene.json", "goals.json", "scene.xml"} <= set(made)
    assert not (tmp_path / "scenes.json").exists()
    assert run(3).startswith("3 of 3 scenes")
    assert {path.name: path.stat().st_mtime_ns for path in first.iterdir()} == made
    scenes = sorted(path.name for path in (tmp_path / "scenes").iterdir() if path.is_dir())
    assert scenes == ["hall_000000", "hall_000002", "laundry_000001"]
    placements = json.loads((first / "scene.json").read_text())["placements"]
    assert {(first / each["package"]).resolve().parent for each in placements} == {library.resolve()}
    page = (tmp_path / "README.md").read_text()
    assert "| hall | 2 |" in page
    assert "| laundry | 1 |" in page
    index = json.loads((tmp_path / "scenes.json").read_text())
    assert (index["count"], list(index["files"])) == (
        3,
        ["shards/scenes-00000.tar", "shards/scenes-00001.tar"],
    )
    for name, facts in index["files"].items():
        assert facts["sha256"] == digest_file(tmp_path / name)
    packed = {}
    for name in index["files"]:
        with tarfile.open(tmp_path / name) as tar:
            packed |= {member.name: tar.extractfile(member).read() for member in tar}  # pyright: ignore
    assert len(packed) == 3 * len(scenes)
    for scene in scenes:
        held = read_folder(tmp_path / "scenes" / scene)
        assert packed[f"{scene}.json"] == held["scene.json"]
        assert packed[f"{scene}.goals.json"] == held["goals.json"]
        assert read_members(packed[f"{scene}.tar"], scene) == held


@pytest.mark.slow
def test_a_ray_cluster_makes_the_scenes_of_this_process(library: Path, tmp_path: Path):
    ray = pytest.importorskip("ray", reason="Ray is an extra")
    ray.init(address="local", num_cpus=1, log_to_driver=False, include_dashboard=False)
    try:
        runners = {"here": HERE, "ray": choose_runner("ray", 1)}
        for name, runner in runners.items():
            said = make_scenes(KINDS, 2, tmp_path / name, runner=runner, packages=library, pictures="none")
            assert said.startswith("2 of 2 scenes")
    finally:
        ray.shutdown()
    for scene in ("hall_000000", "laundry_000001"):
        here, there = (read_folder(tmp_path / name / "scenes" / scene) for name in runners)
        assert here == there


@pytest.mark.slow
def test_a_scene_that_cannot_be_is_reported_and_the_others_are_made(library: Path, tmp_path: Path):
    few = tmp_path / "few"
    for kind in FURNITURE:
        if kind.name != "washer":
            write_proven(kind, few)
    said = make_scenes(KINDS, 2, tmp_path / "out", runner=HERE, packages=few, pictures="none")
    assert said.startswith("1 of 2 scenes")
    assert "laundry_000001: " in (tmp_path / "out" / "README.md").read_text()
    make_scenes(("laundry",), 2, tmp_path / "two", runner=HERE, packages=few, pictures="none")
    page = (tmp_path / "two" / "README.md").read_text()
    assert "- 2, such as laundry_000000: " in page
    assert page.rstrip().endswith("(laundry_000000, laundry_000001)")
    with pytest.raises(ArtigenError, match="0 scenes"):
        make_scenes(KINDS, 0, tmp_path, runner=HERE)


def test_pictures_by_daylight_are_refused_before_any_work_where_nothing_traces_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    for furnish in (
        lambda: make_scenes(("kitchen",), 1, tmp_path, pictures="daylight", runner=HERE),
        lambda: furnish_room("kitchen", tmp_path, pictures="daylight"),
    ):
        with pytest.raises(ArtigenError, match=r"artigen\[mitsuba\]"):
            furnish()
    assert not list(tmp_path.iterdir())
