"""Training of the outline flow: parts of examples under their conditions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import torch
from torch import Tensor, nn
from torch.nn import functional

from artigen.models.conditions import (
    MAX_COUNT,
    ConditionBatch,
    ConditionConfig,
    drop_conditions,
    isolate_pictures,
)
from artigen.models.outline.batch import OutlineBatch, measure_extents
from artigen.models.outline.flow import OutlineFlow, frame_outlines
from artigen.sampling import diffuse, draw_times, target_velocity
from artigen.train.batches import condition_batch, draw_batches, outline_batch, prefetch
from artigen.train.examples import StructureExample
from artigen.train.loop import LoopConfig, Report, process_seed, train

DROPOUT = 0.1
"""Least share of conditions left open."""
ALONE = 0.25
"""Share of pictures of which nothing else is said."""
GUESS = 0.1
"""Weight of the guesses of open counts and categories."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DescribedOutlines:
    """Outlines with the conditions they answer."""

    outlines: OutlineBatch
    conditions: ConditionBatch

    def to(self, device: torch.device | str) -> "DescribedOutlines":
        """The same batch on another device."""
        return DescribedOutlines(outlines=self.outlines.to(device), conditions=self.conditions.to(device))


def train_outline_flow(
    flow: OutlineFlow,
    examples: Sequence[StructureExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    conditions: ConditionConfig,
    on_report: Report | None = None,
) -> OutlineFlow:
    """Trains the outline flow, and its guesses of what a condition leaves open."""
    measure_outlines(flow, examples)

    def terms(network: nn.Module, drawn: DescribedOutlines, generator: torch.Generator) -> dict[str, Tensor]:
        # some batches leave most open: the guesses are asked with any subset of what there is
        chance = torch.rand(2, generator=generator, device=generator.device)
        share = DROPOUT + (0.8 * float(chance[1]) if chance[0] < 0.5 else 0.0)
        known = isolate_pictures(drawn.conditions, ALONE, generator)
        asked = drop_conditions(known, share, generator)
        return network(drawn, asked, generator)

    make = partial(_describe, conditions=conditions)
    batches: Iterator[DescribedOutlines] = prefetch(
        draw_batches(examples, make, batch, process_seed(cfg.seed))
    )
    train(OutlineLosses(flow), terms, batches, folder, cfg, on_report=on_report)
    return flow


class OutlineLosses(nn.Module):
    """The losses of an outline flow as a network of their own, so that several GPUs can share a batch."""

    def __init__(self, flow: OutlineFlow) -> None:
        super().__init__()
        self.flow = flow

    def forward(
        self, drawn: DescribedOutlines, asked: ConditionBatch, generator: torch.Generator
    ) -> dict[str, Tensor]:
        """Velocity of the parts, and guesses of counts, category and extents, each with its weight."""
        outlines, tokens = drawn.outlines, self.flow.conditions(asked)
        frame = frame_outlines(outlines)
        clean = self.flow.normalise(outlines.rows, frame.extents) * outlines.given[..., None]
        noise = torch.randn(clean.shape, generator=generator, device=generator.device)
        times = draw_times(len(clean), generator)
        said = self.flow.velocity(diffuse(clean, noise, times), times, tokens, frame)
        error = ((said - target_velocity(clean, noise)) ** 2).mean(dim=-1)
        guess = self.flow.guess_open(tokens)
        held = drawn.conditions.counts.clamp(max=MAX_COUNT)
        known = drawn.conditions.category
        return {
            "velocity": (error * outlines.given).sum() / outlines.given.sum(),
            "counts": GUESS * functional.cross_entropy(guess.counts.flatten(0, 1), held.flatten()),
            "category": GUESS * functional.cross_entropy(guess.category, known, ignore_index=-1),
            "extents": GUESS * functional.mse_loss(guess.log_extents, frame.extents.log()),
        }


def measure_outlines(flow: OutlineFlow, examples: Sequence[StructureExample]) -> None:
    """Sets mean and deviation of every channel over the parts of the examples."""
    outlines = outline_batch(examples)
    parts = flow.normalise(outlines.rows, measure_extents(outlines))[outlines.given] * flow.std + flow.mean
    flow.mean.copy_(parts.mean(dim=0))
    flow.std.copy_(parts.std(dim=0).clamp(min=1e-2))


def _describe(examples: Sequence[StructureExample], conditions: ConditionConfig) -> DescribedOutlines:
    return DescribedOutlines(
        outlines=outline_batch(examples),
        conditions=condition_batch(examples, conditions),
    )
