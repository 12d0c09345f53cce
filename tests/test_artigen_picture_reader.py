"""Reading pictures: what is marked in them, how they are varied, and what becomes of a condition."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from artigen.datasets.sizes import estimate_size
from artigen.errors import SourceError
from artigen.metrics.reading import score_reader
from artigen.models.conditions import StructureCondition
from artigen.models.picture_reader import CELL, PictureReader, read_condition
from artigen.models.presets import PRESETS
from artigen.shapes.draw import draw_shape
from artigen.train.examples import StructureExample, draw_example
from artigen.train.loop import LoopConfig
from artigen.train.reader import SeenParts, see_parts, spread_parts, train_picture_reader, vary_pictures
from artigen.types import PART_LABELS

TINY = PRESETS["tiny"]
EDGE = TINY.conditions.image_size


@pytest.fixture(scope="module")
def examples() -> list[StructureExample]:
    return [
        draw_example(category, seed, resolution=32, image_size=EDGE)
        for category in ("StorageFurniture", "Table", "WashingMachine")
        for seed in (10_000, 10_001)
    ]


@pytest.fixture(scope="module")
def seen(examples: list[StructureExample]) -> SeenParts:
    return see_parts(examples, TINY.conditions)


def make_reader() -> PictureReader:
    torch.manual_seed(0)
    assert TINY.reader is not None
    return PictureReader(TINY.reader, TINY.conditions)


def test_maps_sum_to_the_parts_in_view(examples: list[StructureExample], seen: SeenParts):
    sums = spread_parts(seen).sum(dim=(2, 3))
    for row, example in enumerate(examples):
        assert example.shown is not None
        pixels = np.bincount(example.shown.ravel(), minlength=256)[: len(example.field.table)]
        labels = example.field.table[:, : len(PART_LABELS)].argmax(axis=1)
        in_view = np.bincount(labels[pixels > 1], minlength=len(PART_LABELS))
        np.testing.assert_allclose(sums[row], in_view, atol=1e-4)
        assert (in_view <= example.counts).all()


def test_maps_are_where_the_parts_are(seen: SeenParts):
    """The mean place of a map with one part is the part's, but for what the picture's edge cuts off."""
    density = spread_parts(seen)
    places = 2.0 * (torch.arange(EDGE // CELL) + 0.5) / (EDGE // CELL) - 1.0
    base = PART_LABELS.index("base")
    across = (density[:, base].sum(dim=1) * places).sum(dim=1)
    down = (density[:, base].sum(dim=2) * places).sum(dim=1)
    center = seen.centers[seen.kinds.eq(base) & seen.given]
    torch.testing.assert_close(torch.stack([across, down], dim=1), center, atol=0.05, rtol=0.0)


def test_what_is_marked_moves_with_a_varied_picture(seen: SeenParts):
    """The middle of what has a label in the varied picture is where the part's middle is said to be."""
    base = PART_LABELS.index("base")
    alone = replace(seen, labels=torch.where(seen.image[:, 3] > 0, base, len(PART_LABELS)))
    places = 2.0 * (torch.arange(EDGE) + 0.5) / EDGE - 1.0

    def middles(labels: torch.Tensor) -> torch.Tensor:
        mask = (labels == base).float()
        total = mask.sum(dim=(1, 2))
        return torch.stack(
            [(mask.sum(dim=1) * places).sum(dim=1) / total, (mask.sum(dim=2) * places).sum(dim=1) / total],
            dim=1,
        )

    marked = replace(alone, centers=middles(alone.labels)[:, None])
    varied = vary_pictures(marked, torch.Generator().manual_seed(1))
    torch.testing.assert_close(middles(varied.labels), varied.centers[:, 0], atol=0.05, rtol=0.0)
    assert float((varied.centers - marked.centers).abs().max()) > 0.05
    assert torch.equal(varied.counts, seen.counts)
    assert float(varied.image.min()) >= 0.0
    assert float((varied.image[:, :3] - varied.image[:, 3:]).max()) <= 1e-6  # still premultiplied


def test_a_reader_learns_to_read_a_few_pictures(examples: list[StructureExample], tmp_path: Path):
    before = score_reader(make_reader(), examples)
    loop = LoopConfig(steps=120, learning_rate=5e-3, warmup=5, ema=0.9)
    reader = train_picture_reader(make_reader(), examples, tmp_path, loop, batch=6)
    after = score_reader(reader, examples)
    assert before["counts"] == 0.0
    assert after["counts"] >= 0.5
    assert after["category"] == 1.0
    assert after["extents"] < 0.5 * before["extents"]


def test_examples_without_pictures_are_refused(examples: list[StructureExample], tmp_path: Path):
    blind = [examples[0], replace(examples[1], shown=None)]
    with pytest.raises(SourceError, match=f"1 examples, {examples[1].name} the first"):
        train_picture_reader(make_reader(), blind, tmp_path, LoopConfig(steps=1), batch=2)
    assert not list(tmp_path.iterdir())


def test_what_is_asked_for_stays_and_the_rest_is_read(examples: list[StructureExample]):
    picture = examples[0].image
    assert picture is not None
    image = picture.transpose(2, 0, 1).astype(np.float32) / 255.0
    reader = make_reader()
    open_one, (note,) = read_condition(reader, StructureCondition(image=image))
    assert open_one.category in TINY.conditions.categories
    assert [label for label, _ in open_one.counts] == list(PART_LABELS)
    assert open_one.size is not None
    longest, _ = estimate_size(open_one.category or "", np.array(open_one.size))
    assert max(open_one.size) == pytest.approx(longest)
    assert note.startswith(f"picture: read as {open_one.category}")
    given = StructureCondition(category="Oven", counts=(("door", 7),), size=(0.5, 0.6, 0.7), image=image)
    whole, _ = read_condition(reader, given)
    assert (whole.category, whole.size, dict(whole.counts)["door"]) == ("Oven", given.size, 7)
    assert read_condition(reader, whole) == (whole, ())
    without = StructureCondition(category="Oven")
    assert read_condition(reader, without) == (without, ())


def test_parts_merged_below_the_resolution_are_shown_as_what_they_became():
    """Every part of a picture has a row, also where a coarse grid has merged some into their parents."""
    for seed in range(20):
        example = draw_example("Microwave", seed, resolution=12, image_size=64)
        assert example.shown is not None
        shown = np.unique(example.shown)
        assert shown[shown < 255].max() < len(example.field.table)
        if len(example.field.table) < len(draw_shape("Microwave", seed).parts):
            return
    pytest.fail("no part was merged: the test says nothing")
