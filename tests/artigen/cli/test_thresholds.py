"""Limits of the commands: times, and how often something is drawn."""

from dataclasses import replace
from pathlib import Path

import pytest

from artigen.api.batch import Made
from artigen.api.dataset import _Chosen, _give_up, _Pool
from artigen.api.dataset_objects import ObjectJob, make_and_pack
from artigen.api.evaluate import ProveJob, _prove
from artigen.api.generate import GenerateJob, GenerateSettings, draw_generated, generate_and_validate
from artigen.api.sample import ShapeJob, ShapeSettings, export_and_validate
from artigen.datasets.recipe import Entry, RecipeError
from artigen.errors import ArtigenError
from artigen.runtime.workers import Outcome, Worker
from artigen.sketch.model import SketchConfig
from artigen.weights import SHIPPED

OUT = Path("out")


class TimedWorker(Worker):
    """Makes nothing; keeps the time limits that it is given. Its first calls have outcomes of their own."""

    def __init__(self, *outcomes: Outcome) -> None:
        super().__init__()
        self.outcomes, self.limits = list(outcomes), list[float]()

    def call(self, function: object, item: object, timeout: float) -> Outcome:
        self.limits.append(timeout)
        return self.outcomes.pop(0) if self.outcomes else Outcome(error="nothing")


SHAPE_JOB = ShapeJob(category="Safe", seed=0, out=OUT, cfg=ShapeSettings(validation="none"))
GENERATE_JOB = GenerateJob(model=SHIPPED, category="Safe", seed=0, out=OUT)


def test_every_object_has_five_minutes_for_a_stage():
    worker = TimedWorker()
    export_and_validate(worker, SHAPE_JOB)
    generate_and_validate(worker, replace(GENERATE_JOB, cfg=GenerateSettings(redraws=0)))
    _prove(worker, ProveJob(source=OUT, out=OUT))
    assert worker.limits == [300.0, 300.0, 300.0]


def test_a_made_object_has_five_minutes_to_be_packed(tmp_path):
    worker = TimedWorker(Outcome(value=Made(seconds=(), peak_mib=0.0, notes=())))
    job = ObjectJob(inner=SHAPE_JOB, out=tmp_path, validation=False, thumbnail=192)
    assert make_and_pack(worker, job).error == "nothing"
    assert worker.limits == [300.0, 300.0]


def test_an_object_that_fails_is_drawn_three_times_more():
    worker = TimedWorker()
    assert "4 draws" in generate_and_validate(worker, GENERATE_JOB).notes
    assert len(worker.limits) == 4


def test_sketches_are_drawn_at_a_temperature_of_six_tenths(monkeypatch):
    found: list[SketchConfig] = []
    monkeypatch.setattr("artigen.api.generate.load_sketch", lambda _: None)

    def stop(*given: SketchConfig) -> None:
        found.append(given[-1])
        raise ArtigenError("stop")

    monkeypatch.setattr("artigen.sketch.model.draw_object", stop)
    with pytest.raises(ArtigenError, match="stop"):
        draw_generated(GENERATE_JOB)
    assert found[0].draw.temperature == 0.6


def test_an_entry_is_given_up_after_ten_more_than_twice_its_objects():
    entry = Entry(name="safes", category="Safe", count=5)
    pool = _Pool(entry=entry, by_model=False, count=5)
    chosen = _Chosen(ids=(), full=frozenset(), duplicates=(), failures=(), missing=(5,))
    _give_up(pool, 20, chosen, OUT)
    with pytest.raises(RecipeError, match="request fewer"):
        _give_up(pool, 21, chosen, OUT)
