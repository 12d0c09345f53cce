"""Metrics of pictures in closed form, and a whole appearance run: trained, stored, measured."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from artigen.api.evaluate import evaluate_model
from artigen.api.train import AppearanceSettings, prepare_training
from artigen.appearance.curation import CurationConfig
from artigen.appearance.features import PyramidFeatures
from artigen.appearance.photographs import NOTHING
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.views import ViewConfig
from artigen.errors import ArtigenError, SourceError
from artigen.examples.appearance import draw_appearance, write_appearance_shard
from artigen.examples.shards import HELD_OUT
from artigen.kind import paper_kinds
from artigen.metrics.appearance import (
    Comparison,
    color_error,
    mean_colors,
    score_comparisons,
    score_distances,
    score_sets,
    split_states,
)
from artigen.metrics.pictures import frechet_distance, kernel_distance, measure_psnr, measure_ssim, ssim_map
from artigen.metrics.settings import AppearanceViews, EvaluateSettings
from artigen.models.store import load_model
from artigen.splats.render.splats import Splats
from artigen.train.loop import finished_steps
from artigen.train.settings import TrainSettings
from artigen.types import SurfaceSamples
from artigen.weights import SHIPPED

pytestmark = pytest.mark.slow


@pytest.fixture
def pictures() -> torch.Tensor:
    return torch.rand(3, 24, 20, 3, generator=torch.Generator().manual_seed(0))


def test_psnr_of_a_known_error_and_of_a_region(pictures: torch.Tensor):
    assert measure_psnr(pictures, pictures) == np.inf
    half = 0.5 * torch.ones(2, 8, 8, 3)
    assert measure_psnr(half + 0.1, half) == pytest.approx(20.0, abs=1e-4)
    assert measure_psnr(half + 2.0, half) == pytest.approx(-20 * np.log10(0.5), abs=1e-4)
    mask = torch.zeros(2, 8, 8, dtype=torch.bool)
    assert np.isnan(measure_psnr(half, half, mask))
    mask[0, 3, 3] = True
    wrong = half.clone()
    wrong[0, 3, 3] += 0.01
    wrong[1] += 0.4
    assert measure_psnr(wrong, half, mask) == pytest.approx(40.0, abs=1e-3)


def test_ssim_is_one_for_equals_and_its_closed_form_for_flat_pictures(pictures: torch.Tensor):
    assert measure_ssim(pictures, pictures) == pytest.approx(1.0)
    dark, light = torch.full((1, 16, 16, 3), 0.2), torch.full((1, 16, 16, 3), 0.6)
    expected = (2 * 0.2 * 0.6 + 1e-4) / (0.2**2 + 0.6**2 + 1e-4)
    assert measure_ssim(dark, light) == pytest.approx(expected, abs=1e-5)
    first = pictures.permute(0, 3, 1, 2)
    assert ssim_map(first, first).shape == (3, 3, 14, 10)
    assert measure_ssim(1.0 - pictures, pictures) < 0


def test_frechet_distance_of_shifted_and_stretched_sets():
    rng = np.random.default_rng(0)
    base = rng.normal(size=(400, 3))
    shift = np.array([1.0, -2.0, 0.5])
    assert frechet_distance(base, base) == pytest.approx(0.0, abs=1e-6)
    assert frechet_distance(base + shift, base) == pytest.approx((shift**2).sum(), abs=1e-6)
    variance = np.trace(np.cov(base, rowvar=False))
    assert frechet_distance(3.0 * base, 3.0 * base.mean(axis=0) + base - base.mean(axis=0)) == pytest.approx(
        4.0 * variance, rel=1e-6
    )


def test_kernel_distance_is_unbiased_and_has_its_closed_form():
    first, second = np.array([[1.0], [1.0]]), np.array([[0.0], [0.0], [0.0]])
    assert kernel_distance(first, second) == pytest.approx(8.0 + 1.0 - 2.0)
    rng = np.random.default_rng(0)
    same = [kernel_distance(rng.normal(size=(12, 4)), rng.normal(size=(12, 4))) for _ in range(300)]
    assert abs(np.mean(same)) < 3 * np.std(same) / 300**0.5
    assert min(same) < 0
    with pytest.raises(ValueError, match="at least two"):
        kernel_distance(first[:1], second)


def test_colours_of_parts_are_compared_part_by_part():
    parts = np.full((1, 8, 8), NOTHING, dtype=np.uint8)
    parts[0, :4], parts[0, 4:, :2], parts[0, 4:, 7] = 0, 1, 2
    rgb = np.zeros((1, 8, 8, 3))
    rgb[parts == 0] = (0.2, 0.4, 0.6)
    rgb[0, 0, 0] = (0.2 + 32 * 0.1, 0.4, 0.6)
    found = mean_colors(rgb, parts)
    assert sorted(found) == [0]  # eight and four pixels are too few
    assert found[0] == pytest.approx([0.3, 0.4, 0.6])
    truth = {0: np.zeros(3), 1: np.ones(3)}
    assert color_error({0: np.full(3, 0.2), 1: np.ones(3), 2: np.zeros(3)}, truth) == pytest.approx(0.1)
    with pytest.raises(ValueError, match="expected those of"):
        color_error({0: np.zeros(3)}, truth)


def test_distances_move_gaussians_and_surface_with_their_parts():
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.5, 0.5, (4000, 3))
    part_ids = np.arange(2000) % 2
    surface = SurfaceSamples(
        points=points,
        normals=points,
        colors=np.zeros((4000, 3), dtype=np.uint8),
        part_ids=np.repeat(part_ids, 2),
    )
    fields = {"quats": torch.ones(4000, 4), "scales": torch.ones(4000, 3), "colors": torch.ones(4000, 3)}
    kept = torch.ones(4000)
    kept[2000:] = 0.0  # never drawn
    moved = np.tile(np.eye(4), (2, 2, 1, 1))
    moved[1, 1, 0, 3] = 5.0

    def score(shift: float) -> dict[str, float]:
        means = torch.from_numpy(points + np.array([shift, 0.0, 0.0])).float()
        splats = Splats(means=means, opacities=kept, **fields)
        return score_distances(splats, part_ids, surface, moved, points=3000)

    same, off = score(0.0), score(20.0)
    assert 0 < same["shape_rest"] < 0.01
    # Apart, both parts are half as dense as together.
    thinner = (1.0 + 2.0 ** (2.0 / 3.0)) / 2.0
    assert same["shape_articulated"] == pytest.approx(thinner * same["shape_rest"], rel=0.1)
    assert off["shape_rest"] == pytest.approx(2 * 20.0**2, rel=0.1)
    with pytest.raises(ValueError, match="4000 Gaussians for 3 voxels"):
        score_distances(
            Splats(means=torch.zeros(4000, 3), opacities=kept, **fields), part_ids[:3], surface, moved
        )


def test_regions_and_states_are_scored_apart():
    truth = torch.full((4, 16, 16, 3), 0.5)
    mask = torch.zeros(4, 16, 16, dtype=torch.bool)
    mask[:, 4:12] = True
    exposed = torch.zeros_like(mask)
    exposed[2:, 4:6] = True
    drawn = truth.clone()
    drawn[mask] += 0.1
    drawn[exposed] += 0.9
    shares = torch.tensor([0.0, 0.0, 1.0, 1.0])
    one = Comparison(drawn=drawn, truth=truth, mask=mask, exposed=exposed, fractions=shares)
    scores = score_comparisons([one])
    assert scores["exposed"] == pytest.approx(-20 * np.log10(0.5), abs=1e-3)
    assert scores["rest"] == pytest.approx(20.0, abs=1e-3)
    assert scores["rest"] > scores["object"] > scores["exposed"]
    assert scores["exposed_share"] == pytest.approx(0.125)
    states = split_states([one])
    assert list(states) == [0.0, 1.0]
    closed = score_comparisons(states[0.0])
    assert "exposed" not in closed
    assert closed["object"] == pytest.approx(20.0, abs=1e-3)
    sets = score_sets([one, replace(one, drawn=truth)], PyramidFeatures())
    assert sets["frechet"] > score_sets([replace(one, drawn=truth)] * 2, PyramidFeatures())["frechet"]


TINY = CurationConfig(states=2, views=ViewConfig(count=4, size=24), kept=2)
SETTINGS = TrainSettings(preset="tiny", minutes=0.002, shards=1, held_out=1, objects=2)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run; its shards were there before."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    sided = replace(TINY, sided=True)  # as the preset's encoder reads them
    for name, seed in (("train", HELD_OUT), ("held_out", 0)):
        (folder / "appearance" / name).mkdir(parents=True)
        drawn = [
            draw_appearance(kind, seed, PyramidFeatures(), sided, resolution=32, image_size=32)[1]
            for kind in paper_kinds()[:2]  # those of the first shard
        ]
        write_appearance_shard(folder / "appearance" / name / "shard_00000.npz", drawn)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(APPEARANCE_PRESETS, "tiny", replace(APPEARANCE_PRESETS["tiny"], curation=TINY))
        prepare_training("appearance", folder, SETTINGS, 1)()
    return folder


def test_a_run_leaves_weights_scores_and_what_it_was(run: Path):
    said = json.loads((run / "model" / "model.json").read_text())
    for stage in ("vae", "flow"):
        assert said[f"appearance-{stage}"] == {
            "preset": "tiny",
            "steps": finished_steps(run / "appearance" / stage),
            "objects": 2,
            "articulated": True,
            "weighting": "seen",
            "features": "pyramid",
        }
    tiny = APPEARANCE_PRESETS["tiny"]
    load_model(SlatFlow(tiny.flow, tiny.conditions), run / "model", "appearance-flow")
    scores = json.loads((run / "appearance" / "reconstruction.json").read_text())
    assert scores.keys() >= {"psnr", "ssim", "exposed", "rest"}
    for stage in ("vae", "flow"):
        assert (run / "appearance" / stage / "weights.safetensors").is_file()


def test_a_finished_run_stays_and_is_no_other_run(run: Path):
    before = {path: path.read_bytes() for path in (run / "model").iterdir()}
    prepare_training("appearance-flow", run, SETTINGS, 1)()
    assert {path: path.read_bytes() for path in (run / "model").iterdir()} == before
    with pytest.raises(SourceError, match="articulated"):
        prepare_training("appearance", run, SETTINGS, 1, AppearanceSettings(articulated=False))()


@pytest.mark.parametrize(
    ("what", "changes", "own", "message"),
    [
        ("appearance", {"minutes": 0.0}, {}, "more than 0"),
        ("appearance", {"partnet": Path("nowhere")}, {}, "real objects"),
        ("appearance", {}, {"features": "dinov2"}, "both or neither"),
        ("appearance", {"start": SHIPPED}, {}, "has the sizes of preset 'small'"),
        ("appearance-flow", {}, {}, "train appearance-vae first"),
    ],
)
def test_what_cannot_be_trained_is_said_and_nothing_written(
    tmp_path: Path, what, changes: dict, own: dict, message: str
):
    with pytest.raises(ArtigenError, match=message):
        prepare_training(what, tmp_path / "run", replace(SETTINGS, **changes), 1, AppearanceSettings(**own))()
    assert not (tmp_path / "run").exists()


def test_an_evaluation_names_states_features_and_the_model(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setitem(APPEARANCE_PRESETS, "tiny", replace(APPEARANCE_PRESETS["tiny"], curation=TINY))
    views = AppearanceViews(states=2, views=2)
    settings = EvaluateSettings(held_out=1, steps=2)
    evaluate_model("appearance", tmp_path, run / "model", settings, 1, views)
    found = json.loads((tmp_path / "evaluation.json").read_text())
    assert list(found["states"]) == ["0.00", "1.00"]
    assert found["pictures"] == 4
    assert found["extractor"] == "pyramid-16"
    assert "exposed" not in found["states"]["0.00"]
    assert 0 < found["states"]["1.00"]["exposed_share"] < 1
    table = (tmp_path / "evaluation.md").read_text()
    assert "| joints open by | PSNR (dB) |" in table
    assert "pyramid-16 features" in table
    assert "closed (RS)" in table
    assert 0 < found["total"]["shape_rest"] < 0.01
    assert found["drawn"]["psnr"] > 0
    assert "| given | PSNR (dB) |" in table
    assert found["colors"].keys() == {"autoencoded", "drawn"}
    assert all(0 < error < 1 for error in found["colors"].values())
    (tmp_path / "model.json").write_text("{}")
    with pytest.raises(SourceError, match="holds no appearance-vae"):
        evaluate_model("appearance", tmp_path, tmp_path, EvaluateSettings(held_out=1), 1, views)
