"""Fine-tunes the decoder on the flow's estimates; encoder and flow are frozen.

A decoder trained on posteriors alone decodes every error of a sampled latent into geometry. Here it is
trained on the flow's estimates of clean latents, from anywhere on the path, towards the original object.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor, nn

from artigen.examples.batches import FieldBatch, LatentBatch, draw_batches, field_batch, prefetch
from artigen.examples.structure import StructureExample
from artigen.latent.outline import OutlineBatch, blur_outlines
from artigen.latent.structure_flow import StructureFlow
from artigen.latent.structure_vae import StructureVae
from artigen.models.batch import TensorBatch
from artigen.models.conditions import ConditionConfig
from artigen.models.rectified_flow import diffuse, predict_data
from artigen.train.loop import LoopConfig, process_seed, train
from artigen.train.structure import latent_batch
from artigen.train.structure_losses import StructureLossConfig, structure_losses

AGAIN = 0.5
"""Share of latents that are estimated a second time, from less noise, as in sampling."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EncodedFields(TensorBatch):
    """Fields of objects with their latents."""

    fields: FieldBatch
    latents: LatentBatch


class Decoding(nn.Module):
    """A VAE whose encoder is frozen."""

    def __init__(self, vae: StructureVae) -> None:
        super().__init__()
        self.vae = vae
        vae.encoder.requires_grad_(requires_grad=False)

    def forward(
        self, z: Float[Tensor, "B D X Y Z"], fields: FieldBatch, outlines: OutlineBatch
    ) -> tuple[Float[Tensor, "N K"], Float[Tensor, "P K C"]]:
        """Occupancy logits of every cell, and the channels of the occupied patches."""
        logits, attributes, _ = self.vae.decode(z, fields.patches.index, outlines)
        return logits, attributes


def train_decoder(
    vae: StructureVae,
    flow: StructureFlow,
    latents: tuple[Tensor, Tensor],
    examples: Sequence[StructureExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    losses: StructureLossConfig,
    conditions: ConditionConfig,
) -> StructureVae:
    """Trains the decoder of a VAE on a flow's estimates."""

    def terms(network: nn.Module, drawn: EncodedFields, generator: torch.Generator) -> dict[str, Tensor]:
        outlines = blur_outlines(drawn.fields.outlines, 0.0, generator)
        guess = guess_latents(flow.to(drawn.latents.mean.device), drawn.latents, outlines, generator)
        logits, attributes = network(guess, drawn.fields, outlines)
        return structure_losses(logits, attributes, drawn.fields.patches, losses)

    flow.eval()
    make = partial(_encoded_fields, latents=latents, conditions=conditions)
    numbered = list(enumerate(examples))
    batches: Iterator[EncodedFields] = prefetch(draw_batches(numbered, make, batch, process_seed(cfg.seed)))
    train(Decoding(vae), terms, batches, folder, cfg)
    vae.encoder.requires_grad_(requires_grad=True)
    return vae


@torch.no_grad()
def guess_latents(
    flow: StructureFlow, drawn: LatentBatch, outlines: OutlineBatch, generator: torch.Generator
) -> Float[Tensor, "B C X Y Z"]:
    """The flow's estimates of the latents of a batch, from times uniform between data and noise."""
    tokens, hint = flow.conditions(drawn.conditions), flow.hint(outlines)
    jitter, first, second = (
        torch.randn(drawn.mean.shape, generator=generator, device=generator.device) for _ in range(3)
    )
    times, less, chance = (
        torch.rand(len(drawn.mean), generator=generator, device=generator.device) for _ in range(3)
    )

    def guess(clean: Tensor, noise: Tensor, at: Tensor) -> Tensor:
        x = diffuse(clean, noise, at)
        return predict_data(x, flow.velocity(x, at, tokens, hint), at)

    once = guess(flow.normalise(drawn.mean.float() + drawn.std.float() * jitter), first, times)
    twice = guess(once, second, times * less)
    return flow.restore(torch.where((chance < AGAIN).reshape(-1, 1, 1, 1, 1), twice, once))


def _encoded_fields(
    chosen: Sequence[tuple[int, StructureExample]],
    latents: tuple[Tensor, Tensor],
    conditions: ConditionConfig,
) -> EncodedFields:
    return EncodedFields(
        fields=field_batch([example for _, example in chosen]),
        latents=latent_batch(chosen, latents, conditions),
    )
