"""Training of the palette flow: examples of painted parts, their shards, and the loop.

An example costs a picture and no more, so there are many more of them than of photographed objects.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, UInt8
from torch import Tensor, nn

from artigen.io import read_arrays
from artigen.models.conditions import (
    ALONE,
    ConditionBatch,
    ConditionConfig,
    drop_conditions,
    isolate_pictures,
)
from artigen.models.palette_flow import Painted, PaletteFlow, gather_painted, look_at_parts
from artigen.sampling import diffuse, draw_times, target_velocity
from artigen.shapes.draw import draw_shape
from artigen.train.appearance.examples import paint_parts
from artigen.train.batches import condition_batch, draw_batches, prefetch
from artigen.train.examples import draw_example_of
from artigen.train.loop import LoopConfig, Report, process_seed, train
from artigen.train.shards import (
    ShardConfig,
    ShardJob,
    condition_arrays,
    draw_shard,
    pick_condition,
    save_shard,
)
from artigen.train.structure import DROPOUT


@dataclass(frozen=True, kw_only=True, eq=False)
class PaletteExample:
    """Parts of an object with their palettes, and its condition; ``image`` is RGBA, premultiplied."""

    name: str
    category: str
    table: Float[np.ndarray, "P C"]
    palettes: Float[np.ndarray, "P 7"]
    counts: UInt8[np.ndarray, "L"]
    size: Float[np.ndarray, "3"]
    image: UInt8[np.ndarray, "H W 4"] | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class PaletteBatch:
    """Painted parts with the conditions they answer."""

    painted: Painted
    conditions: ConditionBatch

    def to(self, device: torch.device | str) -> "PaletteBatch":
        """The same batch on another device."""
        return PaletteBatch(painted=self.painted.to(device), conditions=self.conditions.to(device))


def draw_palettes(category: str, seed: int, *, resolution: int, image_size: int) -> PaletteExample:
    """Draws a procedural object and reads the colours of its parts."""
    asset, described = draw_example_of(category, seed, resolution=resolution, image_size=image_size)
    return PaletteExample(
        name=described.name,
        category=described.category,
        table=described.field.table,
        palettes=paint_parts(draw_shape(category, seed), asset),
        counts=described.counts,
        size=described.size,
        image=described.image,
    )


def make_palette_shard(job: ShardJob[ShardConfig]) -> Path:
    """Draws the objects of one shard and writes it; runs in a worker process."""
    draw = partial(draw_palettes, resolution=job.cfg.resolution, image_size=job.cfg.image_size)
    return draw_shard(job, draw, write_palette_shard)


def write_palette_shard(path: Path, examples: Sequence[PaletteExample]) -> None:
    """Writes examples to one npz file, whole or not at all."""
    arrays = condition_arrays(examples) | {
        "parts": np.array([len(one.table) for one in examples]),
        "table": np.concatenate([one.table for one in examples]),
        "palettes": np.concatenate([one.palettes for one in examples]),
    }
    save_shard(path, arrays, packed=True)


def read_palette_shard(path: Path) -> Iterator[PaletteExample]:
    """The examples of a shard.

    Raises:
        SourceError: If the file is missing or damaged.
    """
    arrays = read_arrays(path)
    ends = np.cumsum(arrays["parts"])
    for number, end in enumerate(ends):
        of = slice(end - arrays["parts"][number], end)
        yield PaletteExample(
            table=arrays["table"][of], palettes=arrays["palettes"][of], **pick_condition(arrays, number)
        )


def train_palette_flow(
    flow: PaletteFlow,
    examples: Sequence[PaletteExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    conditions: ConditionConfig,
    on_report: Report | None = None,
) -> PaletteFlow:
    """Trains the palette flow.

    Args:
        flow: untrained, or what the folder's checkpoint continues.
        examples: in memory.
        folder: of the stage.
        cfg: budget and rates.
        batch: objects per step.
        conditions: what the flow can be asked for.
        on_report: called with every line of metrics.
    """
    every = torch.from_numpy(np.concatenate([one.palettes for one in examples])).float()
    flow.mean.copy_(every.mean(dim=0))
    flow.std.copy_(every.std(dim=0).clamp(min=1e-2))

    def terms(network: nn.Module, drawn: PaletteBatch, generator: torch.Generator) -> dict[str, Tensor]:
        known = isolate_pictures(drawn.conditions, ALONE, generator)
        return network(drawn.painted, drop_conditions(known, DROPOUT, generator), generator)

    make = partial(_describe, conditions=conditions)
    batches: Iterator[PaletteBatch] = prefetch(draw_batches(examples, make, batch, process_seed(cfg.seed)))
    train(PaletteLosses(flow), terms, batches, folder, cfg, on_report=on_report)
    return flow


class PaletteLosses(nn.Module):
    """The loss of a palette flow as a network of its own, so that several GPUs can share a batch."""

    def __init__(self, flow: PaletteFlow) -> None:
        super().__init__()
        self.flow = flow

    def forward(
        self, painted: Painted, asked: ConditionBatch, generator: torch.Generator
    ) -> dict[str, Tensor]:
        """Velocity of the palettes of the parts that are given."""
        clean = self.flow.normalise(painted.palettes) * painted.given[..., None]
        noise = torch.randn(clean.shape, generator=generator, device=generator.device)
        times = draw_times(len(clean), generator)
        tokens = self.flow.conditions(asked)
        told = torch.cat([painted.rows, look_at_parts(painted.rows, painted.given, asked)], dim=-1)
        said = self.flow.velocity(diffuse(clean, noise, times), times, tokens, told, painted.given)
        error = ((said - target_velocity(clean, noise)) ** 2).mean(dim=-1)
        return {"velocity": (error * painted.given).sum() / painted.given.sum()}


def _describe(examples: Sequence[PaletteExample], conditions: ConditionConfig) -> PaletteBatch:
    return PaletteBatch(
        painted=gather_painted([one.table for one in examples], [one.palettes for one in examples]),
        conditions=condition_batch(examples, conditions),
    )
