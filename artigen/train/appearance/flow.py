"""Training of the sparse flow on latents of the appearance VAE, with the conditions of the structure flow."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree
from torch import Tensor, nn

from artigen.appearance.linear_prior import Expectation, fit_expectation
from artigen.appearance.paint import PAINT
from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.vae import SIDE_CHANNELS
from artigen.examples.appearance import AppearanceExample
from artigen.examples.appearance_batches import place_batch
from artigen.examples.batches import condition_batch, draw_batches, prefetch
from artigen.models.batch import TensorBatch
from artigen.models.conditions import (
    ALONE,
    ConditionBatch,
    ConditionConfig,
    drop_conditions,
    isolate_pictures,
)
from artigen.models.rectified_flow import diffuse, draw_times, target_velocity
from artigen.train.appearance.drawn import DrawnVoxels
from artigen.train.loop import LoopConfig, process_seed, train
from artigen.train.structure import DROPOUT
from artigen.types import PART_LABELS
from artigen.voxels.frames import FACINGS

BLUR = 0.02
"""Approximate standard deviation of the noise on paint in training."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SlatBatch(TensorBatch):
    """Posteriors of the voxels of several objects, with their conditions."""

    coords: Int[Tensor, "N 4"]
    mean: Float[Tensor, "N D"]
    std: Float[Tensor, "N D"]
    attributes: Float[Tensor, "N A"]
    conditions: ConditionBatch


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
) -> SlatFlow:
    """Trains the conditional sparse flow on the latents of true voxels and, if given, of sampled ones.

    Args:
        flow: New flow; a checkpoint in the folder is resumed.
        noisiness: Mean of the logits of training times.
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
        plan = flow.network.plan(given.coords, samples)
        attributes = _blur(given.attributes, generator) if flow.attribute_channels else None
        x_0 = flow.normalise(given.mean + given.std * jitter, attributes)
        velocity = network(diffuse(x_0, noise, row_times), times, asked, plan, attributes)
        return {"velocity": torch.mean((velocity.float() - target_velocity(x_0, noise)) ** 2)}

    make = partial(slat_batch, latents=latents, conditions=conditions)
    batches: Iterator[SlatBatch] = prefetch(
        draw_batches(list(enumerate(examples)), make, batch, process_seed(cfg.seed))
    )
    train(flow, terms, batches, folder, cfg)
    return flow


def redraw_slats(
    flow: SlatFlow, example: AppearanceExample, posterior: tuple[Tensor, Tensor], drawn: DrawnVoxels
) -> tuple[AppearanceExample, Tensor, Tensor]:
    """An object with sampled voxels, and their posterior means and standard deviations."""
    models, sure = find_models(example, drawn)
    other = transfer_looks(example, drawn, models)
    mean, std = posterior
    attributes = (example.attributes(), other.attributes())
    return other, transfer_latents(flow, mean.float(), attributes, models, sure), std[models]


def slat_batch(
    chosen: Sequence[tuple[int, AppearanceExample]],
    latents: tuple[Sequence[Tensor], Sequence[Tensor]],
    conditions: ConditionConfig,
) -> SlatBatch:
    """Batch of numbered examples, with their rows of ``latents``."""
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
    """Statistics of latents: mean, linear prior, and the standard deviation from it."""

    mean: Float[Tensor, "D"]
    std: Float[Tensor, "D"]
    expected: Float[Tensor, "K T D"]
    """Weights of an `artigen.appearance.linear_prior.Expectation`; zero without attributes."""


def measure_slats(
    means: Sequence[Tensor], stds: Sequence[Tensor], told: Sequence[Float[np.ndarray, "N A"]] | None = None
) -> SlatMoments:
    """Moments of samples from the posteriors of all voxels, given their attributes.

    Args:
        told: Attributes of the voxels; without them there is no linear prior.
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
    """Attributes with noise on their paint: a random linear map of label and paint, alike for like voxels."""
    of_voxel = torch.cat([attributes[:, FACINGS : FACINGS + len(PART_LABELS)], attributes[:, -PAINT:]], dim=1)
    wave = torch.randn(of_voxel.shape[1], PAINT, generator=generator, device=generator.device)
    out = attributes.clone()
    out[:, -PAINT:] += BLUR * (of_voxel @ wave)
    return out


def find_models(
    example: AppearanceExample, drawn: DrawnVoxels
) -> tuple[Int[np.ndarray, "M"], Bool[np.ndarray, "M"]]:
    """Row of the true voxel whose appearance each sampled one takes, and a mask of those that match it.

    Strays, which match none, take the nearest true voxel of their part.
    """
    count = len(drawn.coords)
    models, sure = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=bool)
    models[drawn.rows], sure[drawn.rows] = drawn.like, True
    for part in np.unique(drawn.part_ids[~sure]):
        strays = np.flatnonzero((drawn.part_ids == part) & ~sure)
        own = np.flatnonzero(example.part_ids == part)
        models[strays] = own[KDTree(example.coords[own]).query(drawn.coords[strays])[1]]
    return models, sure


def transfer_looks(
    example: AppearanceExample, drawn: DrawnVoxels, models: Int[np.ndarray, "M"]
) -> AppearanceExample:
    """The example with sampled voxels, each with paint and surface position of its model voxel.

    Only the side features remain, because they hold the surface positions (`AppearanceExample.places`).
    """
    return replace(
        example,
        coords=drawn.coords.astype(np.uint8),
        part_ids=drawn.part_ids.astype(np.uint8),
        facings=drawn.facings.astype(np.uint8),
        paint=example.paint[models],
        features=example.features[models, -SIDE_CHANNELS:],
        views=example.views[models],
    )


@torch.no_grad()
def transfer_latents(
    flow: SlatFlow,
    mean: Float[Tensor, "N D"],
    told: tuple[Float[np.ndarray, "N A"], Float[np.ndarray, "M A"]],
    models: Int[np.ndarray, "M"],
    sure: Bool[np.ndarray, "M"],
) -> Float[Tensor, "M D"]:
    """Latents of sampled voxels: their linear prior plus the residual of their model voxel; zero for strays.

    Args:
        told: Attributes of the true voxels and of the sampled ones.
        models: Row of the true voxel whose appearance each sampled one takes.
        sure: Mask of the sampled voxels that match it.
    """
    true, drawn = (torch.from_numpy(one) for one in told)
    off = flow.normalise(mean, true)[models]
    off[torch.from_numpy(~sure)] = 0.0
    return flow.restore(off, drawn)
