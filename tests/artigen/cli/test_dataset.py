"""`artigen dataset`: from a recipe to a data set that is whole, whatever stops it, and that others load."""

import hashlib
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest
from project import ROOT

pytest.importorskip("pyarrow")

from artigen.api.dataset_objects import restart_large
from artigen.api.sample import ShapeJob, ShapeSettings, export_shape
from artigen.cli.dataset import dataset
from artigen.datasets import open_shards
from artigen.datasets.packing import read_folder
from artigen.datasets.verify import verify_dataset
from artigen.errors import ArtigenError
from artigen.runtime.workers import Worker

pytestmark = pytest.mark.slow

RECIPE = """
name: tiny
objects:
  - {category: Safe, count: 2}
  - {category: Microwave, count: 3, seed: 4}
options: {objects_per_shard: 2, validation: none, thumbnail: 48}
"""
OTHER = """
name: other
objects:
  - {category: Safe, count: 2, seed: 1}
options: {validation: none, thumbnail: 48}
"""
KILLER = """
import os, signal, sys
from pathlib import Path

import artigen.api.batch, artigen.api.dataset, artigen.cli.dataset, artigen.datasets.publish

def kill_at(owner, name, number):
    own, calls = getattr(owner, name), []
    def counted(*args, **kwargs):
        calls.append(1)
        if len(calls) == number:
            os.kill(os.getpid(), signal.SIGKILL)
        return own(*args, **kwargs)
    setattr(owner, name, counted)

owners = {"journal": (artigen.api.batch, "append_line"), "tar": (artigen.datasets.publish, "add_member"),
          "move": (Path, "replace"), "clean": (artigen.api.dataset.shutil, "rmtree"),
          "card": (artigen.datasets.publish, "card_text")}
where, number, recipe, out = sys.argv[1:]
kill_at(*owners[where], int(number))
artigen.cli.dataset.dataset((recipe,), Path(out), workers=1)
"""


def make(recipe: str, folder: Path) -> Path:
    path = folder.with_suffix(".yaml")
    path.write_text(recipe)
    assert dataset((str(path),), folder, workers=0) == 0
    return folder


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    return make(RECIPE, tmp_path_factory.mktemp("made") / "tiny")


@pytest.fixture(scope="module")
def merged(made, tmp_path_factory) -> Path:
    base = tmp_path_factory.mktemp("merged")
    other = make(OTHER, base / "other")
    assert dataset(("merge", str(made), str(other)), base / "both") == 0
    return base / "both"


@pytest.fixture
def copy(made, tmp_path) -> Path:
    shutil.copytree(made, tmp_path / "copy")
    return tmp_path / "copy"


def hashes(folder: Path) -> dict[str, str]:
    return {name: hashlib.sha256(data).hexdigest() for name, data in read_folder(folder).items()}


def test_a_data_set_is_whole_and_its_objects_are_those_asked_for(made):
    shards = open_shards(made)
    assert verify_dataset(shards) == []
    assert sorted(shards.ids) == ["Microwave-4", "Microwave-5", "Microwave-6", "Safe-0", "Safe-1"]
    assert [item.id for item in shards] == list(shards.ids)
    assert not (made / "work").exists()
    assert len(shards.paths) == 3


def test_an_unpacked_object_is_its_package_byte_for_byte(made, tmp_path):
    cfg = ShapeSettings()
    export_shape(ShapeJob(category="Microwave", seed=5, out=tmp_path, cfg=cfg, name="Microwave-5"))
    package = read_folder(tmp_path / "Microwave-5")
    item = open_shards(made)["Microwave-5"]
    assert item.files() == package
    assert dataset(("unpack", str(made), "Microwave-5"), tmp_path / "unpacked") == 0
    assert read_folder(tmp_path / "unpacked" / "Microwave-5") == package


def test_streaming_and_looking_up_give_the_same(made):
    shards = open_shards(made)
    for item in shards:
        assert shards[item.id].members == item.members
        assert item.sample.id == item.id
        assert item.record["mass"] == item.sample.mass > 0
    with pytest.raises(KeyError, match="Safe-7"):
        shards["Safe-7"]


def test_the_manifest_says_what_the_samples_say(made):
    shards = open_shards(made)
    rows = shards.manifest().to_pylist()
    assert [row["id"] for row in rows] == [item.id for item in shards]
    for row, item in zip(rows, shards, strict=True):
        sample = item.sample
        assert (row["depth"], row["width"], row["height"]) == sample.extents
        assert row["joint_kinds"] == [one.joint.type for one in sample.joints]
        assert row["doors"] == next(one.count for one in sample.counts if one.label == "door")
        assert row["thumbnail"]["bytes"] == item.thumbnail
        data = (made / "shards" / row["shard"]).read_bytes()[row["offset"] : row["offset"] + row["size"]]
        assert data.startswith(item.id.encode())


def test_shards_hold_neither_times_nor_owners(made):
    for path in [*open_shards(made).paths, *sorted((made / "shared").glob("*.tar"))]:
        with tarfile.open(path) as tar:
            assert {(one.mtime, one.uid, one.gid, one.mode) for one in tar} == {(0, 0, 0, 0o644)}


@pytest.mark.parametrize(("resident", "closed"), [(1190.0, 0), (1210.0, 1)])
def test_a_worker_is_replaced_once_it_holds_more_than_1200_mib(resident, closed):
    class Counted(Worker):
        closed = 0

        def close(self) -> None:
            self.closed += 1

    worker = Counted()
    restart_large(worker, resident)
    assert worker.closed == closed


def test_the_same_command_again_changes_nothing(copy):
    before = hashes(copy)
    recipe = copy.with_suffix(".yaml")
    recipe.write_text(RECIPE)
    assert dataset((str(recipe),), copy, workers=0) == 0
    assert hashes(copy) == before


def test_killed_anywhere_nothing_is_lost_and_nothing_doubled(made, tmp_path):
    recipe, out = tmp_path / "tiny.yaml", tmp_path / "killed"
    recipe.write_text(RECIPE)
    env = os.environ | {"PYTHONPATH": str(ROOT)}
    for where, number in (("journal", 3), ("tar", 17), ("move", 4), ("clean", 3)):
        command = [sys.executable, "-c", KILLER, where, str(number), str(recipe), str(out)]
        done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=120, check=False)
        assert done.returncode == -signal.SIGKILL, done.stderr
    journal = [json.loads(line)["key"] for line in (out / "work" / "run.jsonl").read_text().splitlines()]
    assert sorted(journal) == sorted(open_shards(made).ids)
    assert dataset((str(recipe),), out, workers=0) == 0
    assert hashes(out) == hashes(made)


def test_another_recipe_does_not_overwrite(copy, tmp_path):
    recipe = tmp_path / "other.yaml"
    recipe.write_text(OTHER)
    before = hashes(copy)
    with pytest.raises(ArtigenError, match="another recipe"):
        dataset((str(recipe),), copy, workers=0)
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "README.md").write_text("mine")
    with pytest.raises(ArtigenError, match="not empty"):
        dataset((str(recipe),), tmp_path / "notes", workers=0)
    assert hashes(copy) == before


def test_parts_make_their_objects_and_a_run_without_parts_packs_them(made, tmp_path):
    recipe = tmp_path / "tiny.yaml"
    recipe.write_text(RECIPE)
    for part in ("2/2", "1/2"):
        assert dataset((str(recipe),), tmp_path / "parts", workers=0, shard=part) == 0
        assert not (tmp_path / "parts" / "dataset.json").exists()
    assert dataset((str(recipe),), tmp_path / "parts", workers=0) == 0
    assert hashes(tmp_path / "parts") == hashes(made)


def test_duplicates_are_replaced_by_later_seeds_and_recorded(made, tmp_path):
    recipe = """
name: twice
objects:
  - {category: Safe, count: 1}
  - {category: Safe, count: 1, name: again}
options: {validation: none, thumbnail: 48}
"""
    shards = open_shards(make(recipe, tmp_path / "twice"))
    assert sorted(shards.ids) == ["Safe-0", "again-1"]
    assert shards.index["duplicates"] == [{"id": "again-0", "of": "Safe-0", "distance": 0.0}]


@pytest.mark.parametrize(
    ("wish", "said"),
    [
        ("{counts: {drawer: 99}}", "line 4: Safe: .*99 drawer"),
        ("{counts: {base: 2}}", "every object has one"),
    ],
)
def test_an_impossible_wish_is_an_error_before_anything_is_made(wish: str, said: str, tmp_path):
    recipe = tmp_path / "impossible.yaml"
    recipe.write_text(f"name: a\n\nobjects:\n  - {{category: Safe, count: 1, wish: {wish}}}\n")
    with pytest.raises(ArtigenError, match=said):
        dataset((str(recipe),), tmp_path / "out", workers=0)
    assert not (tmp_path / "out").exists()


def test_merging_leaves_out_what_is_in_both(made, merged):
    shards = open_shards(merged)
    assert verify_dataset(shards) == []
    assert sorted(shards.ids) == sorted([*open_shards(made).ids, "Safe-2"])
    for item in open_shards(made):
        assert shards[item.id].members == item.members


def test_a_merged_data_set_keeps_its_recipes_and_is_merged_again_to_the_same(made, merged, tmp_path):
    assert sorted(path.name for path in (merged / "recipes").iterdir()) == ["other.yaml", "tiny.yaml"]
    assert dataset(("merge", str(merged), str(made)), tmp_path / "both") == 0
    again = open_shards(tmp_path / "both")
    assert {item.id: item.members for item in again} == {
        item.id: item.members for item in open_shards(merged)
    }


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("shards/objects-00001.tar", "was changed"),
        ("shared/shared-00000.tar", "was changed"),
        ("README.md", "was changed"),
        ("manifest.parquet", "was changed"),
    ],
)
def test_a_changed_byte_is_found(copy, name: str, said: str, capsys):
    data = bytearray((copy / name).read_bytes())
    data[len(data) // 2] ^= 1
    (copy / name).write_bytes(bytes(data))
    assert dataset(("verify", str(copy))) == 1
    assert f"{name} {said}" in capsys.readouterr().err


@pytest.mark.parametrize("member", ["json", "tar.zst"])
def test_an_object_without_a_member_is_found(copy, member: str, capsys):
    path = copy / "shards" / "objects-00001.tar"
    with tarfile.open(path) as old:
        old_members = [one for one in old.getmembers() if not one.name.endswith(f".{member}")]
        kept = [(one, old.extractfile(one)) for one in old_members]
        kept = [(one, stream.read()) for one, stream in kept if stream is not None]
    with tarfile.open(path, "w") as new:
        for one, data in kept:
            new.addfile(one, io.BytesIO(data))
    assert dataset(("verify", str(copy))) == 1
    assert f"the shard holds no {member}" in capsys.readouterr().err


def test_what_is_missing_or_left_over_is_found(copy, capsys):
    shards = open_shards(copy)
    path = shards.paths[0]
    shutil.copy(path, copy / "shards" / "objects-00009.tar")
    assert dataset(("verify", str(copy))) == 1
    assert "objects-00009.tar is not part of the data set" in capsys.readouterr().err
    path.unlink()
    assert dataset(("verify", str(copy))) == 1
    assert "is missing" in capsys.readouterr().err
    (copy / "dataset.json").unlink()
    with pytest.raises(ArtigenError, match="no data set"):
        dataset(("verify", str(copy)))


def test_a_swapped_sample_is_found_though_all_hashes_agree(copy):
    """A shard whose sample carries another package, with `dataset.json` brought into line."""
    shards = open_shards(copy)
    first, second, *_ = [item for item in shards if len(item.members["tar.zst"]) > 0]
    path = next(one for one in shards.paths if first.members["tar.zst"] in one.read_bytes())
    own, other = first.members["tar.zst"], second.members["tar.zst"]
    data = path.read_bytes().replace(own, (other + bytes(len(own)))[: len(own)])
    path.write_bytes(data)
    index = json.loads((copy / "dataset.json").read_text())
    index["files"][path.relative_to(copy).as_posix()]["sha256"] = hashlib.sha256(data).hexdigest()
    (copy / "dataset.json").write_text(json.dumps(index))
    problems = verify_dataset(open_shards(copy))
    assert any(problem.startswith(first.id) for problem in problems)


def test_hugging_face_loads_the_folder_and_the_shards_offline(made, tmp_path):
    pytest.importorskip(
        "datasets", reason="Hugging Face datasets is not installed: loading with it is not shown"
    )
    code = f"""
from datasets import Image, load_dataset

rows = load_dataset({str(made)!r}, split="train")
assert isinstance(rows.features["thumbnail"], Image)
assert rows[0]["thumbnail"].size == (96, 48)
plain = load_dataset("parquet", data_files={str(made / "manifest.parquet")!r}, split="train")
assert plain["id"][:] == rows["id"][:]
for streaming in (False, True):
    shards = {str(made / "shards" / "*.tar")!r}
    samples = list(load_dataset("webdataset", data_files=shards, split="train", streaming=streaming))
    assert [one["__key__"] for one in samples] == rows["id"][:]
    assert [one["json"]["mass"] for one in samples] == rows["mass"][:]
    assert [len(one["json"]["joints"]) for one in samples] == [len(one) for one in rows["joint_kinds"]]
    assert samples[0]["webp"].size == (96, 48)
    assert samples[0]["tar.zst"]
"""
    offline = {"HF_HUB_OFFLINE": "1", "HF_DATASETS_OFFLINE": "1"}
    env = os.environ | offline | {"HF_HOME": str(tmp_path), "HF_DATASETS_CACHE": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=env, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr


def test_croissant_metadata_is_valid_and_gives_the_rows(made):
    mlcroissant = pytest.importorskip(
        "mlcroissant", reason="mlcroissant is not installed: metadata is not checked"
    )
    metadata = mlcroissant.Dataset(made / "croissant.json")
    assert not metadata.metadata.ctx.issues.errors
    rows = [row["objects/id"].decode() for row in metadata.records("objects")]
    assert rows == list(open_shards(made).ids)


def test_the_card_is_what_hugging_face_reads(made):
    huggingface_hub = pytest.importorskip("huggingface_hub", reason="huggingface_hub is not installed")
    card = huggingface_hub.DatasetCard.load(made / "README.md")
    assert card.data.license == "cc-by-4.0"
    assert card.data.size_categories == ["n<1K"]
    assert "$" not in card.text.replace("$schema", "")
    assert (made / "images" / "objects.webp").is_file()
    assert "5 articulated objects of 2 categories" in card.text
