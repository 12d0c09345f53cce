"""Outlines beside pictures: an object's own outline is the one that its picture shows."""

import numpy as np
import pytest
import torch

import artigen.models.outline.draw
from artigen.models.conditions import StructureCondition, gather_conditions
from artigen.models.outline.boxes import box_views
from artigen.models.outline.draw import DrawnOutline, OutlineConfig, draw_outline
from artigen.models.outline.flow import OutlineFlow
from artigen.models.outline.likeness import LikenessConfig, measure_likeness
from artigen.models.presets import PRESETS
from artigen.train.examples import StructureExample, draw_example
from artigen.train.reader import see_parts, spread_parts

CFG = LikenessConfig()
SMALL = PRESETS["small"].conditions


def shown(example: StructureExample) -> np.ndarray:
    """The map that a perfect reader would see."""
    return spread_parts(see_parts([example], SMALL))[0].numpy()


@pytest.fixture(scope="module")
def cabinets() -> list[StructureExample]:
    return [draw_example("StorageFurniture", seed, resolution=32) for seed in range(12)]


def test_pictures_find_their_outlines(cabinets: list[StructureExample]):
    right = 0
    for example in cabinets:
        scores = [measure_likeness(other.field.table, shown(example), CFG) for other in cabinets]
        right += int(np.argmax(scores)) == cabinets.index(example)
    assert right >= 10


def test_a_mirrored_or_toppled_outline_is_less_like_the_picture(cabinets: list[StructureExample]):
    """But for objects that look the same then, and what a turn of the camera makes up for."""
    less = {1: 0, 2: 0}
    for example in cabinets:
        own = measure_likeness(example.field.table, shown(example), CFG)
        for axis in less:
            rows = example.field.table.copy()
            box_views(rows)[0][:, axis] *= -1.0
            less[axis] += measure_likeness(rows, shown(example), CFG) < own
    assert less[2] >= 8
    assert less[1] >= 4


def test_what_is_not_looked_for_says_nothing(cabinets: list[StructureExample]):
    rows = cabinets[0].field.table
    assert measure_likeness(rows[:1], shown(cabinets[0]), CFG) == 0.0  # the base


def test_of_several_outlines_the_most_like_the_picture_is_kept(
    cabinets: list[StructureExample], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(artigen.models.outline.draw, "find_faults", lambda *_: ())
    preset = PRESETS["tiny"]
    assert preset.outline is not None
    torch.manual_seed(0)
    flow = OutlineFlow(preset.outline, preset.conditions)
    asked = gather_conditions(
        [StructureCondition(category="Oven", counts=(("base", 1), ("door", 1)))], preset.conditions
    )
    asked.counts.clamp_(min=0)
    nothing = gather_conditions([StructureCondition()], preset.conditions)
    density = shown(cabinets[0])

    def draw(picture: np.ndarray | None) -> DrawnOutline:
        return draw_outline(
            flow,
            asked,
            nothing,
            torch.Generator().manual_seed(3),
            OutlineConfig(draws=8, likened=8),
            density=picture,
        )

    first, best = draw(None), draw(density)
    assert measure_likeness(best.rows, density, CFG) > measure_likeness(first.rows, density, CFG)
    assert best.notes[-1] == "outline: the most like the picture of 8"
