"""Laws of `artigen shape`: objects are rebuilt from finer voxels until their package passes."""

from pathlib import Path

import pytest

from artigen.cli import shape
from artigen.cli.batch import Finished
from artigen.cli.shape import GRIDS, ShapeJob, ShapeSettings, export_and_validate, make_package
from artigen.runtime.workers import Worker
from artigen.shapes.draw import draw_shape


@pytest.mark.parametrize("passing", [*GRIDS, None])
@pytest.mark.parametrize("broken", [False, True])
def test_an_object_is_rebuilt_on_finer_grids_until_it_passes(monkeypatch, passing, broken):
    tried = []

    def judge(worker, job, make, **_):
        tried.append(job.grid)
        passed = passing is not None and job.grid >= passing
        if broken and not passed:
            return Finished(key=job.key, settings="", error="cannot be exported")
        return Finished(key=job.key, settings="", passed=passed, failures=() if passed else ("V103 lost",))

    monkeypatch.setattr(shape, "make_and_validate", judge)
    job = ShapeJob(category="Cart", seed=0, out=Path("out"), cfg=ShapeSettings(source="voxels"))
    finished = export_and_validate(Worker(), job)
    assert tried == [grid for grid in GRIDS if passing is None or grid <= passing]
    assert finished.good == (passing is not None)
    assert bool(finished.notes) == (len(tried) > 1)


def test_exact_objects_are_made_once(monkeypatch):
    failed = Finished(key="Cart_0", settings="", passed=False)
    monkeypatch.setattr(shape, "make_and_validate", lambda *_, **__: failed)
    assert export_and_validate(Worker(), ShapeJob(category="Cart", seed=0, out=Path("out"))) is failed


def test_a_finer_grid_keeps_a_thin_part():
    """The screen of a laptop is thinner than two cells of the coarsest grid."""
    drawn = draw_shape("Laptop", 0)
    heights = []
    for grid in (GRIDS[0], GRIDS[-1]):
        package = make_package(drawn, "voxels", grid=grid)
        assert dict(package.provenance)["grid"] == str(grid)
        lid = next(link for link in package.links if "screen" in link.parts)
        points = [corner for hull in lid.hulls for corner in hull.vertices]
        heights.append(max(p[2] for p in points) - min(p[2] for p in points))
    low, high = next(part for part in drawn.parts if part.name == "screen").bounds()[:, 2]
    assert abs(heights[1] - (high - low)) < abs(heights[0] - (high - low))
