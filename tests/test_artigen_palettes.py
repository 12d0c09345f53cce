"""Palettes: what is read off a surface, what voxels are told, what the flow learns and keeps."""

from pathlib import Path

import numpy as np
import pytest
import torch
from drawer_chest import make_chest

from artigen.errors import SourceError
from artigen.fields import tabulate_parts
from artigen.models.appearance_presets import APPEARANCE_PRESETS
from artigen.models.conditions import StructureCondition, gather_conditions
from artigen.models.palette_flow import PaletteFlow, sample_palettes
from artigen.palettes import PALETTE, describe_voxels, read_palettes
from artigen.sampling import SamplerConfig
from artigen.shapes.asset import shape_to_asset
from artigen.train.appearance.palettes import (
    PaletteExample,
    draw_palettes,
    read_palette_shard,
    train_palette_flow,
    write_palette_shard,
)
from artigen.train.loop import LoopConfig
from artigen.types import PART_LABELS, SurfaceSamples

RED, BLUE = (200, 20, 20), (20, 20, 200)
TINY = APPEARANCE_PRESETS["tiny"]


def paint(colors: list[tuple[int, int, int]], part_ids: list[int]) -> SurfaceSamples:
    count = len(colors)
    return SurfaceSamples(
        points=np.zeros((count, 3)),
        normals=np.tile([0.0, 0.0, 1.0], (count, 1)),
        colors=np.array(colors, dtype=np.uint8).reshape(-1, 3),
        part_ids=np.array(part_ids, dtype=int),
    )


def test_a_palette_is_the_two_colours_of_a_part_and_the_share_of_the_second():
    found = read_palettes(paint([RED] * 30 + [BLUE] * 70 + [RED] * 5, [0] * 100 + [1] * 5), 2)
    red, blue = np.array(RED) / 255, np.array(BLUE) / 255
    np.testing.assert_allclose(found[0], [*blue, *red, 0.3], atol=1e-9)
    np.testing.assert_allclose(found[1], [*red, *red, 0.0], atol=1e-9)


def test_a_palette_does_not_depend_on_the_order_of_samples():
    rng = np.random.default_rng(0)
    colors = [RED] * 40 + [BLUE] * 60
    mixed = [colors[at] for at in rng.permutation(100)]
    np.testing.assert_allclose(
        read_palettes(paint(mixed, [0] * 100), 1), read_palettes(paint(colors, [0] * 100), 1), atol=1e-9
    )


def test_a_part_without_samples_has_the_colours_of_the_whole_and_nothing_has_none():
    found = read_palettes(paint([RED] * 3, [0] * 3), 2)
    np.testing.assert_array_equal(found[0], found[1])
    with pytest.raises(ValueError, match="at least one"):
        read_palettes(paint([], []), 1)


def test_voxels_are_told_the_label_and_the_palette_of_their_part():
    asset = shape_to_asset(make_chest(), 16)
    palettes = np.arange(len(asset.parts) * PALETTE).reshape(-1, PALETTE) / 100.0
    told = describe_voxels(tabulate_parts(asset), asset.voxels.part_ids, palettes)
    assert told.shape == (len(asset.voxels.coords), len(PART_LABELS) + PALETTE)
    for row, part in zip(told, asset.voxels.part_ids, strict=True):
        assert PART_LABELS[row[:-PALETTE].argmax()] == asset.parts[part].label
        np.testing.assert_allclose(row[-PALETTE:], palettes[part], atol=1e-6)


@pytest.fixture(scope="module")
def microwave() -> PaletteExample:
    return draw_palettes("Microwave", 3, resolution=16, image_size=32)


def test_shards_give_examples_back(microwave: PaletteExample, tmp_path: Path):
    path = tmp_path / "shard.npz"
    write_palette_shard(path, [microwave, microwave])
    for one in read_palette_shard(path):
        for name, value in vars(microwave).items():
            assert np.array_equal(getattr(one, name), value), name
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(SourceError, match=r"shard\.npz"):
        list(read_palette_shard(path))


def test_the_flow_learns_which_object_has_which_colours(microwave: PaletteExample, tmp_path: Path):
    """Two categories whose parts differ in nothing but colour: each is drawn in its own."""
    painted = [
        PaletteExample(**{**vars(microwave), "category": category, "palettes": palettes, "image": None})
        for category, palettes in (
            ("Microwave", np.full_like(microwave.palettes, 0.2)),
            ("Table", np.full_like(microwave.palettes, 0.4)),
        )
    ]
    torch.manual_seed(0)
    flow = PaletteFlow(TINY.palette, TINY.conditions)
    cfg = LoopConfig(steps=150, learning_rate=2e-3, warmup=5, ema=0.9)
    train_palette_flow(flow, painted, tmp_path, cfg, batch=8, conditions=TINY.conditions)
    flow.eval()
    nothing = gather_conditions([StructureCondition()], TINY.conditions)
    for example in painted:
        asked = StructureCondition(
            category=example.category,
            counts=tuple(zip(PART_LABELS, example.counts.tolist(), strict=True)),
            size=tuple(example.size.tolist()),
        )
        drawn = sample_palettes(
            flow,
            example.table,
            gather_conditions([asked], TINY.conditions),
            nothing,
            torch.Generator().manual_seed(0),
            SamplerConfig(steps=8, strength=0.0),
        )
        assert np.abs(drawn - example.palettes).mean() < 0.04
