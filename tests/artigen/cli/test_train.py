"""`artigen train` and `artigen eval`: from nothing to a table, in several sessions, and what is refused."""

import json
import shutil
from dataclasses import asdict, replace
from pathlib import Path
from typing import get_args, get_type_hints

import pytest
import torch
from grammar_source import grammar_source
from sample_partnet import write_sample

import artigen.metrics.draws
import artigen.metrics.evaluate
from artigen.cli.evaluate import evaluate
from artigen.cli.train import train
from artigen.errors import ArtigenError, SegmentationError, SourceError
from artigen.examples.real import RealJob, list_split, read_real
from artigen.examples.shards import HELD_OUT
from artigen.examples.structure import draw_example, read_shard, write_shard
from artigen.latent.draw import GenerateConfig, load_structure_model
from artigen.latent.presets import PRESETS
from artigen.latent.structure_vae import StructureVae
from artigen.metrics.asks import EvaluateConfig
from artigen.metrics.draws import DrawJob, ShapeSource, draw_all, draw_latent
from artigen.metrics.evaluate import Evaluation, evaluate_structure
from artigen.metrics.instantiation import InstantiationConfig
from artigen.metrics.report import write_report
from artigen.metrics.score import ScoreConfig
from artigen.metrics.settings import EvaluateSettings
from artigen.metrics.subjects import Subject
from artigen.models.conditions import StructureCondition
from artigen.models.store import load_model, save_model
from artigen.models.tensors import read_tensors
from artigen.runtime.journal import claim_folder
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.train.loop import finished_steps
from artigen.train.settings import TrainSettings
from artigen.types import Asset
from artigen.weights import SHIPPED

pytestmark = pytest.mark.slow

SETTINGS = TrainSettings(preset="tiny", minutes=0.02, shards=1, held_out=1, objects=2, real_share=0.25)


@pytest.fixture(scope="module")
def partnet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with one readable real object, and one that is not."""
    folder = tmp_path_factory.mktemp("partnet")
    write_sample(folder / "partnet_mobility" / "good")
    shutil.copytree(folder / "partnet_mobility" / "good", folder / "partnet_mobility" / "broken")
    (folder / "partnet_mobility" / "broken" / "mobility_v2.json").write_text("[{]")
    (folder / "splits.json").write_text(json.dumps({"train": ["good", "broken"], "val": ["good"]}))
    return folder


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory, partnet: Path) -> Path:
    """A finished run; its procedural shards were there before."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    for name, seed in (("train", HELD_OUT), ("held_out", 0)):
        (folder / name).mkdir(parents=True)
        drawn = [draw_example(name, seed, resolution=32, image_size=32)[1] for name in ("Oven", "Table")]
        write_shard(folder / name / "shard_00000.npz", drawn)
    assert train("structure", folder, replace(SETTINGS, partnet=partnet), workers=1) == 0
    return folder


def test_a_run_leaves_weights_and_what_it_was(run: Path):
    model = load_structure_model(run / "model")
    assert model.preset == PRESETS["tiny"]
    said = json.loads((run / "model" / "model.json").read_text())
    assert said["flow"] == {
        "preset": "tiny",
        "steps": finished_steps(run / "flow"),
        "objects": 2,
        "real_objects": 1,
    }
    assert said["vae"]["decoder_steps"] == finished_steps(run / "decoder") > 0
    assert json.loads((run / "config.json").read_text())["real_share"] == 0.25
    assert set(json.loads((run / "spread.json").read_text())) >= {"axis", "origin", "box_center"}
    for stage in ("vae", "flow", "decoder"):
        assert (run / stage / "weights.safetensors").is_file()


def test_real_objects_are_read_once_and_the_unreadable_are_named(run: Path):
    (example,) = read_shard(run / "real" / "real.npz")
    assert (example.name, example.field.resolution) == ("good", 32)
    assert example.image is not None
    assert example.image.shape == (32, 32, 4)
    assert 0.2 < (example.image[..., 3] > 0).mean() < 0.9
    (reason,) = json.loads((run / "real" / "left_out.json").read_text()).items()
    assert reason[0] == "broken"
    assert "mobility_v2.json" in reason[1]


def test_a_finished_run_stays_as_it_is(run: Path, partnet: Path):
    before = {path: path.read_bytes() for path in (run / "model").iterdir()}
    assert train("structure", run, replace(SETTINGS, partnet=partnet), workers=1) == 0
    assert train("structure-flow", run, replace(SETTINGS, partnet=partnet), workers=1) == 0
    assert {path: path.read_bytes() for path in (run / "model").iterdir()} == before


@pytest.mark.parametrize(
    ("what", "changes", "message"),
    [
        ("structure", {"minutes": 0.0}, "more than 0"),
        ("structure", {"objects": 0}, "more than 0"),
        ("structure", {"preset": "huge"}, "expected one of tiny, small, compact, paper"),
        ("structure", {"real_share": 1.0}, "between 0 and 1"),
        ("structure", {"partnet": Path("nowhere")}, "splits.json: cannot be read"),
        ("structure", {"start": Path("nowhere")}, "there is no such model"),
        ("structure", {"start": SHIPPED}, "has the sizes of preset 'small'"),
        ("structure-flow", {}, "train structure-vae first"),
        ("structure-decoder", {}, "train structure-vae first"),
    ],
)
def test_what_cannot_be_trained_is_said_and_nothing_written(
    tmp_path: Path, what, changes: dict, message: str
):
    settings = TrainSettings(**{**vars(SETTINGS), **changes})
    with pytest.raises(ArtigenError, match=message):
        train(what, tmp_path / "run", settings, workers=1)
    assert not (tmp_path / "run").exists()


def test_a_run_begins_with_the_weights_of_a_model_and_says_so(run: Path, tmp_path: Path):
    shutil.copytree(run / "train", tmp_path / "new" / "train")
    shutil.copytree(run / "held_out", tmp_path / "new" / "held_out")
    settings = replace(SETTINGS, minutes=1e-9, start=run / "model")  # one step, of 2e-4 in every weight
    assert train("structure-vae", tmp_path / "new", settings, workers=1) == 0
    said = json.loads((tmp_path / "new" / "model" / "model.json").read_text())["vae"]
    before = json.loads((run / "model" / "model.json").read_text())["vae"]
    assert said == {"preset": "tiny", "steps": 1, "objects": 2, "real_objects": 0, "start": before}
    old, new = (read_tensors(folder / "model" / "vae-0.safetensors") for folder in (run, tmp_path / "new"))
    moved = max(float((old[name].float() - new[name].float()).abs().max()) for name in old)
    assert 1e-4 < moved < 1e-3
    with pytest.raises(SourceError, match="started with start"):
        train("structure-vae", tmp_path / "new", replace(settings, start=None), workers=1)


def test_a_run_is_not_gone_on_with_as_another(run: Path, partnet: Path):
    settings = replace(SETTINGS, partnet=partnet, preset="compact")
    with pytest.raises(SourceError, match=r"started with preset 'tiny' \(now 'compact'\)"):
        train("structure", run, settings, workers=1)


def test_the_command_knows_every_preset():
    assert get_args(get_type_hints(TrainSettings)["preset"]) == tuple(PRESETS)


COARSE = EvaluateConfig(
    held_out=7,
    training=7,
    steps=2,
    strength=3.0,
    image_size=32,
    score=ScoreConfig(per_part=50, points=300, poses=InstantiationConfig(poses=2, points=40)),
    workers=1,
)


@pytest.fixture(scope="module")
def sparse(run: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The model with a decoder that finds no cell occupied, which is refused faster than noise is."""
    folder = Path(shutil.copytree(run / "model", tmp_path_factory.mktemp("models") / "model"))
    vae = StructureVae(PRESETS["tiny"].vae)
    load_model(vae, folder, "vae")
    with torch.no_grad():
        vae.get_parameter("decoder.occupancy_head.2.bias").fill_(-1000.0)
    save_model(vae, folder, {"preset": "tiny"}, "vae")
    return folder


def few_shapes() -> ShapeSource:
    """Objects of the grammar, the first that has the lengths asked for."""
    return grammar_source(tries=2)


@pytest.fixture(scope="module")
def evaluation(
    sparse: Path, partnet: Path, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Evaluation]:
    out = tmp_path_factory.mktemp("evaluations") / "out"

    def read_here(folder, split, resolution, *, image_size, workers):
        """Without the process of its own, which the run above has tried."""
        job = RealJob(folder=list_split(folder, split)[0], resolution=resolution, image_size=image_size)
        asset, example = read_real(job)
        return [Subject(asset=asset, example=example)], {"other": "not there"}

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(artigen.metrics.evaluate, "read_subjects", read_here)
        cfg = replace(COARSE, partnet=partnet, packages=2, redraws=1)
        found = evaluate_structure(
            sparse,
            out,
            cfg,
            prove=lambda folders: pytest.fail("there is no object"),
            draw_shape_for=few_shapes(),
        )
    write_report(found, out)
    return out, found


def test_an_evaluation_has_every_row_and_is_written(evaluation: tuple[Path, Evaluation]):
    out, found = evaluation
    assert {(row.ask, row.method) for row in found.rows} == {
        ("category", "model"),
        ("category", "training set"),
        ("category", "held-out set"),
        *((ask, method) for ask in ("counts and size", "picture") for method in ("model", "retrieval")),
        ("counts and size", "reconstruction"),
        *(("real: counts and size", method) for method in ("model", "retrieval", "reconstruction")),
        *(("real: picture", method) for method in ("model", "retrieval")),
    }
    by_place = {(row.ask, row.method): row.scores for row in found.rows}
    assert by_place["category", "training set"]["valid"] == 1.0
    assert by_place["counts and size", "retrieval"]["strict_articulated"] > 0
    assert by_place["picture", "model"].keys() >= {"valid", "category", "counts", "strict_rest"}
    assert set(found.reconstruction) == set(found.spread) == {"procedural", "real"}
    assert json.loads((out / "evaluation.json").read_text())["rows"] == json.loads(
        json.dumps([asdict(row) for row in found.rows])
    )
    assert found.packages is not None
    assert (found.packages.scores["all"].valid, found.packages.scores["all"].draws) == (0.0, 2.0)
    table = (out / "evaluation.md").read_text()
    assert "| all | 2 | 0.00 % | 0.00 % | 0.00 % | 2.00 |" in table
    assert "| no object: no voxel was drawn for" in table
    assert "| occupancy recall |" in table
    assert "- other: not there" in table
    assert "| counts and size | retrieval | 7 |" in table


def test_draws_are_kept_and_belong_to_their_model(
    evaluation: tuple[Path, Evaluation], sparse: Path, run: Path
):
    out, found = evaluation
    journal = (out / "draws" / "draws.jsonl").read_text()
    assert len(journal.splitlines()) == 3 * 7 + 2 + 2  # real ones, and two drawn again
    again = evaluate_structure(sparse, out, COARSE, draw_shape_for=few_shapes())
    assert (out / "draws" / "draws.jsonl").read_text() == journal
    assert again.rows == tuple(row for row in found.rows if not row.ask.startswith("real"))
    with pytest.raises(SourceError, match="was started with model"):
        evaluate_structure(run / "model", out, COARSE, draw_shape_for=few_shapes())


def test_a_draw_is_made_once_and_read_again(
    run: Path, cabinet: Asset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    drawn = []

    def from_memory(model, asked, seed, cfg, *, boxes):
        drawn.append(seed)
        if seed % 2:
            raise SegmentationError("nothing there")
        return replace(cabinet, surface=None)

    def draw_oven(asked: StructureCondition, seed: int) -> Shape:
        return draw_shape("Oven", seed)

    monkeypatch.setattr(artigen.metrics.draws, "generate_structure", from_memory)
    model = load_structure_model(run / "model")
    jobs = [DrawJob(key=f"one_{seed}", asked=StructureCondition(), seed=seed) for seed in range(3)]
    make = draw_latent(model, draw_oven, GenerateConfig())
    first = draw_all(jobs[:2], tmp_path, make)
    with (tmp_path / "draws.jsonl").open("a") as journal:
        journal.write('{"key": "one_2", "sec')  # a session that was killed while it wrote
        journal.write("\n")
    again = draw_all(jobs, tmp_path, make)
    assert drawn == [0, 1, 2]
    assert [draw.error for draw in again] == [None, "nothing there", None]
    assert first[1].seconds == again[1].seconds
    for draw in (first[0], again[0], again[2]):
        assert draw.asset is not None
        assert draw.asset.voxels is not None
        assert cabinet.voxels is not None
        assert (draw.asset.voxels.part_ids == cabinet.voxels.part_ids).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"held_out": 6}, "6 held-out objects: expected at least 7"),
        ({"training": 0}, "0 training objects"),
        ({"steps": 0}, "at least one step"),
        ({"partnet": Path("nowhere")}, "splits.json: cannot be read"),
    ],
)
def test_what_cannot_be_measured_is_said_and_nothing_written(
    run: Path, tmp_path: Path, changes: dict, message: str
):
    with pytest.raises(ArtigenError, match=message):
        evaluate("structure", tmp_path / "out", run / "model", EvaluateSettings(**changes))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda folder: (folder / "model.json").unlink(), "no such model"),
        (lambda folder: (folder / "model.json").write_text("[1]"), "expected an object with an object"),
        (lambda folder: (folder / "model.json").write_text('{"flow": {"preset": "huge"}}'), "preset 'huge'"),
        (lambda folder: (folder / "flow-0.safetensors").write_bytes(b"x"), "no complete safetensors"),
        (lambda folder: (folder / "vae-0.safetensors").unlink(), r"holds no vae-\*"),
    ],
)
def test_a_folder_that_is_no_model_is_named(run: Path, tmp_path: Path, spoil, message: str):
    folder = shutil.copytree(run / "model", tmp_path / "model")
    spoil(folder)
    with pytest.raises(SourceError, match=message):
        evaluate("structure", tmp_path / "out", folder)
    assert not (tmp_path / "out").exists()


def test_a_claimed_folder_takes_the_same_settings_only(tmp_path: Path):
    path = tmp_path / "new" / "settings.json"
    claim_folder(path, {"seed": 1, "steps": 2})
    claim_folder(path, {"steps": 2, "seed": 1})
    with pytest.raises(SourceError, match=r"seed 1 \(now 3\)"):
        claim_folder(path, {"seed": 3, "steps": 2})
    path.write_text("{")
    with pytest.raises(SourceError, match="no JSON"):
        claim_folder(path, {"seed": 1})
