"""Training of the structure models: the VAE, then the flow on its latents."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import torch
from torch import Tensor, nn

from artigen.examples.batches import (
    FieldBatch,
    LatentBatch,
    condition_batch,
    draw_batches,
    field_batch,
    outline_batch,
    patch_batch,
    prefetch,
)
from artigen.examples.structure import StructureExample
from artigen.latent.conv_vae import kl_divergence
from artigen.latent.outline import blur_outlines
from artigen.latent.structure_flow import StructureFlow
from artigen.latent.structure_vae import StructureVae
from artigen.models.conditions import ConditionConfig, drop_conditions
from artigen.models.rectified_flow import diffuse, draw_times, target_velocity
from artigen.train.loop import LoopConfig, process_seed, train
from artigen.train.structure_losses import StructureLossConfig, structure_losses

DROPOUT = 0.1
"""Share of samples without any condition, and of open fields in the others."""
AT_ONCE = 32
"""Examples that are encoded at once."""


def train_structure_vae(
    vae: StructureVae,
    examples: Sequence[StructureExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    losses: StructureLossConfig,
) -> StructureVae:
    """Trains {E, D} on fields (paper section 4.1)."""

    def terms(network: nn.Module, fields: FieldBatch, generator: torch.Generator) -> dict[str, Tensor]:
        patches, edge = fields.patches, fields.patches.edge
        shape = (patches.samples, vae.latent_channels, edge, edge, edge)
        noise = torch.randn(shape, generator=generator, device=generator.device)
        outlines = blur_outlines(fields.outlines, 0.0, generator)
        made = network(patches, noise, outlines)
        out = structure_losses(made.logits, made.attributes, patches, losses)
        return {**out, "kl": losses.kl * kl_divergence(made.mean, made.logvar)}

    batches = prefetch(draw_batches(examples, field_batch, batch, process_seed(cfg.seed)))
    train(vae, terms, batches, folder, cfg)
    return vae


@torch.no_grad()
def encode_examples(vae: StructureVae, examples: Sequence[StructureExample]) -> tuple[Tensor, Tensor]:
    """Posterior means and standard deviations of all examples, in half precision on the VAE's device."""
    device = next(vae.parameters()).device
    means, stds = [], []
    for start in range(0, len(examples), AT_ONCE):
        mean, logvar = vae.encode(patch_batch(examples[start : start + AT_ONCE]).to(device))
        means.append(mean.half())
        stds.append(torch.exp(0.5 * logvar).half())
    return torch.cat(means), torch.cat(stds)


def measure_latents(means: Tensor, stds: Tensor) -> tuple[Tensor, Tensor]:
    """Mean and standard deviation per channel of draws from the posteriors."""
    axes = (0, 2, 3, 4)
    center = means.float().mean(dim=axes)
    spread = means.float().var(dim=axes) + (stds.float() ** 2).mean(dim=axes)
    return center, spread.sqrt()


def train_structure_flow(
    flow: StructureFlow,
    latents: tuple[Tensor, Tensor],
    examples: Sequence[StructureExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    conditions: ConditionConfig,
    time_mean: float = 1.0,
) -> StructureFlow:
    """Trains the conditional rectified flow on latents (paper section 4.3).

    Args:
        time_mean: Mean of the logits of the times, 1 in TRELLIS.
    """
    center, spread = measure_latents(*latents)
    flow.latent_mean.copy_(center)
    flow.latent_std.copy_(spread)

    def terms(network: nn.Module, drawn: LatentBatch, generator: torch.Generator) -> dict[str, Tensor]:
        noise, jitter = (
            torch.randn(drawn.mean.shape, generator=generator, device=generator.device) for _ in range(2)
        )
        x_0 = flow.normalise(drawn.mean.float() + drawn.std.float() * jitter)
        times = draw_times(len(x_0), generator, mean=time_mean)
        asked = drop_conditions(drawn.conditions, DROPOUT, generator)
        outlines = blur_outlines(drawn.outlines, DROPOUT, generator) if flow.takes_outlines else None
        velocity = network(diffuse(x_0, noise, times), times, asked, outlines)
        errors = ((velocity.float() - target_velocity(x_0, noise)) ** 2).mean(dim=(1, 2, 3, 4))
        return {"velocity": torch.mean(flow.weights(times) * errors)}

    make = partial(latent_batch, latents=latents, conditions=conditions)
    numbered = list(enumerate(examples))
    batches: Iterator[LatentBatch] = prefetch(draw_batches(numbered, make, batch, process_seed(cfg.seed)))
    train(flow, terms, batches, folder, cfg)
    return flow


def latent_batch(
    chosen: Sequence[tuple[int, StructureExample]],
    latents: tuple[Tensor, Tensor],
    conditions: ConditionConfig,
) -> LatentBatch:
    """Training batch of a flow from numbered examples: their latents, conditions and outlines."""
    rows = torch.tensor([number for number, _ in chosen], device=latents[0].device)
    examples = [example for _, example in chosen]
    return LatentBatch(
        mean=latents[0][rows],
        std=latents[1][rows],
        conditions=condition_batch(examples, conditions),
        outlines=outline_batch(examples),
    )
