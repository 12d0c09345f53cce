"""Training of the sketch network: it learns, goes on where it stopped, and leaves a model that loads."""

from pathlib import Path

import numpy as np
import pytest
import torch

from artigen.errors import ArtigenError, SourceError
from artigen.shapes.draw import draw_shape
from artigen.sketch.batch import make_batch, nothing_asked
from artigen.sketch.model import load_sketch_network
from artigen.sketch.network import SketchNetwork
from artigen.sketch.rows import sketch_to_rows
from artigen.sketch.sketch import write_sketch
from artigen.train.sketch import (
    SIZES,
    SketchRunConfig,
    draw_batches,
    make_tables,
    sketch_losses,
    train_sketch,
)


def test_an_object_seen_often_is_learnt_by_heart():
    torch.manual_seed(0)
    network = SketchNetwork(SIZES["tiny"])
    batch = make_batch([sketch_to_rows(write_sketch(draw_shape("Safe", 1)))], [nothing_asked()])
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
    tables = [
        sketch_to_rows(write_sketch(draw_shape(category, seed)))
        for category in ("Safe", "Table")
        for seed in range(6)
    ]
    batches = draw_batches(tables, 100, 0)
    again = draw_batches(tables, 100, 0)
    for _ in range(5):
        batch, same = next(batches), next(again)
        assert torch.equal(batch.rows, same.rows)
        assert len(batch.rows) >= 2
        assert int(batch.said.any(dim=2).sum()) <= 250


def test_a_run_goes_on_where_it_was_and_its_model_loads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("artigen.train.sketch.SHARD", 1)
    monkeypatch.setattr("artigen.train.sketch.MEASURED", 9)
    cfg = SketchRunConfig(folder=tmp_path, preset="tiny", minutes=0.02, shards=1, rows=120, workers=1)
    scores = train_sketch(cfg)
    assert scores["per_field"] > 0
    network = load_sketch_network(tmp_path / "model")
    assert network.cfg == SIZES["tiny"]
    before = (tmp_path / "train" / "tables-000.npz").stat().st_mtime_ns
    assert train_sketch(cfg) == pytest.approx(scores)
    assert (tmp_path / "train" / "tables-000.npz").stat().st_mtime_ns == before
    (tmp_path / "train" / "tables-000.npz").write_bytes(b"torn")
    with pytest.raises(SourceError, match="delete it"):
        make_tables(tmp_path / "train", 10_000, 1, 1, count=1)


@pytest.mark.parametrize(
    ("changed", "said"),
    [({"preset": "huge"}, "huge"), ({"minutes": 0.0}, "0 minutes"), ({"rows": 0}, "0 rows")],
)
def test_settings_that_make_no_sense_are_refused(tmp_path: Path, changed: dict[str, object], said: str):
    with pytest.raises(ArtigenError, match=said):
        train_sketch(SketchRunConfig(folder=tmp_path / "run", **changed))  # type: ignore[arg-type]
    assert not (tmp_path / "run").exists()


def test_tables_of_a_shard_are_those_of_the_grammar(tmp_path: Path):
    tables = make_tables(tmp_path, 3, 1, 1, count=1)
    assert len(tables) == 9
    assert any(np.array_equal(table, sketch_to_rows(write_sketch(draw_shape("Oven", 3)))) for table in tables)
