"""Draws as packages, and beside their nearest training objects: counting, going on, and pictures."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

import artigen.cli.prove
import artigen.metrics.draws
from artigen.cli.batch import Finished
from artigen.cli.prove import prove_assets
from artigen.errors import SegmentationError
from artigen.latent.draw import GenerateConfig, StructureModel, build_structure_model
from artigen.latent.presets import PRESETS
from artigen.metrics.draws import DrawJob, draw_latent
from artigen.metrics.instantiation import InstantiationConfig
from artigen.metrics.neighbours import Neighbour, draw_neighbours, find_neighbours, pose_library
from artigen.metrics.packages import JOURNAL, Proof, count_proofs, name_cause, prove_draws
from artigen.metrics.subjects import draw_subjects
from artigen.metrics.voxel_pictures import draw_voxels, list_squares
from artigen.models.conditions import StructureCondition
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.types import Asset, VoxelGrid

POSES = InstantiationConfig(poses=2, points=60)


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

    monkeypatch.setattr(artigen.cli.prove, "make_and_validate", from_memory)
    proofs = prove_assets([tmp_path / key for key in said], out=tmp_path / "packages", workers=1)
    assert {proof.key: (proof.passed, proof.causes) for proof in proofs} == {
        "good": (True, ()),
        "bad": (False, ("V103", "V301")),
        "none": (False, ("no package: part door_# has # faces",)),
    }


def test_the_nearest_training_object_of_one_of_them_is_itself():
    library = draw_subjects(("Oven", "Microwave"), 10_000, 8, resolution=32, image_size=0)
    posed = pose_library(library, POSES)
    chosen = library[3].asset
    found = find_neighbours(chosen, posed, POSES, 3)
    assert found[0].asset is chosen
    assert found[0].distance == 0.0
    assert [one.asset.category for one in found] == [chosen.category] * 3
    assert 0.0 < found[1].distance <= found[2].distance
    assert find_neighbours(replace(chosen, category="Table"), posed, POSES, 3) == []


def test_squares_are_the_outside_of_each_part():
    def count(coords: list[list[int]], part_ids: list[int]) -> list[int]:
        grid = VoxelGrid(resolution=8, coords=np.array(coords), part_ids=np.array(part_ids))
        squares, owners = list_squares(grid)
        assert (np.ptp(squares, axis=1).max(axis=1) == 1 / 8).all()
        return np.bincount(owners).tolist()

    assert count([[0, 0, 0]], [0]) == [6]
    assert count([[3, 3, 3], [4, 3, 3]], [0, 0]) == [10]
    assert count([[3, 3, 3], [4, 3, 3]], [0, 1]) == [6, 6]
    assert count([[7, 7, 7], [0, 0, 0]], [0, 0]) == [12]


def test_a_sheet_shows_objects_closed_and_open_in_the_colours_of_their_parts(cabinet: Asset):
    asset = replace(cabinet, surface=None)
    closed, opened = (draw_voxels(asset, share, 48) for share in (0.0, 0.7))
    assert closed.shape == (48, 48, 3)
    larger = draw_voxels(replace(asset, scale=3.0 * asset.scale), 0.0, 48)
    assert ((larger < 250).any(axis=2) == (closed < 250).any(axis=2)).mean() > 0.99
    assert (closed[0] == 255).all()
    assert (closed != opened).any(axis=2).mean() > 0.1
    seen = closed[(closed < 250).any(axis=2)].astype(int)
    assert np.ptp(seen, axis=1).max() > 40  # fronts have a colour, the base has none
    assert np.ptp(seen, axis=1).min() < 8
    sheet = draw_neighbours([(asset, [Neighbour(asset=asset, distance=0.0)]), (asset, [])], 32)
    assert sheet.shape == (2 * (32 + 14), 2 * 2 * 32, 3)
    assert (sheet[46:, 64:] == 255).all()
    with pytest.raises(ValueError, match="at least one row"):
        draw_neighbours([])
