"""Draws as packages: counting, and going on."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
import torch

import artigen.api.evaluate
import artigen.metrics.draws
from artigen.api.batch import Finished
from artigen.api.evaluate import prove_assets
from artigen.errors import SegmentationError
from artigen.latent.draw import GenerateConfig, StructureModel, build_structure_model
from artigen.latent.presets import PRESETS
from artigen.metrics.draws import DrawJob, draw_latent
from artigen.metrics.packages import JOURNAL, Proof, count_proofs, name_cause, prove_draws
from artigen.models.conditions import StructureCondition
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.types import Asset


@pytest.fixture(scope="module")
def model() -> StructureModel:
    torch.manual_seed(0)
    return build_structure_model(PRESETS["tiny"])


def passed(key: str) -> Proof:
    return Proof(key=key, passed=True)


def failed(key: str, *causes: str) -> Proof:
    return Proof(key=key, passed=False, causes=causes)


def test_shares_are_of_objects_and_causes_of_draws():
    report = count_proofs(
        [
            ("Oven", [passed("a")]),
            ("Oven", [failed("b", "V103", "V201"), failed("b1", "V103"), passed("b2")]),
            ("Table", [failed("c", name_cause("no object", "none of 12 voxels")), failed("c1", "V103")]),
        ],
        redraws=2,
    )
    assert list(report.scores) == ["Oven", "Table", "all"]
    oven, table, everything = report.scores.values()
    assert (oven.objects, oven.valid, oven.first, oven.within, oven.draws) == (2, 1.0, 0.5, 1.0, 2.0)
    assert (table.valid, table.first, table.within) == (0.0, 0.0, 0.0)
    assert everything.within == pytest.approx(2 / 3)
    assert report.first_causes == {"V103": 1, "V201": 1, "no object: none of # voxels": 1}
    assert next(iter(report.causes.items())) == ("V103", 3)


def test_only_what_fails_is_drawn_again_and_nothing_is_done_twice(
    model: StructureModel, cabinet: Asset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    drawn, proven = [], []

    def from_memory(model, asked, seed, cfg, *, boxes):
        drawn.append(seed)
        if seed == 3:
            raise SegmentationError("none of 7 voxels is labelled base")
        return replace(cabinet, surface=None)

    def draw_oven(asked: StructureCondition, seed: int) -> Shape:
        return draw_shape("Oven", 0)

    def prove(folders: Sequence[Path]):
        """The first draw of 0 and every later one of 3 passes; of 1 none does."""
        for folder in reversed(folders):
            assert (folder / "asset.json").is_file() or any(folder.iterdir())
            proven.append(folder.name)
            good = not folder.name.startswith("one_1")
            yield Proof(key=folder.name, passed=good, causes=() if good else ("V103",))

    monkeypatch.setattr(artigen.metrics.draws, "generate_structure", from_memory)
    asked = StructureCondition(category="Oven")
    jobs = [DrawJob(key=f"one_{seed}", asked=asked, seed=seed) for seed in (0, 1, 3)]
    make = draw_latent(model, draw_oven, GenerateConfig())
    report = prove_draws(jobs, tmp_path, make, prove, redraws=2)
    assert proven == ["one_1", "one_0", "one_3_again_1", "one_1_again_1", "one_1_again_2"]
    assert len(set(drawn)) == len(drawn) == 6  # every draw has noise of its own
    scores = report.scores["all"]
    assert (scores.valid, scores.first) == (pytest.approx(2 / 3), pytest.approx(1 / 3))
    assert (scores.within, scores.draws) == (pytest.approx(2 / 3), pytest.approx(2.0))
    assert report.causes == {"V103": 3, "no object: none of # voxels is labelled base": 1}
    journal = (tmp_path / JOURNAL).read_text()
    assert prove_draws(jobs, tmp_path, make, prove, redraws=2) == report
    assert (len(proven), len(drawn)) == (5, 6)
    lines = journal.splitlines(keepends=True)
    (tmp_path / JOURNAL).write_text("".join(lines[:-1]) + lines[-1][:9])  # killed while it wrote
    for _ in range(2):
        assert prove_draws(jobs, tmp_path, make, prove, redraws=2) == report
        assert (proven[5:], len(drawn)) == (["one_1_again_2"], 6)


def test_a_package_fails_for_its_checks_or_for_what_kept_it_from_being_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    said = {
        "good": {"passed": True},
        "bad": {"passed": False, "failures": ("V301 link_0: 3 mm", "V103 base: open", "V301 link_1: 4 mm")},
        "none": {"error": "part door_0 has 12 faces"},
    }

    def from_memory(worker, job, make, *, timeout, validation):
        assert validation
        assert job.source == tmp_path / job.key
        return Finished(key=job.key, settings="", **said[job.key])

    monkeypatch.setattr(artigen.api.evaluate, "make_and_validate", from_memory)
    proofs = prove_assets([tmp_path / key for key in said], out=tmp_path / "packages", workers=1)
    assert {proof.key: (proof.passed, proof.causes) for proof in proofs} == {
        "good": (True, ()),
        "bad": (False, ("V103", "V301")),
        "none": (False, ("no package: part door_# has # faces",)),
    }
