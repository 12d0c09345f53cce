"""Both sides of voxels: read off samples, learnt, and painted in one of the colours there are."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from drawer_chest import COLOR, GLASS, INSIDE, make_chest

from artigen.facings import FACINGS, find_facings
from artigen.fields import DEFAULT_LAYOUT, after_occupancy, tabulate_parts
from artigen.figures import find_edges
from artigen.models.painter import (
    CHOICES,
    GLAZED,
    TOLD,
    Painter,
    PainterConfig,
    PaintGuess,
    VoxelBatch,
    choose_colors,
    describe_for_painter,
    offer_colors,
    paint_losses,
    paint_voxels,
    settle_guess,
)
from artigen.palettes import PAINT
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.shape import Shape
from artigen.train.appearance.paint import VoxelPaint, read_paint
from artigen.train.appearance.painter import (
    PaintBatch,
    PaintedExample,
    draw_painted,
    paint_batch,
    read_paint_shard,
    train_painter,
    vary_batch,
    write_paint_shard,
)
from artigen.train.loop import LoopConfig
from artigen.types import PART_LABELS, Asset

TINY = PainterConfig(width=16, blocks=1, heads=2, hidden=32, layers=1)


def paint(shape: Shape, resolution: int = 16) -> tuple[Asset, np.ndarray, VoxelPaint]:
    asset = shape_to_asset(shape, resolution)
    assert asset.voxels is not None
    facings = find_facings(asset.voxels.coords, asset.voxels.part_ids, resolution)
    return asset, facings, read_paint(shape, asset, facings)


def make_batch(count: int, generator: torch.Generator) -> VoxelBatch:
    return VoxelBatch(
        rows=torch.rand(2, 3, TINY.rows, generator=generator),
        palettes=torch.rand(2, 3, 7, generator=generator),
        given=torch.tensor([[True, True, True], [True, True, False]]),
        owners=torch.randint(2, (2, count), generator=generator),
        told=torch.rand(2, count, TOLD, generator=generator),
    )


def test_both_sides_of_a_board_have_their_own_colour():
    asset, facings, found = paint(make_chest(inside="inside"))
    assert asset.voxels is not None
    x, y, z = asset.voxels.coords.T
    lid = (z == 15) & (np.abs(y - 7.5) < 5) & (np.abs(x - 7.5) < 5)
    assert (facings[lid] == 5).all()
    assert (found.known[lid, 0] > 0).all()
    np.testing.assert_allclose(found.colors[lid, 0], np.tile(COLOR, (lid.sum(), 1)), atol=0.01)
    drawer = [part.name for part in asset.parts].index("drawer")
    bottom = (asset.voxels.part_ids == drawer) & (np.abs(x - 7.5) < 4) & (np.abs(y - 7.5) < 4) & (z < 4)
    for side in range(2):
        shown = bottom & (found.known[:, side] > 0)
        assert shown.any()
        np.testing.assert_allclose(
            found.colors[shown, side], np.tile(INSIDE.color, (shown.sum(), 1)), atol=0.01
        )


def test_a_side_without_surface_has_the_colour_of_the_other():
    asset, _, found = paint(make_chest(front="inside"))
    assert asset.voxels is not None
    front = (asset.voxels.coords[:, 0] == 0) & (asset.voxels.part_ids == 1)
    hidden = front & (found.known[:, 1] == 0) & (found.known[:, 0] > 0)
    assert hidden.any()
    np.testing.assert_array_equal(found.colors[hidden, 1], found.colors[hidden, 0])


def test_only_glass_is_clear():
    asset, _, found = paint(make_chest(front="glass"))
    assert asset.voxels is not None
    front = (asset.voxels.coords[:, 0] == 0) & (asset.voxels.part_ids == 1)
    inner = np.abs(asset.voxels.coords[:, 1:] - 7.5).max(axis=1) < 5
    np.testing.assert_allclose(found.clear[front & inner], 1.0 - GLASS.opacity, atol=1e-6)
    assert not found.clear[asset.voxels.part_ids == 0].any()
    packed = found.packed()
    np.testing.assert_allclose(packed[:, -1] / 255.0, found.clear, atol=0.5 / 255)
    np.testing.assert_allclose(packed[:, :3] / 255.0, found.colors[:, 0], atol=0.5 / 255)


def test_paint_needs_voxels():
    shape = make_chest()
    with pytest.raises(ValueError, match="no voxels"):
        read_paint(shape, replace(shape_to_asset(shape, 16), voxels=None), np.zeros(0, dtype=int))


def test_a_voxel_is_painted_by_itself_and_padding_says_nothing():
    generator = torch.Generator().manual_seed(0)
    torch.manual_seed(0)
    painter, batch = Painter(TINY).eval(), make_batch(6, generator)
    guess = painter(batch)
    some = replace(batch, owners=batch.owners[:, 2:4], told=batch.told[:, 2:4])
    torch.testing.assert_close(painter(some).choices, guess.choices[:, 2:4])
    rows, palettes = batch.rows.clone(), batch.palettes.clone()
    rows[1, 2], palettes[1, 2] = 9.0, 9.0
    torch.testing.assert_close(painter(replace(batch, rows=rows, palettes=palettes)).free, guess.free)
    batch.rows[1, 1] += 1.0
    assert not torch.allclose(painter(batch).free[1], guess.free[1])


def test_sides_choose_among_two_colours_of_their_part_and_one_of_their_own():
    generator = torch.Generator().manual_seed(0)
    batch = make_batch(5, generator)
    guess = PaintGuess(
        choices=torch.randn(2, 5, 2, CHOICES, generator=generator),
        free=torch.rand(2, 5, 2, 3, generator=generator),
        pane=torch.tensor([1.0, -1.0, 2.0, -0.1, 0.1]).repeat(2, 1),
        clear=torch.full((2, 5), 0.7),
    )
    offered = offer_colors(guess, batch)
    chosen = choose_colors(guess, offered)
    for sample in range(2):
        for voxel in range(5):
            palette = batch.palettes[sample, batch.owners[sample, voxel]]
            for side in range(2):
                own = guess.free[sample, voxel, side]
                wanted = [palette[:3], palette[3:6], own][int(guess.choices[sample, voxel, side].argmax())]
                assert torch.equal(chosen[sample, voxel, 3 * side : 3 * side + 3], wanted)
    torch.testing.assert_close(chosen[0, :, -1], torch.tensor([0.7, 0.0, 0.7, 0.0, 0.7]))


def test_a_window_is_one_pane_of_one_colour_and_a_display_has_one_too():
    y, z = (values.ravel() for values in np.meshgrid(np.arange(24), np.arange(24), indexing="ij"))
    window = (y >= 4) & (y < 18) & (z >= 6) & (z < 20)
    display = (y >= 4) & (y < 18) & (z >= 21) & (z < 23)
    coords, facings = np.stack([np.zeros_like(y), y, z], axis=1), np.zeros(len(y), dtype=np.int64)
    rng = np.random.default_rng(0)
    odd = rng.random((2, len(y))) < 0.06
    pane = np.where(window ^ odd[0], 4.0, -4.0)
    choices = np.where((window | display ^ odd[1])[:, None] & [False, False, True], 4.0, [2.0, 0.0, -2.0])
    free = rng.random((len(y), 1, 3))
    guess = PaintGuess(
        choices=torch.tensor(np.repeat(choices[:, None], 2, axis=1))[None],
        free=torch.tensor(np.repeat(free, 2, axis=1))[None],
        pane=torch.tensor(pane)[None],
        clear=torch.tensor(rng.random(len(y)))[None],
    )
    edges = find_edges(coords, np.zeros(len(y), dtype=np.int64), facings, 24)
    settled = settle_guess(guess, coords, facings, edges, np.ones(len(y), dtype=bool))
    np.testing.assert_array_equal(settled.pane[0] > 0, window)
    chosen = settled.choices[0].argmax(dim=-1)
    assert (chosen == torch.from_numpy(np.where(window | display, 2, 0))[:, None]).all()
    assert settled.clear[0, window].unique().numel() == 1
    told = settled.free[0, :, 0]
    for figure in (window, display):
        assert len(told[figure].unique(dim=0)) == 1
        np.testing.assert_allclose(told[figure][0], free[figure, 0].mean(axis=0), atol=0.1)
    assert not torch.equal(told[window][0], told[display][0])


def test_losses_are_least_for_the_truth_and_leave_out_what_is_not_known():
    generator = torch.Generator().manual_seed(0)
    batch = make_batch(4, generator)
    which = torch.randint(CHOICES, (2, 4, 2), generator=generator)
    guess = PaintGuess(
        choices=20.0 * torch.eye(CHOICES)[which],
        free=torch.rand(2, 4, 2, 3, generator=generator),
        pane=torch.full((2, 4), -20.0),
        clear=torch.zeros(2, 4),
    )
    offered = offer_colors(guess, batch)
    colors = choose_colors(guess, offered)[..., :-1].unflatten(2, (2, 3))
    known, clear = torch.ones(2, 4, 2), torch.zeros(2, 4)
    own = which < 2
    right = paint_losses(guess, offered, colors, known * own, clear)
    assert sum(float(value) for value in right.values()) == pytest.approx(0.0, abs=1e-4)
    wrong = paint_losses(
        replace(guess, choices=guess.choices.roll(1, dims=-1)), offered, colors, known, clear
    )
    assert wrong["colors"] > right["colors"] + 1.0
    glass = paint_losses(guess, offered, colors, known, clear + 0.5)
    assert glass["panes"] > 10.0
    assert glass["clear"] == pytest.approx(0.25)
    unknown = known.clone()
    unknown[0, 0, 0] = 0.0
    off = colors.clone()
    off[0, 0, 0] += 0.5
    for name, value in paint_losses(guess, offered, off, unknown, clear).items():
        torch.testing.assert_close(value, paint_losses(guess, offered, colors, unknown, clear)[name])


def test_shards_give_back_what_was_written(tmp_path: Path):
    drawn = [
        draw_painted("Table", 10_000, resolution=16, kept=40),
        draw_painted("Oven", 3, resolution=16, kept=40),
    ]
    write_paint_shard(tmp_path / "shard.npz", drawn)
    for one, again in zip(drawn, read_paint_shard(tmp_path / "shard.npz"), strict=True):
        for name, value in vars(one).items():
            np.testing.assert_array_equal(getattr(again, name), value)
    assert [file.name for file in tmp_path.iterdir()] == ["shard.npz"]


def test_painting_is_learnt_and_follows_the_palette(tmp_path: Path):
    """Of a chest with a blue inside: then the same in other colours, as its palette says."""
    asset, facings, found = paint(make_chest(inside="inside"))
    assert asset.voxels is not None
    coords, part_ids = asset.voxels.coords, asset.voxels.part_ids.astype(np.int64)
    table, rng = tabulate_parts(asset), np.random.default_rng(0)
    told = example_of(asset, facings, found, rng)
    torch.manual_seed(0)
    painter = Painter(TINY)
    train_painter(
        painter,
        [told(rng.random((2, 3))) for _ in range(60)],
        tmp_path,
        LoopConfig(steps=150, learning_rate=5e-3, warmup=5, ema=0.9),
        batch=10,
    )
    colors = np.array([[0.1, 0.9, 0.2], [0.9, 0.8, 0.1]])
    wanted, palettes = told(colors), told(colors).palettes
    painted = paint_voxels(painter.eval(), coords, part_ids, facings, table, palettes, 16)
    assert painted.shape == (len(coords), PAINT)
    assert not painted[:, -1].any()
    for side in range(2):
        shown = found.known[:, side] > 0
        off = np.abs(
            painted[shown, 3 * side : 3 * side + 3] - wanted.paint[shown, 3 * side : 3 * side + 3] / 255
        )
        assert (off.max(axis=1) < 0.1).mean() > 0.9


def test_only_doors_trays_and_shelves_have_panes():
    asset, facings, _ = paint(make_chest(inside="inside"))
    assert asset.voxels is not None
    part_ids, table = asset.voxels.part_ids.astype(np.int64), tabulate_parts(asset)
    drawer = [part.name for part in asset.parts].index("drawer")
    torch.manual_seed(0)
    painter = Painter(TINY).eval()
    torch.nn.init.constant_(painter.out_layer.bias[-2:], 20.0)  # sure that all is clear
    for label in PART_LABELS:
        table[drawer, after_occupancy(DEFAULT_LAYOUT.label)] = np.array(PART_LABELS) == label
        painted = paint_voxels(
            painter, asset.voxels.coords, part_ids, facings, table, np.full((len(table), 7), 0.5), 16
        )
        assert (painted[part_ids == drawer, -1] > 0).all() == (label in GLAZED)
        assert not painted[part_ids != drawer, -1].any()


def example_of(asset: Asset, facings: np.ndarray, found: VoxelPaint, rng: np.random.Generator):
    """All voxels of a chest in two other colours."""
    assert asset.voxels is not None
    coords, part_ids = asset.voxels.coords, asset.voxels.part_ids.astype(np.int64)
    table = tabulate_parts(asset)
    described = describe_for_painter(coords, part_ids, facings, table, 16).astype(np.float16)
    second = np.abs(found.colors - INSIDE.color).max(axis=2) < 0.05

    def make(colors: np.ndarray) -> PaintedExample:
        sides = np.where(second[..., None], colors[1], colors[0])
        paint = np.concatenate([sides.reshape(len(coords), 6), np.zeros((len(coords), 1))], axis=1)
        palette = np.concatenate([colors.ravel(), [0.5]])
        return PaintedExample(
            table=table,
            palettes=np.tile(palette, (len(table), 1)).astype(np.float32),
            part_ids=part_ids.astype(np.uint8),
            told=described,
            paint=np.rint(255 * paint).astype(np.uint8),
            known=found.known.clip(max=255).astype(np.uint8),
        )

    return make


def test_batches_hold_some_voxels_of_each_object():
    drawn = [draw_painted(name, 1, resolution=16, kept=600) for name in ("Table", "Oven")]
    batch = paint_batch(drawn, np.random.default_rng(0))
    assert batch.voxels.told.shape == (2, 512, TOLD)
    assert batch.voxels.given.sum(dim=1).tolist() == [len(one.table) for one in drawn]
    off = (batch.voxels.palettes - batch.palettes)[batch.voxels.given]
    assert 0.01 < float(off.std()) < 0.03
    assert float(batch.known.max()) <= 1.0
    assert (batch.voxels.told[..., :FACINGS].sum(dim=2) == 1).all()


def test_objects_in_other_colours_choose_as_before():
    drawn = [draw_painted(name, 1, resolution=16, kept=600) for name in ("Table", "Oven")] * 4
    batch = paint_batch(drawn, np.random.default_rng(0))
    other = vary_batch(batch, np.random.default_rng(1))
    changed = (other.colors != batch.colors).flatten(1).any(dim=1)
    assert changed.any()
    assert not changed.all()
    for one in (batch, other):
        assert one.colors.shape == (8, 512, 2, 3)
    for first, again in ((batch.colors, other.colors), (batch.palettes[..., :3], other.palettes[..., :3])):
        torch.testing.assert_close(first.sort(dim=-1).values, again.sort(dim=-1).values, atol=0, rtol=0)

    def apart(one: PaintBatch) -> torch.Tensor:
        """From both sides of voxels to both colours of their parts."""
        own = one.palettes.gather(1, one.voxels.owners[..., None].expand(-1, -1, one.palettes.shape[2]))
        return (one.colors[:, :, :, None] - own[:, :, None, :6].unflatten(3, (2, 3))).square().sum(dim=4)

    torch.testing.assert_close(apart(batch), apart(other))
    noise = [one.voxels.palettes - one.palettes for one in (batch, other)]
    torch.testing.assert_close(noise[0].square().sum(dim=2), noise[1].square().sum(dim=2))
