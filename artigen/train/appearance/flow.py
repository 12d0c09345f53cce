"""Training of the sparse flow on latents of the appearance VAE, conditioned as the structure flow is."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from artigen.appearance.linear_prior import Expectation, fit_expectation
from artigen.appearance.paint import PAINT
from artigen.appearance.slat_flow import SlatFlow
from artigen.models.conditions import (
    ALONE,
    ConditionBatch,
    ConditionConfig,
    drop_conditions,
    isolate_pictures,
)
from artigen.models.rectified_flow import diffuse, draw_times, target_velocity
from artigen.train.appearance.batches import place_batch
from artigen.train.appearance.drawn import DrawnVoxels
from artigen.train.appearance.examples import AppearanceExample
from artigen.train.appearance.transfer import find_models, transfer_latents, transfer_looks
from artigen.train.batches import condition_batch, draw_batches, prefetch
from artigen.train.loop import LoopConfig, Report, process_seed, train
from artigen.train.structure import DROPOUT
from artigen.types import PART_LABELS
from artigen.voxels.frames import FACINGS

BLUR = 0.02
"""About the deviation of colours that are told in training from the true ones."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SlatBatch:
    """Posteriors of the voxels of several objects, with the conditions they answer."""

    coords: Int[Tensor, "N 4"]
    mean: Float[Tensor, "N D"]
    std: Float[Tensor, "N D"]
    attributes: Float[Tensor, "N A"]
    conditions: ConditionBatch

    def to(self, device: torch.device | str) -> "SlatBatch":
        """The same batch on another device."""
        return SlatBatch(**{name: value.to(device) for name, value in vars(self).items()})


def train_appearance_flow(
    flow: SlatFlow,
    latents: tuple[Sequence[Tensor], Sequence[Tensor]],
    examples: Sequence[AppearanceExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    conditions: ConditionConfig,
    noisiness: float = 1.0,
    drawn: Sequence[DrawnVoxels] = (),
    on_report: Report | None = None,
) -> SlatFlow:
    """Trains the conditional sparse flow on latents, on true voxels and on drawn ones alike.

    Args:
        flow: untrained, or what the folder's checkpoint continues.
        latents: means and deviations of each example's voxels.
        examples: the objects.
        folder: of the stage.
        cfg: budget and rates.
        batch: objects per step.
        conditions: what the flow can be asked for.
        noisiness: mean of the logits of training times.
        drawn: voxels of each object as a model draws them; may be left out.
        on_report: called with every line of metrics.
    """
    measured = measure_slats(
        *latents, [one.attributes() for one in examples] if flow.attribute_channels else None
    )
    flow.latent_mean.copy_(measured.mean)
    flow.latent_std.copy_(measured.std)
    if flow.expectation is not None:
        flow.expectation.weight.copy_(measured.expected)

    if drawn:
        others = [
            redraw_slats(flow, example, (mean, std), voxels)
            for example, mean, std, voxels in zip(examples, *latents, drawn, strict=True)
        ]
        examples = [*examples, *(one[0] for one in others)]
        latents = ([*latents[0], *(one[1] for one in others)], [*latents[1], *(one[2] for one in others)])

    def terms(network: nn.Module, given: SlatBatch, generator: torch.Generator) -> dict[str, Tensor]:
        noise, jitter = (
            torch.randn(given.mean.shape, generator=generator, device=generator.device) for _ in range(2)
        )
        samples = len(given.conditions.category)
        times = draw_times(samples, generator, noisiness)
        known = isolate_pictures(given.conditions, ALONE, generator)
        asked = drop_conditions(known, DROPOUT, generator)
        row_times = times[given.coords[:, 0]]
        plan = flow.plan(given.coords, samples)
        attributes = _blur(given.attributes, generator) if flow.attribute_channels else None
        x_0 = flow.normalise(given.mean + given.std * jitter, attributes)
        said = network(diffuse(x_0, noise, row_times), times, asked, plan, attributes)
        return {"velocity": torch.mean((said.float() - target_velocity(x_0, noise)) ** 2)}

    make = partial(slat_batch, latents=latents, conditions=conditions)
    batches: Iterator[SlatBatch] = prefetch(
        draw_batches(list(enumerate(examples)), make, batch, process_seed(cfg.seed))
    )
    train(flow, terms, batches, folder, cfg, on_report=on_report)
    return flow


def redraw_slats(
    flow: SlatFlow, example: AppearanceExample, posterior: tuple[Tensor, Tensor], drawn: DrawnVoxels
) -> tuple[AppearanceExample, Tensor, Tensor]:
    """An object with voxels as a model draws them, and the posterior of these: mean and deviation."""
    models, sure = find_models(example, drawn)
    other = transfer_looks(example, drawn, models)
    mean, std = posterior
    told = (example.attributes(), other.attributes())
    return other, transfer_latents(flow, mean.float(), told, models, sure), std[models]


def slat_batch(
    chosen: Sequence[tuple[int, AppearanceExample]],
    latents: tuple[Sequence[Tensor], Sequence[Tensor]],
    conditions: ConditionConfig,
) -> SlatBatch:
    """Numbered examples side by side, with their rows of ``latents``."""
    examples = [example for _, example in chosen]
    mean, std = (torch.cat([part[number] for number, _ in chosen]).float() for part in latents)
    return SlatBatch(
        coords=place_batch(examples),
        mean=mean,
        std=std,
        attributes=torch.from_numpy(np.concatenate([one.attributes() for one in examples])),
        conditions=condition_batch(examples, conditions),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class SlatMoments:
    """Statistics of latents: mean, linear prior, and the deviation from it."""

    mean: Float[Tensor, "D"]
    std: Float[Tensor, "D"]
    expected: Float[Tensor, "K T D"]
    """Weights of an `artigen.appearance.linear_prior.Expectation`; none without attributes."""


def measure_slats(
    means: Sequence[Tensor],
    stds: Sequence[Tensor],
    told: Sequence[Float[np.ndarray, "N A"]] | None = None,
) -> SlatMoments:
    """Moments of draws from the posteriors of all voxels, given what is told of them.

    Args:
        means: posterior means, object by object.
        stds: posterior deviations.
        told: attributes of the voxels; without them, mean and deviation alone.
    """
    count = sum(len(one) for one in means)
    mean = torch.stack([one.double().sum(dim=0) for one in means]).sum(dim=0) / count
    rests = [one.double() - mean for one in means]
    expectation = Expectation(len(mean))
    if told is not None:
        attributes = [torch.from_numpy(one) for one in told]
        expectation.weight.copy_(fit_expectation(zip(attributes, rests, strict=True), BLUR))
        rests = [rest - expectation(one).double() for rest, one in zip(rests, attributes, strict=True)]
    squares = torch.stack([rest.square().sum(dim=0) for rest in rests]).sum(dim=0)
    noise = torch.stack([std.double().square().sum(dim=0) for std in stds]).sum(dim=0)
    return SlatMoments(
        mean=mean.float(), std=((squares + noise) / count).sqrt().float(), expected=expectation.weight
    )


def _blur(attributes: Float[Tensor, "N A"], generator: torch.Generator) -> Float[Tensor, "N A"]:
    """Attributes with paint that is a little off: for alike voxels of a label alike."""
    of_voxel = torch.cat([attributes[:, FACINGS : FACINGS + len(PART_LABELS)], attributes[:, -PAINT:]], dim=1)
    wave = torch.randn(of_voxel.shape[1], PAINT, generator=generator, device=generator.device)
    out = attributes.clone()
    out[:, -PAINT:] += BLUR * (of_voxel @ wave)
    return out
