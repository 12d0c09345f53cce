"""Objects are rebuilt from finer voxels until their package passes; what needs no voxels is made once."""

from pathlib import Path

import pytest

from artigen.cli import convert, grids, shape
from artigen.cli.batch import Finished
from artigen.cli.convert import ConvertJob, ConvertSettings, convert_and_validate
from artigen.cli.grids import GRIDS
from artigen.cli.shape import ShapeJob, ShapeSettings, export_and_validate
from artigen.runtime.workers import Outcome, Worker


def drawn(source):
    job = ShapeJob(category="Cart", seed=0, out=Path("out"), cfg=ShapeSettings(source=source))
    return export_and_validate(Worker(), job)


def converted(source):
    visual = "voxels" if source == "voxels" else "source"
    job = ConvertJob(source=Path("cart"), out=Path("out"), cfg=ConvertSettings(visual=visual))
    return convert_and_validate(Worker(), job, 1.0)


class Judge:
    """Says which grids give a package that passes, or none at all."""

    def __init__(self, passing: int | None, broken: tuple[int, ...]):
        self.passing, self.broken, self.tried = passing, broken, []

    def __call__(self, worker, job, make, **_) -> Finished:
        self.tried.append(job.grid)
        if job.grid in self.broken:
            return Finished(key="cart", settings=str(job.grid), error="cannot be exported")
        passed = self.passing is not None and job.grid >= self.passing
        failures = () if passed else (f"V103 lost at {job.grid}",)
        return Finished(key="cart", settings=str(job.grid), passed=passed, failures=failures)


@pytest.fixture
def judged(monkeypatch: pytest.MonkeyPatch):
    """Replaces the making of packages by a judge."""

    def use(passing: int | None, broken: tuple[int, ...] = ()) -> Judge:
        judge = Judge(passing, broken)
        for module in (grids, shape, convert):
            monkeypatch.setattr(module, "make_and_validate", judge)
        monkeypatch.setattr(Worker, "call", lambda *_: Outcome(value=()))
        return judge

    return use


@pytest.mark.parametrize("make", [drawn, converted])
@pytest.mark.parametrize("passing", [*GRIDS, None])
@pytest.mark.parametrize("broken", [(), GRIDS[:1], GRIDS[:2]])
def test_an_object_is_rebuilt_on_finer_grids_until_it_passes(judged, make, passing, broken):
    judge = judged(passing, broken)
    finished = make("voxels")
    best = next((grid for grid in GRIDS if passing and grid >= passing and grid not in broken), None)
    assert judge.tried == [grid for grid in GRIDS if best is None or grid <= best]
    assert finished.settings == str(best or GRIDS[-1])
    assert finished.good == (best is not None)
    assert bool(finished.notes) == (len(judge.tried) > 1)


@pytest.mark.parametrize("make", [drawn, converted])
def test_a_package_that_fails_is_kept_where_finer_voxels_give_none(judged, make):
    judge = judged(None, GRIDS[1:])
    finished = make("voxels")
    assert judge.tried == list(GRIDS[:2])
    assert finished.settings == str(GRIDS[0])
    assert finished.error is None
    assert "cannot be exported" in finished.notes[-1]


@pytest.mark.parametrize("make", [drawn, converted])
def test_what_needs_no_voxels_is_made_once(judged, make):
    judge = judged(None)
    assert not make("reference").good
    assert len(judge.tried) == 1
