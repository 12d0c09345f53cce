"""Training of the painter: examples of painted voxels, their shards, and the loop."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor, nn

from artigen.facings import find_facings
from artigen.fields import tabulate_parts
from artigen.io import read_arrays
from artigen.models.painter import Painter, VoxelBatch, describe_for_painter, offer_colors, paint_losses
from artigen.models.palette_flow import gather_painted
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.train.appearance.examples import paint_parts
from artigen.train.appearance.flow import BLUR
from artigen.train.appearance.paint import read_paint
from artigen.train.appearance.shards import PER_PART
from artigen.train.batches import draw_batches, prefetch
from artigen.train.loop import LoopConfig, Report, process_seed, train
from artigen.train.shards import ShardConfig, ShardJob, draw_shard, save_shard

KEPT = 1024
"""Voxels of an object that are learnt."""
STEP = 512
"""Those of them in a batch."""
ROUGH = 0.75
"""Share of the objects that are seen as a model might have drawn them."""
SHIFTED, STRAY, HOLES = 0.3, 0.03, 6
"""Of these: share of parts that are off, shares of cells that are off and that lack, and holes."""
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


def draw_painted(category: str, seed: int, *, resolution: int, kept: int = KEPT) -> PaintedExample:
    """Draws a procedural object and paints some of its voxels: half of all, half part by part."""
    shape = draw_shape(category, seed)
    asset = shape_to_asset(shape, resolution)
    assert asset.voxels is not None
    coords, part_ids = asset.voxels.coords, asset.voxels.part_ids.astype(np.int64)
    facings = find_facings(coords, part_ids, resolution)
    paint, table = read_paint(shape, asset, facings), tabulate_parts(asset)
    rng = np.random.default_rng(seed)
    seen, left = (
        roughen(coords, part_ids, resolution, rng)
        if rng.random() < ROUGH
        else (coords, np.arange(len(coords)))
    )
    number = np.bincount(part_ids)[part_ids]
    chances = (0.5 / len(coords) + 0.5 / (number * len(np.unique(part_ids))))[left]
    rows = np.sort(rng.choice(len(left), kept, replace=True, p=chances / chances.sum()))
    told = describe_for_painter(seen, part_ids[left], facings[left], table, resolution, rows)
    return PaintedExample(
        table=table,
        palettes=paint_parts(shape, asset),
        part_ids=part_ids[left][rows].astype(np.uint8),
        told=told.astype(np.float16),
        paint=paint.packed()[left][rows],
        known=paint.known[left][rows].clip(max=255).astype(np.uint8),
    )


def roughen(
    coords: Int[np.ndarray, "N 3"], part_ids: Int[np.ndarray, "N"], resolution: int, rng: np.random.Generator
) -> tuple[Int[np.ndarray, "M 3"], Int[np.ndarray, "M"]]:
    """Voxels as a model might have drawn them: parts a cell off, cells off their surface, holes.

    Args:
        coords: Cells (x, y, z) of the grid.
        part_ids: Part of each.
        resolution: Edge of the grid.
        rng: Of everything that is drawn.

    Returns:
        Cells of the voxels that are left, each at most once, and which ones these are.
    """
    cells = coords.astype(np.int64)
    parts = np.unique(part_ids)
    off = np.zeros((parts.max() + 1, 3), dtype=np.int64)
    off[parts] = rng.integers(-1, 2, (len(parts), 3)) * (rng.random((len(parts), 1)) < SHIFTED)
    stray = rng.integers(-1, 2, cells.shape) * (rng.random((len(cells), 1)) < STRAY)
    places = (cells + off[part_ids] + stray).clip(0, resolution - 1)
    middles = cells[rng.integers(len(cells), size=HOLES)]
    holes = (np.abs(cells[:, None] - middles).max(axis=2) <= rng.integers(0, 3, HOLES)).any(axis=1)
    kept = np.flatnonzero(~holes & (rng.random(len(cells)) >= STRAY))
    order = rng.permutation(kept)
    first = np.sort(np.unique(places[order], axis=0, return_index=True)[1])
    left = np.sort(order[first])
    return places[left], left


def make_paint_shard(job: ShardJob[ShardConfig]) -> Path:
    """Draws the objects of one shard and writes it; runs in a worker process."""
    return draw_shard(job, partial(draw_painted, resolution=job.cfg.resolution), write_paint_shard)


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
    batches = prefetch(draw_batches(examples, lambda chosen: paint_batch(chosen, rng), batch, seed))
    train(painter, terms, batches, folder, cfg, on_report=on_report)
    return painter
