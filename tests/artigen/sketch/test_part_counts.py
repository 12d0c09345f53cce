"""Headers that are not read from a picture have the counts of a training object."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from artigen.errors import SourceError
from artigen.shapes.draw import draw_shape
from artigen.sketch import model
from artigen.sketch.model import draw_header, load_sketch_network, save_sketch_network
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.part_counts import collect_part_counts, describe_part_counts, parse_part_counts
from artigen.sketch.request import SketchRequest
from artigen.sketch.rows import COUNTED, column, sketch_to_rows
from artigen.sketch.sketch import write_sketch
from artigen.sketch.words import CATEGORIES
from artigen.weights import SHIPPED

SIZES = SketchNetworkConfig(width=32, layers=2, heads=2, picture=None)
SAFE = CATEGORIES.index("Safe")


def count(**named: int) -> tuple[int, ...]:
    return tuple(named.get(label, 0) for label in COUNTED)


@pytest.fixture
def wheels(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Headers of safes are drawn with 0, 1, 2, ... wheels; the list holds what was drawn."""
    drawn = list[int]()

    def draw(*_: object) -> list[SimpleNamespace]:
        row = [0] * (column("object", "height") + 1)
        row[column("object", "category")], row[column("object", "wheel")] = SAFE, len(drawn)
        drawn.append(len(drawn))
        return [SimpleNamespace(writer=SimpleNamespace(rows=[row]))]

    monkeypatch.setattr(model, "continue_draft", draw)
    return drawn


@pytest.mark.parametrize(
    ("known", "taken", "tried"),
    [
        (("Safe", count(wheel=3)), 3, 4),
        (("Safe", count(wheel=11)), 11, 12),
        (("Safe", count(wheel=12)), 0, 12),
        (("Oven", count(wheel=3)), 0, 12),
        (("Safe", count(wheel=3, door=1)), 0, 12),
        (None, 0, 1),
    ],
)
def test_of_at_most_twelve_headers_the_first_with_known_counts_is_taken(
    wheels: list[int], known: tuple[str, tuple[int, ...]] | None, taken: int, tried: int
):
    network = SketchNetwork(SIZES)
    network.part_counts = frozenset([known] if known else [])
    assert dict(draw_header(network, SketchRequest(category="Safe"), 0).counts)["wheel"] == taken
    assert len(wheels) == tried


def test_counts_are_collected_from_the_headers_of_tables():
    shapes = [draw_shape(category, 1) for category in ("Oven", "Dresser")]
    known = collect_part_counts([sketch_to_rows(write_sketch(shape)) for shape in shapes])
    labels = {shape.category: [part.label for part in shape.parts] for shape in shapes}
    assert known == {(name, tuple(map(own.count, COUNTED))) for name, own in labels.items()}


def test_counts_survive_the_way_through_a_model_folder(tmp_path: Path):
    network = SketchNetwork(SIZES)
    network.part_counts = frozenset(
        {("Safe", count()), ("Safe", count(door=1, shelf=2)), ("Oven", count(door=1))}
    )
    assert parse_part_counts(describe_part_counts(network.part_counts)) == network.part_counts
    save_sketch_network(network, tmp_path, {"preset": "tiny"})
    assert load_sketch_network(tmp_path).part_counts == network.part_counts


@pytest.mark.parametrize("wrong", ["lid 2", "door", "door many", 3])
def test_counts_that_cannot_be_read_are_named(tmp_path: Path, wrong: object):
    save_sketch_network(SketchNetwork(SIZES), tmp_path, {"preset": "tiny"})
    path = tmp_path / "model.json"
    described = json.loads(path.read_text())
    described["sketch"]["part_counts"] = {"Safe": [wrong]}
    path.write_text(json.dumps(described))
    with pytest.raises(SourceError, match="unreadable part counts"):
        load_sketch_network(tmp_path)


@torch.no_grad()
def test_shipped_weights_draw_dressers_with_counts_of_the_grammar():
    """Without known counts, 16 of 60 had others."""
    network = load_sketch_network(SHIPPED)
    assert len({category for category, _ in network.part_counts}) == len(CATEGORIES)
    headers = [draw_header(network, SketchRequest(category="Dresser"), seed) for seed in range(20)]
    counts = [tuple(dict(header.counts)[label] for label in COUNTED) for header in headers]
    assert np.all([("Dresser", one) in network.part_counts for one in counts])
