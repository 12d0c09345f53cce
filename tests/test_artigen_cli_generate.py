"""`artigen generate`: what fails is drawn again and recorded; what cannot be is said and nothing written."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from PIL import Image

import artigen.generate
from artigen.cli.generate import GenerateJob, GenerateSettings, generate, generate_object
from artigen.errors import ArtigenError, SourceError
from artigen.generate import build_structure_model
from artigen.models.presets import PRESETS
from artigen.models.store import hash_model, save_model
from artigen.types import Asset


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model that knows nothing and finds no cell occupied."""
    torch.manual_seed(0)
    preset, path = PRESETS["tiny"], tmp_path_factory.mktemp("model")
    model = build_structure_model(preset)
    with torch.no_grad():
        model.vae.get_parameter("decoder.occupancy_head.2.bias").fill_(-1000.0)
    for name in ("vae", "outline", "reader", "flow"):
        save_model(getattr(model, name), path, {"preset": "tiny"}, name)
    return path


def test_a_draw_that_fails_is_drawn_again_and_leaves_no_package(model: Path, tmp_path: Path):
    out = tmp_path / "out"
    cfg = GenerateSettings(redraws=1, steps=1)
    assert generate(out=out, model=model, category="Oven", seed=4, cfg=cfg, workers=1) == 1
    (line,) = (out / "run.jsonl").read_text().splitlines()
    said = json.loads(line)
    assert said["error"]
    assert "2 draws" in said["notes"]
    assert [path.name for path in out.iterdir()] == ["run.jsonl"]


def test_a_package_tells_condition_model_and_all_draws(
    model: Path, tmp_path: Path, cabinet: Asset, monkeypatch: pytest.MonkeyPatch
):
    noises = []

    def from_memory(model, asked, seed, cfg):
        noises.append(seed)
        return replace(cabinet, category=asked.category)

    monkeypatch.setattr(artigen.generate, "generate_structure", from_memory)
    job = GenerateJob(model=model, category="StorageFurniture", seed=9, out=tmp_path)
    for draws in ((), ("V103 of the first",)):
        generate_object(replace(job, draws=draws))
    said = json.loads((tmp_path / job.key / "provenance.json").read_text())
    assert json.loads(said["draws"]) == ["V103 of the first", "this one"]
    assert json.loads(said["condition"])["category"] == "StorageFurniture"
    assert said["model"] == hash_model(model)
    assert len(set(noises)) == 2  # every draw has noise of its own


def test_a_package_tells_what_was_read_off_its_picture(
    model: Path, tmp_path: Path, cabinet: Asset, monkeypatch: pytest.MonkeyPatch
):
    asked = []

    def from_memory(model, condition, seed, cfg):
        asked.append(condition)
        return cabinet

    monkeypatch.setattr(artigen.generate, "generate_structure", from_memory)
    Image.new("RGBA", (64, 64), (200, 30, 30, 255)).save(tmp_path / "red.png")
    settings = GenerateSettings(image=tmp_path / "red.png", counts=("door=2",))
    job = GenerateJob(model=model, category=None, seed=9, out=tmp_path, cfg=settings)
    made = generate_object(job)
    said = json.loads(json.loads((tmp_path / job.key / "provenance.json").read_text())["condition"])
    (condition,) = asked
    assert (said["category"], said["image"]) == (condition.category, "red.png")
    assert said["counts"] == dict(condition.counts)
    assert said["counts"]["door"] == 2
    assert said["size"] == pytest.approx(condition.size)
    assert any("picture: read as" in note for note in made.notes)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"category": "Spaceship"}, "expected one of"),
        ({"category": None}, "no category"),
        ({"category": "Oven", "cfg": GenerateSettings(counts=("door",))}, "label=number"),
        ({"category": "Oven", "count": 0}, "at least one"),
        ({"category": "Oven", "workers": 0}, "one worker"),
        ({"category": "Cart"}, "this model knows Dishwasher"),
        ({"category": "Oven", "cfg": GenerateSettings(counts=("door=1", "door=2"))}, "both are asked for"),
        ({"category": "Oven", "cfg": GenerateSettings(counts=("base=2",))}, "2 parts called base"),
        ({"category": "Oven", "cfg": GenerateSettings(height=-1.0)}, "height -1 m"),
        ({"category": "Oven", "cfg": GenerateSettings(width=float("nan"))}, "width nan m"),
        ({"category": "Oven", "cfg": GenerateSettings(steps=0)}, "at least one step"),
        ({"category": "Oven", "cfg": GenerateSettings(strength=float("nan"))}, "strength nan"),
        ({"cfg": GenerateSettings(text="a green sofa")}, "no word names a category"),
        ({"cfg": GenerateSettings(text="a table with a drawer", counts=("drawer=2",))}, "number of drawers"),
        ({"cfg": GenerateSettings(image=Path("nothing.png"))}, "no such picture"),
    ],
)
def test_what_cannot_be_is_said_and_nothing_written(model: Path, tmp_path: Path, wrong: dict, message: str):
    with pytest.raises(ArtigenError, match=message):
        generate(out=tmp_path / "out", model=model, **wrong)
    assert not (tmp_path / "out").exists()


def test_a_picture_that_is_none_is_said_and_nothing_written(model: Path, tmp_path: Path):
    wrong = {"words.png": b"hello", "nothing.png": b"", "cut.png": b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR"}
    for name, content in wrong.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(SourceError, match=name):
            generate(out=tmp_path / "out", model=model, cfg=GenerateSettings(image=tmp_path / name))
    assert not (tmp_path / "out").exists()


def test_a_folder_without_a_model_is_named(tmp_path: Path):
    for folder in (tmp_path, tmp_path / "file"):
        (tmp_path / "file").write_text("no model")
        with pytest.raises(SourceError, match="no such model"):
            generate(out=tmp_path / "out", model=folder, category="Oven")


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda folder: cut(folder / "flow-0.safetensors"), "no whole safetensors"),
        (
            lambda folder: shutil.copy(folder / "vae-0.safetensors", folder / "flow-0.safetensors"),
            "does not fit",
        ),
        (lambda folder: (folder / "model.json").write_bytes(b"\xff\xfe\x00"), "is no JSON"),
    ],
)
def test_a_truncated_or_foreign_model_is_named_and_nothing_written(
    model: Path, tmp_path: Path, spoil, message: str
):
    folder = Path(shutil.copytree(model, tmp_path / "model"))
    spoil(folder)
    with pytest.raises(SourceError, match=message):
        generate(out=tmp_path / "out", model=folder, category="Oven")
    assert not (tmp_path / "out").exists()


def cut(path: Path) -> None:
    """Leaves the first half of a file."""
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
