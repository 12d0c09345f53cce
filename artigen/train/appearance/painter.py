"""Training of the painter: examples of painted voxels, their shards, and the loop."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, UInt8
from torch import Tensor, nn

from artigen.fields import tabulate_parts
from artigen.generate import StructureModel, load_structure_model
from artigen.io import read_arrays
from artigen.models.painter import Painter, VoxelBatch, describe_for_painter, offer_colors, paint_losses
from artigen.models.palette_flow import gather_painted
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.train.appearance.drawn import DrawnShardConfig, Resurface, draw_again, keep_voxels
from artigen.train.appearance.examples import lay_true_voxels, paint_parts
from artigen.train.appearance.flow import BLUR
from artigen.train.appearance.paint import read_paint
from artigen.train.appearance.shards import PER_PART
from artigen.train.batches import draw_batches, prefetch
from artigen.train.loop import LoopConfig, Report, process_seed, train
from artigen.train.shards import ShardJob, draw_shard, save_shard

KEPT = 1024
"""Voxels of an object that are learnt."""
STEP = 512
"""Those of them in a batch."""
DRAWN = 0.75
"""Share of the objects that are seen as a model draws them."""
SWAPPED = 0.6
"""Share of the objects whose red, green and blue are swapped: choices do not depend on them."""
OFF = 0.004
"""About the deviation of what parts' rows say from one drawn object to another."""
ENOUGH = 4.0
"""Samples from which a side counts in full."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PaintedExample:
    """Some voxels of an object with the colours of their sides; colours in steps of 8 bits."""

    table: Float[np.ndarray, "P C"]
    palettes: Float[np.ndarray, "P 7"]
    part_ids: UInt8[np.ndarray, "K"]
    told: Float[np.ndarray, "K T"]
    paint: UInt8[np.ndarray, "K 7"]
    known: UInt8[np.ndarray, "K 2"]


@dataclass(frozen=True, kw_only=True, eq=False)
class PaintBatch:
    """Voxels, and what the painter should say about them."""

    voxels: VoxelBatch
    palettes: Float[Tensor, "B P 7"]
    """The true ones; those of the voxels are a little off."""
    colors: Float[Tensor, "B K 2 3"]
    known: Float[Tensor, "B K 2"]
    clear: Float[Tensor, "B K"]

    def to(self, device: torch.device | str) -> "PaintBatch":
        """The same batch on another device."""
        voxels = VoxelBatch(**{name: value.to(device) for name, value in vars(self.voxels).items()})
        rest = {name: value.to(device) for name, value in vars(self).items() if name != "voxels"}
        return PaintBatch(voxels=voxels, **rest)


def draw_painted(
    category: str,
    seed: int,
    *,
    resolution: int,
    kept: int = KEPT,
    model: StructureModel | None = None,
    resurface: Resurface | None = None,
) -> PaintedExample:
    """Draws a procedural object and paints some of its voxels: half of all, half part by part.

    Args:
        category: of the object.
        seed: of the object, and of what is drawn for it.
        resolution: edge of the grid.
        kept: number of voxels.
        model: draws them again (`artigen.train.appearance.drawn`); without one, they are roughened.
        resurface: makes the surface of what is drawn.
    """
    shape = draw_shape(category, seed)
    asset, facings = lay_true_voxels(shape, shape_to_asset(shape, resolution))
    assert asset.voxels is not None
    paint, table = read_paint(shape, asset, facings), tabulate_parts(asset)
    rng = np.random.default_rng(seed)
    if rng.random() < DRAWN:
        seen = draw_again(asset, facings, rng, model, resurface)
    else:
        seen = keep_voxels(asset.voxels, facings)
    number = np.bincount(seen.part_ids)[seen.part_ids]
    chances = (0.5 / len(number) + 0.5 / (number * len(np.unique(seen.part_ids))))[seen.rows]
    chosen = np.sort(rng.choice(len(seen.rows), kept, replace=True, p=chances / chances.sum()))
    rows, like = seen.rows[chosen], seen.like[chosen]
    told = describe_for_painter(seen.coords, seen.part_ids, seen.facings, table, resolution, rows)
    return PaintedExample(
        table=table,
        palettes=paint_parts(shape, asset),
        part_ids=seen.part_ids[rows].astype(np.uint8),
        told=told.astype(np.float16),
        paint=paint.packed()[like],
        known=paint.known[like].clip(max=255).astype(np.uint8),
    )


def make_paint_shard(job: ShardJob[DrawnShardConfig]) -> Path:
    """Draws the objects of one shard and writes it; runs in a worker process."""
    model = None if job.cfg.structure is None else load_structure_model(job.cfg.structure)
    draw = partial(draw_painted, resolution=job.cfg.resolution, model=model, resurface=job.cfg.resurface)
    return draw_shard(job, draw, write_paint_shard)


def write_paint_shard(path: Path, examples: Sequence[PaintedExample]) -> None:
    """Writes examples, all with as many voxels, to one npz file, whole or not at all."""
    arrays = {"parts": np.array([len(one.table) for one in examples])}
    for field in fields(PaintedExample):
        join = np.concatenate if field.name in PER_PART else np.stack
        arrays[field.name] = join([getattr(one, field.name) for one in examples])
    save_shard(path, arrays, packed=True)


def read_paint_shard(path: Path) -> Iterator[PaintedExample]:
    """The examples of a shard.

    Raises:
        SourceError: If the file is missing or damaged.
    """
    arrays = read_arrays(path)
    ends = np.cumsum(arrays.pop("parts"))
    starts = np.append(0, ends[:-1])
    for number, (start, end) in enumerate(zip(starts, ends, strict=True)):
        yield PaintedExample(
            **{
                name: value[start:end] if name in PER_PART else value[number]
                for name, value in arrays.items()
            }
        )


def paint_batch(examples: Sequence[PaintedExample], rng: np.random.Generator) -> PaintBatch:
    """Some voxels of several objects side by side, with palettes that are a little off, as drawn ones are."""
    painted = gather_painted([one.table for one in examples], [one.palettes for one in examples])
    step = min(STEP, len(examples[0].told))
    chosen = [np.sort(rng.choice(len(one.told), step, replace=False)) for one in examples]

    def gather(name: str) -> Tensor:
        values = [getattr(one, name)[rows] for one, rows in zip(examples, chosen, strict=True)]
        return torch.from_numpy(np.stack(values))

    paint = gather("paint").float() / 255.0
    off = torch.from_numpy(rng.normal(0.0, BLUR, painted.palettes.shape)).float()
    return PaintBatch(
        voxels=VoxelBatch(
            rows=painted.rows,
            palettes=painted.palettes + off,
            given=painted.given,
            owners=gather("part_ids").long(),
            told=gather("told").float(),
        ),
        palettes=painted.palettes,
        colors=paint[..., :-1].unflatten(2, (2, 3)),
        known=(gather("known").float() / ENOUGH).clamp(max=1.0),
        clear=paint[..., -1],
    )


def vary_batch(batch: PaintBatch, rng: np.random.Generator) -> PaintBatch:
    """The same objects, some in other colours, with parts that are a little off."""
    voxels, count = batch.voxels, len(batch.palettes)
    swapped = torch.from_numpy(rng.random(count) < SWAPPED)
    order = torch.from_numpy(rng.permuted(np.tile(np.arange(3), (count, 1)), axis=1))
    order = torch.where(swapped[:, None], order, torch.arange(3))

    def swap(colors: Tensor) -> Tensor:
        return colors.gather(-1, order.view(count, *[1] * (colors.ndim - 2), 3).expand_as(colors))

    def recolor(palettes: Tensor) -> Tensor:
        first, second, rest = palettes.split([3, 3, palettes.shape[2] - 6], dim=2)
        return torch.cat([swap(first), swap(second), rest], dim=2)

    off = torch.from_numpy(rng.normal(0.0, OFF, voxels.rows.shape)).to(voxels.rows.dtype)
    return replace(
        batch,
        voxels=replace(voxels, palettes=recolor(voxels.palettes), rows=voxels.rows + off),
        palettes=recolor(batch.palettes),
        colors=swap(batch.colors),
    )


def train_painter(
    painter: Painter,
    examples: Sequence[PaintedExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    on_report: Report | None = None,
) -> Painter:
    """Trains the painter.

    Args:
        painter: untrained, or what the folder's checkpoint continues.
        examples: in memory.
        folder: of the stage.
        cfg: budget and rates.
        batch: objects per step.
        on_report: called with every line of metrics.
    """

    def terms(network: nn.Module, drawn: PaintBatch, generator: torch.Generator) -> dict[str, Tensor]:
        guess = network(drawn.voxels)
        truth = VoxelBatch(**{**vars(drawn.voxels), "palettes": drawn.palettes})
        return paint_losses(guess, offer_colors(guess, truth), drawn.colors, drawn.known, drawn.clear)

    seed = process_seed(cfg.seed)
    rng = np.random.default_rng([seed, 2])

    def make(chosen: Sequence[PaintedExample]) -> PaintBatch:
        return vary_batch(paint_batch(chosen, rng), rng)

    batches = prefetch(draw_batches(examples, make, batch, seed))
    train(painter, terms, batches, folder, cfg, on_report=on_report)
    return painter
