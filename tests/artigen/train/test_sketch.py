"""Training of the sketch network: it learns, goes on where it stopped, and leaves a model that loads."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from sketch_steps import SketchStep, StepLosses

from artigen.errors import ArtigenError, SourceError
from artigen.examples.sketch import (
    TOLD,
    TOLD_HEADS,
    SketchBatch,
    SketchExample,
    draw_batches,
    head_of,
    make_examples,
)
from artigen.examples.sketch_photos import EDGE, NOTHING, PhotoBatch, gather_photos
from artigen.shapes.draw import draw_shape
from artigen.sketch.batch import make_batch
from artigen.sketch.model import load_sketch_network
from artigen.sketch.network import SketchNetwork
from artigen.sketch.picture import CELL, MAX_COUNT, PicturePrediction
from artigen.sketch.request import empty_request
from artigen.sketch.rows import ROW_KINDS, sketch_to_rows
from artigen.sketch.sketch import write_sketch
from artigen.sketch.words import CATEGORIES
from artigen.train.sketch import SIZES, SketchRunConfig, train_sketch
from artigen.train.sketch_losses import (
    HEADER,
    SketchLosses,
    reading_losses,
    sketch_losses,
    spread_spots,
    weigh_fields,
)
from artigen.types import PART_LABELS

NINE = CATEGORIES[:9]


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> list[SketchExample]:
    """Object 3 of nine categories, with photos."""
    return make_examples(
        tmp_path_factory.mktemp("shards"), 3, 1, categories=NINE, count=1, workers=1, photos=True
    )


@pytest.fixture(scope="module")
def photos(examples: list[SketchExample]) -> PhotoBatch:
    return gather_photos([one.photo for one in examples if one.photo is not None])


@pytest.mark.slow
def test_an_object_seen_often_is_learnt_by_heart():
    torch.manual_seed(0)
    network = SketchLosses(SketchNetwork(SIZES["tiny"]))
    rows = make_batch([sketch_to_rows(write_sketch(draw_shape("Safe", 1)))], [empty_request()])
    batch = SketchBatch(rows=rows, photos=None)
    optimizer = torch.optim.AdamW(network.parameters(), lr=3e-3)
    losses = []
    for _ in range(60):
        loss = sum(sketch_losses(network, batch, torch.Generator()).values())
        assert isinstance(loss, torch.Tensor)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(float(loss.detach()))
    assert losses[-1] < 0.1 * losses[0]


def test_batches_hold_objects_of_like_length_and_about_so_many_rows():
    examples = [
        SketchExample(table=sketch_to_rows(write_sketch(draw_shape(category, seed))))
        for category in ("Safe", "Table")
        for seed in range(6)
    ]
    batches = draw_batches(examples, 100, 0)
    again = draw_batches(examples, 100, 0)
    heads = 0
    for _ in range(60):
        batch, same = next(batches), next(again)
        assert batch.photos is None
        assert torch.equal(batch.rows.rows, same.rows.rows)
        assert len(batch.rows.rows) >= 2
        if (batch.rows.rows[..., 0] == ROW_KINDS.index("part")).any():
            assert int(batch.rows.predicted.any(dim=2).sum()) <= 250
        else:
            assert len(batch.rows.rows) == TOLD_HEADS
            heads += 1
    assert heads / 60 == pytest.approx(TOLD, abs=0.1)


def test_the_head_of_a_table_ends_before_the_first_part():
    table = sketch_to_rows(write_sketch(draw_shape("Oven", 3)))
    head = head_of(table)
    assert [ROW_KINDS[kind] for kind in head[:2, 0]] == ["object", "finish"]
    assert ROW_KINDS[table[len(head), 0]] == "part"
    assert "part" not in {ROW_KINDS[kind] for kind in head[:, 0]}


def test_the_weights_of_fields_belong_to_the_header_of_the_object_and_to_nothing_else():
    tables = [sketch_to_rows(write_sketch(draw_shape("Safe", seed))) for seed in (1, 2)]
    for rows in (make_batch(tables[:1], [empty_request()]), make_batch(tables, [empty_request()] * 2)):
        symbols, numbers = weigh_fields(rows)
        found = SketchNetwork(SIZES["tiny"])(rows)
        assert (len(symbols), len(numbers)) == (len(found[0]), len(found[1]))
        count = len(rows.rows)
        assert int((symbols == HEADER).sum()) == (1 + 2 + 7) * count  # kind, category, style, counts
        assert int((numbers == HEADER).sum()) == 3 * count  # extents


@torch.no_grad()
def test_a_step_adds_up_the_weighted_losses_of_its_batches(photos: PhotoBatch):
    torch.manual_seed(0)
    network = SketchNetwork(SIZES["tiny"])
    tables = [sketch_to_rows(write_sketch(draw_shape("Safe", seed))) for seed in range(len(photos.image))]

    def batch(tables: list[np.ndarray], pictures: PhotoBatch | None) -> SketchBatch:
        return SketchBatch(rows=make_batch(tables, [empty_request()] * len(tables)), photos=pictures)

    first = PhotoBatch(**{name: value[:4] for name, value in vars(photos).items()})
    step = {"some": batch(tables[:4], first), "told": batch(tables[2:5], None), "all": batch(tables, photos)}
    weights = {"some": 0.3, "told": 2.0, "all": 0.5}
    found = StepLosses(network, weights)(SketchStep(batches=step))
    for name, one in step.items():
        for term, value in SketchLosses(network)(one).items():
            assert float(found.pop(f"{name} {term}")) == pytest.approx(weights[name] * float(value), rel=1e-4)
    assert not found


def test_maps_that_are_true_cost_less_than_maps_that_miss(photos: PhotoBatch):
    truth = spread_spots(photos, EDGE // CELL)
    assert truth.sum(dim=(2, 3)).sum(dim=1).tolist() == pytest.approx(photos.given.sum(dim=1).tolist())
    labels = 12.0 * torch.nn.functional.one_hot(photos.labels, NOTHING + 1).permute(0, 3, 1, 2).float()
    tokens = torch.zeros(len(truth), 1, 8)
    nothing = torch.zeros(len(truth), 8, MAX_COUNT + 1)
    right = PicturePrediction(
        tokens=tokens,
        density=truth,
        labels=labels,
        counts=nothing,
        category=nothing[:, 0, :9],
        view=photos.view,
    )
    wrong = {
        "parts": replace(right, density=truth.roll(9, dims=3)),
        "in view": replace(right, density=1.2 * truth),
        "labels": replace(right, labels=labels.roll(1, dims=1)),
        "view": replace(right, view=photos.view + 0.1),
    }
    best = reading_losses(right, photos)
    for name, said in wrong.items():
        assert float(reading_losses(said, photos)[name]) > float(best[name]) + 1e-4


@pytest.mark.slow
def test_a_run_goes_on_where_it_was_and_its_model_loads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("artigen.train.sketch.SHARD", 1)
    monkeypatch.setattr("artigen.train.sketch.MEASURED", 3)
    cfg = SketchRunConfig(
        folder=tmp_path, preset="tiny", minutes=0.02, shards=1, rows=120, workers=0, categories=CATEGORIES[:3]
    )
    scores = train_sketch(cfg)
    assert scores["asked_per_field"] > 0
    assert scores["pictured_per_field"] > 0
    network = load_sketch_network(tmp_path / "model")
    assert network.cfg == SIZES["tiny"]
    shard = tmp_path / "train" / "shard_00000.npz"
    before = shard.stat().st_mtime_ns
    assert train_sketch(cfg) == pytest.approx(scores)
    assert shard.stat().st_mtime_ns == before
    shard.write_bytes(b"torn")
    with pytest.raises(SourceError, match="delete it"):
        make_examples(
            tmp_path / "train", 10_000, 1, categories=CATEGORIES[:3], count=1, workers=1, photos=True
        )


@pytest.mark.parametrize(
    ("changed", "said"),
    [({"preset": "huge"}, "huge"), ({"minutes": 0.0}, "0 minutes"), ({"rows": 0}, "0 rows")],
)
def test_settings_that_make_no_sense_are_refused(tmp_path: Path, changed: dict[str, object], said: str):
    with pytest.raises(ArtigenError, match=said):
        train_sketch(SketchRunConfig(folder=tmp_path / "run", **changed))  # type: ignore[arg-type]
    assert not (tmp_path / "run").exists()


def test_tables_of_a_shard_are_those_of_the_grammar_and_photos_show_them(examples: list[SketchExample]):
    assert len(examples) == 9
    oven = sketch_to_rows(write_sketch(draw_shape("Oven", 3)))
    (shown,) = [one.photo for one in examples if np.array_equal(one.table, oven)]
    assert shown is not None
    held = dict(draw_shape("Oven", 3).condition.counts)
    seen = Counter(PART_LABELS[int(label)] for label in shown.spots[:, 0])
    assert seen["door"] == held["door"]
    assert all(count <= held[label] for label, count in seen.items())
