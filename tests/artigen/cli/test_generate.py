"""`artigen generate`: what fails is drawn again and recorded; what cannot be is said and nothing written."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

import artigen.api.generate
import artigen.api.sample
import artigen.latent.draw
import artigen.sketch.model
from artigen.api.generate import (
    GenerateJob,
    GenerateSettings,
    check_job,
    draw_generated,
    generate_and_validate,
    generate_object,
    read_job,
)
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.vae import APPEARANCE_FLOW, APPEARANCE_VAE, AppearanceVae
from artigen.cli.generate import generate
from artigen.errors import ArtigenError
from artigen.examples.photographs import photograph_shape
from artigen.latent.draw import build_structure_model
from artigen.latent.presets import PRESETS
from artigen.models.description import hash_model
from artigen.models.store import save_model
from artigen.runtime.workers import Outcome
from artigen.shapes.draw import draw_shape
from artigen.shapes.sheet import draw_picture
from artigen.sketch.fault import Fault
from artigen.sketch.model import Drawn, save_sketch_network
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.picture import PictureConfig
from artigen.types import Asset
from sim_export.files.read import read_package

SHAPE = draw_shape("StorageFurniture", 12)
OTHER = SketchNetworkConfig(width=16, layers=1, heads=2, pointer=8, picture=None)


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model that knows nothing."""
    torch.manual_seed(0)
    path = tmp_path_factory.mktemp("model")
    picture = PictureConfig(edge=64, widths=(8, 16, 24), blocks=(1, 1, 1), stem=8)
    network = SketchNetwork(SketchNetworkConfig(width=32, layers=1, heads=2, pointer=8, picture=picture))
    save_sketch_network(network, path, {"preset": "tiny"})
    return path


class BrokenWorker:
    """Fails at everything, and keeps what it was asked to make."""

    def __init__(self) -> None:
        self.jobs: list[GenerateJob] = []

    def call(self, function: object, job: GenerateJob, timeout: float) -> Outcome[None]:
        self.jobs.append(job)
        return Outcome(error=f"failure {len(self.jobs)}")


def test_what_fails_is_drawn_again_and_remembered(model: Path, tmp_path: Path):
    worker = BrokenWorker()
    job = GenerateJob(model=model, category="Oven", seed=4, out=tmp_path, cfg=GenerateSettings(redraws=2))
    finished = generate_and_validate(worker, job)  # type: ignore[arg-type]
    assert finished.error == "failure 3"
    assert "3 draws" in finished.notes
    assert [one.draws for one in worker.jobs] == [(), ("failure 1",), ("failure 1", "failure 2")]


def test_where_time_or_memory_runs_out_no_other_object_is_drawn(model: Path, tmp_path: Path):
    """A seed means the same object on a slow machine; the next run tries it again."""

    class SlowWorker(BrokenWorker):
        def call(self, function: object, job: GenerateJob, timeout: float) -> Outcome[None]:
            return replace(super().call(function, job, timeout), stopped=True)

    worker = SlowWorker()
    job = GenerateJob(model=model, category="Oven", seed=4, out=tmp_path, cfg=GenerateSettings(redraws=2))
    finished = generate_and_validate(worker, job)  # type: ignore[arg-type]
    assert [one.draws for one in worker.jobs] == [()]
    assert (finished.error, finished.stopped, finished.good) == ("failure 1", True, False)


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[tuple[object, int]]:
    """Requests and seeds of what is drawn: always the same cabinet."""
    seen: list[tuple[object, int]] = []

    def from_memory(network: object, request: object, seed: int, *rest: object) -> Drawn:
        seen.append((request, seed))
        return Drawn(shape=SHAPE, faults=(), notes=("sketch: from memory",))

    monkeypatch.setattr(artigen.sketch.model, "draw_object", from_memory)
    return seen


@pytest.mark.slow
def test_a_package_tells_condition_model_and_all_draws(
    model: Path, tmp_path: Path, drawn: list[tuple[object, int]]
):
    job = GenerateJob(model=model, category="StorageFurniture", seed=9, out=tmp_path)
    for draws in ((), ("V103 of the first",)):
        made = generate_object(replace(job, draws=draws))
    said = json.loads((tmp_path / job.key / "provenance.json").read_text())
    assert json.loads(said["draws"]) == ["V103 of the first", "this one"]
    condition = json.loads(said["condition"])
    assert condition["category"] == "StorageFurniture"
    assert condition["counts"] == dict(SHAPE.condition.counts)
    assert said["model"] == hash_model(model)
    assert said["structure"] == "sketch"
    assert "sketch: from memory" in made.notes
    assert len({seed for _, seed in drawn}) == 2  # every draw has chances of its own


def test_an_object_with_faults_is_exported_only_if_it_was_the_last_draw(
    model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    faults = (Fault(id="sealed", part="door_0", other="body", value=0.9, allowed=0.5),)
    faulty = Drawn(shape=SHAPE, faults=faults, notes=())
    monkeypatch.setattr(artigen.sketch.model, "draw_object", lambda *_: faulty)
    cfg = GenerateSettings(redraws=1, gaussians=False)
    job = GenerateJob(model=model, category="StorageFurniture", seed=9, out=tmp_path, cfg=cfg)
    drawn, _ = draw_generated(job)
    assert drawn.faults == ()
    assert drawn.notes[0].endswith("the grammar drew it")
    monkeypatch.setattr(artigen.sketch.asked, "draw_told", lambda *_: None)  # which has no such object
    with pytest.raises(ArtigenError, match="sketch: door_0 opens onto a cavity that body encloses"):
        generate_object(job)
    assert not (tmp_path / job.key).exists()
    made = generate_object(replace(job, draws=("the first",)))
    assert any(note.startswith("sketch: door_0 opens onto a cavity") for note in made.notes)


def test_a_package_by_a_picture_has_its_colours(model: Path, tmp_path: Path, drawn: list[tuple[object, int]]):
    rgba = photograph_shape(SHAPE, 0, 64).astype(np.float64)
    rgba[..., :3] = rgba[..., 3:] * (0.8, 0.1, 0.1)
    Image.fromarray(rgba.astype(np.uint8)).save(tmp_path / "red.png")
    settings = GenerateSettings(image=tmp_path / "red.png", counts=("door=2",), gaussians=False)
    job = GenerateJob(model=model, category=None, seed=9, out=tmp_path, cfg=settings)
    shape = draw_generated(job)[0].shape
    said = [finish.color for role, finish in shape.finishes if role == "body"]
    assert said[0][0] > 0.7  # how bright depends on the light, which nothing tells
    assert max(said[0][1:]) < 0.2
    request, _ = drawn[0]
    assert dict(request.counts)["door"] == 2  # type: ignore[attr-defined]
    assert request.width is None  # type: ignore[attr-defined]
    assert len(drawn) == 1
    generate_object(job)
    condition = json.loads((tmp_path / job.key / "provenance.json").read_text())["condition"]
    assert json.loads(condition)["image"] == "red.png"


@pytest.fixture
def latent(
    model: Path, tmp_path: Path, drawn: list[tuple[object, int]], monkeypatch: pytest.MonkeyPatch
) -> GenerateJob:
    """A job for the same cabinet as voxels, by a model that knows nothing: they are those of its boxes."""
    preset, look = PRESETS["tiny"], APPEARANCE_PRESETS["tiny"]
    folder = Path(shutil.copytree(model, tmp_path / "model"))
    structure = build_structure_model(preset)
    save_model(structure.vae, folder, {"preset": "tiny"}, "vae")
    save_model(structure.flow, folder, {"preset": "tiny"}, "flow")
    save_model(AppearanceVae(look.encoder, look.decoder), folder, {"preset": "tiny"}, APPEARANCE_VAE)
    save_model(SlatFlow(look.flow, look.conditions), folder, {"preset": "tiny"}, APPEARANCE_FLOW)

    def keep(*rest: object, boxes: Asset) -> Asset:
        return boxes

    monkeypatch.setattr(artigen.latent.draw, "generate_structure", keep)
    settings = GenerateSettings(structure="latent")
    return GenerateJob(model=folder, category=SHAPE.category, seed=9, out=tmp_path, cfg=settings)


@pytest.mark.slow
def test_a_latent_package_has_gaussians_on_the_meshes_of_its_links_or_none(latent: GenerateJob):
    made, folder = generate_object(latent), latent.out / latent.key
    package = read_package(folder)
    assert any("Gaussians are drawn on the meshes in the paint of the sketch" in one for one in made.notes)
    assert any("surface samples of the own part cover 100.00 %" in one for one in made.notes)
    for link in package.links:
        assert (link.splats is None) == (not link.visuals)
        if link.splats is not None:
            corners = np.concatenate([visual.mesh.vertices for visual in link.visuals])
            voxel = 1.0 / 32 * max(SHAPE.condition.depth, SHAPE.condition.width, SHAPE.condition.height)
            assert (link.splats.means > corners.min(axis=0) - 2 * voxel).all()
            assert (link.splats.means < corners.max(axis=0) + 2 * voxel).all()
    shown = {path.relative_to(folder): path.read_bytes() for path in sorted((folder / "visual").rglob("*.*"))}
    generate_object(replace(latent, cfg=replace(latent.cfg, gaussians=False)))
    assert all(link.splats is None for link in read_package(folder).links)
    assert shown == {path.relative_to(folder): path.read_bytes() for path in (folder / "visual").rglob("*.*")}


def test_parts_that_are_not_the_sketchs_are_named(latent: GenerateJob, monkeypatch: pytest.MonkeyPatch):
    def rename(*rest: object, boxes: Asset) -> Asset:
        return replace(boxes, parts=tuple(replace(part, name=f"found_{part.name}") for part in boxes.parts))

    monkeypatch.setattr(artigen.latent.draw, "generate_structure", rename)
    with pytest.raises(ArtigenError, match=r"shows the parts found_.*, expected those of the sketch"):
        generate_object(latent)


def test_a_part_without_painted_surface_is_named(latent: GenerateJob, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(artigen.api.sample, "SPACING", 0.5)
    with pytest.raises(ArtigenError, match=r"handle.*: none of \d+ painted samples"):
        generate_object(latent)
    assert not (latent.out / latent.key).exists()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"category": "Spaceship"}, "expected a kind that the model draws, one of"),
        ({"category": None}, "no category"),
        ({"category": "Oven", "cfg": GenerateSettings(counts=("door",))}, "label=number"),
        ({"category": "Oven", "count": 0}, "at least one"),
        ({"category": "Oven", "workers": -1}, "-1"),
        (
            {"category": "Oven", "cfg": GenerateSettings(counts=("door=1", "doors=2"))},
            "contradict each other",
        ),
        ({"category": "Oven", "cfg": GenerateSettings(counts=("base=2",))}, "2 parts called base"),
        ({"category": "Oven", "cfg": GenerateSettings(height=-1.0)}, "height -1 m"),
        ({"category": "Oven", "cfg": GenerateSettings(width=float("nan"))}, "width nan m"),
        ({"category": "Oven", "cfg": GenerateSettings(steps=0)}, "at least one step"),
        ({"category": "Oven", "cfg": GenerateSettings(strength=float("nan"))}, "strength nan"),
        ({"category": "Oven", "cfg": GenerateSettings(temperature=0.0)}, "temperature above 0"),
        ({"category": "Oven", "cfg": GenerateSettings(style="baroque")}, "style 'baroque'"),
        ({"cfg": GenerateSettings(text="a green sofa")}, "names no kind of object"),
        ({"cfg": GenerateSettings(text="a table with a drawer", counts=("drawer=2",))}, "number of drawers"),
        ({"cfg": GenerateSettings(image=Path("nothing.png"))}, "no such picture"),
        ({"category": "Oven", "cfg": GenerateSettings(kind="Safe")}, "name one"),
        ({"category": "Oven", "cfg": GenerateSettings(doors=1, counts=("door=2",))}, "give one number"),
    ],
)
def test_what_cannot_be_is_said_and_nothing_written(model: Path, tmp_path: Path, wrong: dict, message: str):
    with pytest.raises(ArtigenError, match=message):
        generate(out=tmp_path / "out", model=model, **wrong)
    assert not (tmp_path / "out").exists()


def test_a_picture_that_is_none_is_named_before_anything_is_made(model: Path, tmp_path: Path):
    wrong = {"words.png": b"hello", "nothing.png": b"", "cut.png": b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR"}
    for name, content in wrong.items():
        (tmp_path / name).write_bytes(content)
        cfg = GenerateSettings(image=tmp_path / name)
        with pytest.raises(ArtigenError, match=name):
            check_job(GenerateJob(model=model, category=None, seed=0, out=tmp_path / "out", cfg=cfg))


def test_a_folder_without_a_model_is_named(tmp_path: Path):
    for folder in (tmp_path, tmp_path / "file"):
        (tmp_path / "file").write_text("no model")
        with pytest.raises(ArtigenError, match="no such model"):
            generate(out=tmp_path / "out", model=folder, category="Oven")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda folder: cut(folder / "sketch-0.safetensors"), "no complete safetensors"),
        (
            lambda folder: save_model(SketchNetwork(OTHER), folder, {}, "other")[0].replace(
                folder / "sketch-0.safetensors"
            ),
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
    with pytest.raises(ArtigenError, match=message):
        generate(out=tmp_path / "out", model=folder, category="Oven")
    assert not (tmp_path / "out").exists()


def cut(path: Path) -> None:
    """Leaves the first half of a file."""
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])


def test_packages_of_other_weights_are_made_again_and_those_of_the_same_are_not(model: Path, tmp_path: Path):
    """A folder's name does not count: a model that was trained further in place is another one."""
    same = Path(shutil.copytree(model, tmp_path / "same"))
    other = Path(shutil.copytree(model, tmp_path / "other"))
    weights = other / "sketch-0.safetensors"
    content = bytearray(weights.read_bytes())
    content[-1] ^= 1
    weights.write_bytes(content)
    settings = [
        GenerateJob(model=folder, category="Oven", seed=0, out=tmp_path).settings
        for folder in (model, same, other)
    ]
    assert settings[0] == settings[1] != settings[2]


def test_a_photo_that_changed_in_place_makes_its_package_again(model: Path, tmp_path: Path):
    photo = tmp_path / "photo.png"
    job = GenerateJob(model=model, category=None, seed=0, out=tmp_path, cfg=GenerateSettings(image=photo))
    found = []
    for gray in (10, 200, 10):
        Image.new("L", (4, 4), gray).save(photo)
        found.append(job.settings)
    assert found[0] == found[2] != found[1]


def test_counts_have_options_of_their_own(model: Path, tmp_path: Path):
    given = GenerateSettings(kind="Dresser", doors=1, drawers=3)
    same = GenerateSettings(counts=("door=1", "drawer=3"))
    jobs = [
        GenerateJob(model=model, category=category, seed=0, out=tmp_path, cfg=cfg)
        for category, cfg in ((None, given), ("Dresser", same))
    ]
    assert read_job(jobs[0]) == read_job(jobs[1])


def test_a_photograph_is_built_without_the_sketch_network_and_compared(
    model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def refuse(folder: Path) -> None:
        raise AssertionError(f"{folder} was loaded")

    monkeypatch.setattr(artigen.api.generate, "load_sketch", refuse)
    shape = draw_shape("Refrigerator", 2)
    photo = tmp_path / "fridge.png"
    Image.fromarray(draw_picture(shape, np.zeros(len(shape.parts)), 160)).save(photo)
    cfg = GenerateSettings(image=photo, kind="Refrigerator", doors=1, drawers=0, width=0.7, gaussians=False)
    job = GenerateJob(model=model, category=None, seed=0, out=tmp_path / "out", cfg=cfg)
    check_job(job)
    drawn, asked = draw_generated(job)
    low, high = drawn.shape.bounds()
    assert high[1] - low[1] == pytest.approx(0.7, abs=1e-6)
    assert sum(part.label in ("door", "drawer") for part in drawn.shape.parts) == 1
    assert asked.reading is not None
    generate_object(job)
    assert "data:image/jpeg" in (tmp_path / "out" / f"{job.key}.html").read_text()
