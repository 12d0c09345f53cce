"""Palettes: what is read off a surface, what voxels are told, what the flow learns and keeps."""

from pathlib import Path

import numpy as np
import pytest
import torch
from drawer_chest import make_chest

from artigen.errors import SourceError
from artigen.facings import AROUND, FACINGS, SIDES
from artigen.fields import DEFAULT_LAYOUT, after_occupancy, tabulate_parts
from artigen.models.appearance_presets import APPEARANCE_PRESETS
from artigen.models.conditions import StructureCondition, gather_conditions
from artigen.models.palette_flow import PaletteFlow, look_at_parts, sample_palettes
from artigen.palettes import (
    KIND,
    PAINT,
    ask_colors,
    describe_kinds,
    describe_voxels,
    find_outside,
    find_twins,
    read_palettes,
)
from artigen.places import PLACES
from artigen.sampling import SamplerConfig
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.sampling import sample_shape
from artigen.train.appearance.palettes import (
    PaletteExample,
    draw_palettes,
    read_palette_shard,
    train_palette_flow,
    write_palette_shard,
)
from artigen.train.loop import LoopConfig
from artigen.types import PART_LABELS, PartLabel, SurfaceSamples

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


def test_the_first_colour_is_that_of_the_outside_though_the_inside_is_larger():
    shape, inside = make_chest(), 3
    asset = shape_to_asset(shape, 16)
    surface = sample_shape(shape, 0.05)
    outer = find_outside(surface)
    colors = np.where(outer[:, None], RED, BLUE).astype(np.uint8)
    more = np.repeat(np.arange(len(colors)), np.where(outer, 1, inside))
    doubled = SurfaceSamples(
        points=surface.points[more],
        normals=surface.normals[more],
        colors=colors[more],
        part_ids=surface.part_ids[more],
    )
    for palette in read_palettes(doubled, len(asset.parts)):
        np.testing.assert_allclose(palette[:6], np.array([*RED, *BLUE]) / 255, atol=1e-6)
        assert palette[6] > 0.5


def test_outsides_face_away_from_the_part_and_of_thin_parts_from_the_object():
    surface = sample_shape(make_chest(), 0.05)
    outer, (_, y, z) = find_outside(surface), surface.points.T
    body = surface.part_ids == 0
    assert outer[body & (z > 1.0 - 1e-6)].all()
    assert outer[body & (y < -0.5 + 1e-6)].all()
    assert not outer[body & (surface.normals[:, 1] > 0.9) & (y < 0)].any()
    flat = SurfaceSamples(
        points=np.array([[-0.5, 0, 0.5], [-0.49, 0, 0.5], [-0.5, 0.4, 0.9], [0.5, -0.4, 0]]),
        normals=np.array([[-1.0, 0, 0], [1.0, 0, 0], [-1.0, 0, 0], [1.0, 0, 0]]),
        colors=np.zeros((4, 3), dtype=np.uint8),
        part_ids=np.array([1, 1, 1, 0]),
    )
    assert find_outside(flat).tolist() == [True, False, True, True]


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


def test_voxels_are_told_their_facing_the_label_of_their_part_their_places_and_their_paint():
    asset = shape_to_asset(make_chest(), 16)
    facings = np.arange(len(asset.voxels.coords)) % FACINGS
    paint, places = (np.random.default_rng(0).random((len(facings), width)) for width in (PAINT, PLACES))
    covered = np.stack([facings > 2, facings > 4], axis=1)
    joined = np.stack([covered, facings[:, None] < [1, 3]], axis=1)
    kinds = describe_kinds(tabulate_parts(asset), asset.voxels.part_ids, facings, covered, joined)
    told = describe_voxels(kinds, places, paint)
    assert told.shape == (len(asset.voxels.coords), KIND + PLACES + PAINT)
    first = FACINGS + len(PART_LABELS)
    np.testing.assert_array_equal(told[:, first : first + SIDES], covered)
    np.testing.assert_array_equal(told[:, first + SIDES : KIND], joined.reshape(-1, AROUND))
    np.testing.assert_allclose(told[:, KIND:-PAINT], places, atol=1e-6)
    np.testing.assert_array_equal(told[:, :FACINGS].argmax(axis=1), facings)
    np.testing.assert_array_equal(told[:, :FACINGS].sum(axis=1), 1.0)
    np.testing.assert_allclose(told[:, -PAINT:], paint, atol=1e-6)
    for row, part in zip(told, asset.voxels.part_ids, strict=True):
        assert PART_LABELS[row[FACINGS:first].argmax()] == asset.parts[part].label


def test_the_colour_of_the_object_is_that_of_its_fronts_unless_they_have_their_own():
    said = ask_colors(
        ("base", "door", "drawer", "handle"), {"base": (0.9, 0.8, 0.7), "door": (0.1, 0.2, 0.3)}
    )
    np.testing.assert_array_equal(said[[0, 2], :3], [[0.9, 0.8, 0.7]] * 2)
    np.testing.assert_array_equal(said[1, :3], [0.1, 0.2, 0.3])
    assert np.isnan(said[3]).all()
    assert np.isnan(said[:, 3:]).all()


def make_table(*parts: tuple[PartLabel, tuple[float, float, float]]) -> np.ndarray:
    """Labels and extents of parts; nothing else."""
    table = np.zeros((len(parts), DEFAULT_LAYOUT.channels - 1))
    for row, (label, extents) in zip(table, parts, strict=True):
        row[after_occupancy(DEFAULT_LAYOUT.label)] = np.array(PART_LABELS) == label
        row[after_occupancy(DEFAULT_LAYOUT.box)] = (0.0, 0.0, 0.0, *extents)
    return table


def test_fronts_match_whatever_their_sizes_and_other_parts_those_of_their_size():
    button, dial = (0.02, 0.05, 0.05), (0.05, 0.1, 0.1)
    table = make_table(
        ("base", (1.0, 1.0, 1.0)),
        ("door", (0.03, 0.4, 0.9)),
        ("knob", button),
        ("door", (0.03, 0.3, 0.2)),
        ("knob", dial),
        ("knob", (0.05, 0.025, 0.05)),
        ("drawer", (0.4, 0.4, 0.2)),
    )
    assert find_twins(table).tolist() == [0, 1, 2, 1, 4, 2, 6]


def test_matching_parts_are_drawn_in_the_same_colours():
    torch.manual_seed(0)
    flow = PaletteFlow(TINY.palette, TINY.conditions)
    torch.nn.init.normal_(flow.out_layer.weight, std=0.3)
    door = ("door", (0.03, 0.4, 0.9))
    table = make_table(("base", (1.0, 1.0, 1.0)), door, ("knob", (0.1, 0.1, 0.1)), door)
    table[3, after_occupancy(DEFAULT_LAYOUT.box)][1] = 0.4
    nothing = gather_conditions([StructureCondition()], TINY.conditions)
    generator = torch.Generator().manual_seed(0)
    for strength in (0.0, 2.0):
        cfg = SamplerConfig(steps=4, strength=strength)
        drawn = sample_palettes(flow, table, nothing, nothing, generator, cfg)
        np.testing.assert_allclose(drawn[1], drawn[3], atol=1e-5)
        assert np.abs(drawn[1] - drawn[[0, 2]]).max(axis=1).min() > 0.01


def test_parts_are_looked_at_where_the_picture_shows_them():
    """Left half red, right half blue, on a picture with empty borders; y runs to the left of a viewer."""
    rows = torch.zeros(1, 3, DEFAULT_LAYOUT.channels - 1)
    box = rows[..., after_occupancy(DEFAULT_LAYOUT.box)]
    box[0, 0] = torch.tensor([0.0, 0.25, 0.0, 0.5, 0.5, 1.0])  # the viewer's left
    box[0, 1] = torch.tensor([0.0, -0.25, 0.0, 0.5, 0.5, 1.0])
    image = torch.zeros(1, 4, 32, 32)
    image[0, :, 4:28, 8:16] = torch.tensor([1.0, 0.0, 0.0, 1.0])[:, None, None]
    image[0, :, 4:28, 16:24] = torch.tensor([0.0, 0.0, 1.0, 1.0])[:, None, None]
    given = torch.tensor([[True, True, False]])
    asked = gather_conditions([StructureCondition(image=image[0].numpy())], TINY.conditions)
    seen = look_at_parts(rows, given, asked)
    torch.testing.assert_close(seen[0, 0, :3], torch.tensor([1.0, 0.0, 0.0]), atol=0.05, rtol=0)
    torch.testing.assert_close(seen[0, 1, :3], torch.tensor([0.0, 0.0, 1.0]), atol=0.05, rtol=0)
    assert seen[0, :2, 6:].min() > 0.95
    assert not seen[0, 2].any()
    assert not look_at_parts(rows, given, gather_conditions([StructureCondition()], TINY.conditions)).any()


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


@pytest.fixture(scope="module")
def painted(microwave: PaletteExample) -> list[PaletteExample]:
    """Two categories whose parts differ in nothing but colour."""
    return [
        PaletteExample(
            **{
                **vars(microwave),
                "category": category,
                "palettes": np.full_like(microwave.palettes, value),
                "image": None,
            }
        )
        for category, value in (("Microwave", 0.2), ("Table", 0.4))
    ]


@pytest.fixture(scope="module")
def learnt(painted: list[PaletteExample], tmp_path_factory: pytest.TempPathFactory) -> PaletteFlow:
    torch.manual_seed(0)
    flow = PaletteFlow(TINY.palette, TINY.conditions)
    cfg = LoopConfig(steps=200, learning_rate=2e-3, warmup=5, ema=0.9)
    folder = tmp_path_factory.mktemp("palette")
    return train_palette_flow(flow, painted, folder, cfg, batch=8, conditions=TINY.conditions).eval()


def test_the_flow_learns_which_object_has_which_colours(painted: list[PaletteExample], learnt: PaletteFlow):
    nothing = gather_conditions([StructureCondition()], TINY.conditions)
    for example in painted:
        asked = StructureCondition(
            category=example.category,
            counts=tuple(zip(PART_LABELS, example.counts.tolist(), strict=True)),
            size=tuple(example.size.tolist()),
        )
        drawn = sample_palettes(
            learnt,
            example.table,
            gather_conditions([asked], TINY.conditions),
            nothing,
            torch.Generator().manual_seed(0),
            SamplerConfig(steps=8, strength=0.0),
        )
        assert np.abs(drawn - example.palettes).mean() < 0.04


def test_what_is_fixed_is_kept_and_the_rest_goes_with_it(microwave: PaletteExample, learnt: PaletteFlow):
    """Of two ways to paint it, the flow takes the one that main colours fit."""
    nothing = gather_conditions([StructureCondition()], TINY.conditions)
    for value in (0.2, 0.4):
        fixed = np.full_like(microwave.palettes, np.nan)
        fixed[:, :3] = value
        drawn = sample_palettes(
            learnt,
            microwave.table,
            nothing,
            nothing,
            torch.Generator().manual_seed(1),
            SamplerConfig(steps=12, strength=0.0),
            fixed=fixed,
        )
        np.testing.assert_allclose(drawn[:, :3], value, atol=1e-6)
        assert np.abs(drawn[:, 3:] - value).mean() < 0.06
