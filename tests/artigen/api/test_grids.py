"""Laws of rebuilding: on finer grids until a package passes, never at the price of a package that exists."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from artigen.api import convert, grids, sample
from artigen.api.batch import Finished
from artigen.api.convert import ConvertJob, ConvertSettings
from artigen.api.sample import ShapeJob, ShapeSettings
from artigen.datasets import sources
from artigen.runtime.workers import Worker

ALL = (64, 96, 128)


def judge_by(monkeypatch, verdicts: dict[int, bool | None]) -> list[int]:
    """Packages that pass, fail or cannot be made (None) by their grid; returns the grids that are tried."""
    tried = []

    def judge(worker, job, make, **_):
        tried.append(job.grid)
        found = Finished(key=job.key, settings="")
        passed = verdicts[job.grid]
        if passed is None:
            return replace(found, error=f"{job.grid} cannot be made")
        return replace(found, passed=passed, failures=() if passed else (f"V103 at {job.grid}",))

    monkeypatch.setattr(grids, "make_and_validate", judge)
    return tried


def shape_voxels():
    job = ShapeJob(category="Cart", seed=0, out=Path("out"), cfg=ShapeSettings(source="voxels"))
    return sample.export_and_validate(Worker(), job)


def convert_voxels():
    job = ConvertJob(source=Path("cart"), out=Path("out"), cfg=ConvertSettings(visual="voxels"))
    return convert.convert_and_validate(Worker(), job, timeout=1.0)


@pytest.mark.parametrize("run", [shape_voxels, convert_voxels])
@pytest.mark.parametrize("passing", [*ALL, None])
@pytest.mark.parametrize("before", [False, None])
def test_an_object_is_rebuilt_on_finer_grids_until_it_passes(monkeypatch, run, passing, before):
    monkeypatch.setattr(ConvertJob, "key", "cart")
    monkeypatch.setattr(Worker, "call", lambda *_: SimpleNamespace(value=()))
    tried = judge_by(
        monkeypatch, {grid: True if passing is not None and grid >= passing else before for grid in ALL}
    )
    finished = run()
    assert tried == [grid for grid in ALL if passing is None or grid <= passing]
    assert finished.good == (passing is not None)
    assert bool(finished.notes) == (len(tried) > 1)


def test_what_cannot_be_made_on_a_finer_grid_stays_as_the_coarser_one_made_it(monkeypatch):
    judge_by(monkeypatch, {64: False, 96: None, 128: None})
    finished = shape_voxels()
    assert finished.error is None
    assert finished.failures == ("V103 at 64",)
    assert finished.notes == tuple(
        f"not made from {grid}^3 voxels: {grid} cannot be made" for grid in (96, 128)
    )


def test_what_cannot_be_read_says_so_once(monkeypatch):
    broken = Finished(key="cart", settings="", error="no meshes")
    monkeypatch.setattr(grids, "make_and_validate", lambda *_, **__: broken)
    assert shape_voxels() == broken


def test_of_packages_that_fail_the_finest_is_kept(monkeypatch):
    judge_by(monkeypatch, {64: None, 96: False, 128: False})
    finished = shape_voxels()
    assert finished.failures == ("V103 at 128",)
    assert finished.notes == ("made from 128^3 voxels, as coarser ones fail: V103 at 96",)


def test_objects_with_their_own_meshes_are_made_once(monkeypatch):
    monkeypatch.setattr(ConvertJob, "key", "cart")
    monkeypatch.setattr(Worker, "call", lambda *_: SimpleNamespace(value=()))
    tried = judge_by(monkeypatch, {64: False})
    convert.convert_and_validate(Worker(), ConvertJob(source=Path("cart"), out=Path("out")), timeout=1.0)
    assert tried == [64]


@pytest.mark.parametrize("grid", ALL)
def test_finer_grids_have_as_many_samples_per_cell(monkeypatch, tmp_path, grid):
    found = []
    monkeypatch.setattr(sources, "read_source", lambda _, __, reader: found.append(reader.samples))
    ConvertJob(source=Path("cart"), out=tmp_path, grid=grid).read(tmp_path)
    assert found == [600_000 * (grid / 64) ** 2]
