"""Training of the appearance VAE: encode, decode, articulate, draw, compare (section 4.2.2 of the paper)."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import torch
from torch import Tensor, nn

from artigen.models.appearance_vae import AppearanceVae
from artigen.models.features import FeatureExtractor
from artigen.train.appearance.batches import PictureBatch, draw_picture_batches, voxel_batch
from artigen.train.appearance.examples import AppearanceExample
from artigen.train.appearance.losses import (
    AppearanceLossConfig,
    appearance_losses,
    draw_pictures,
    raster_config,
)
from artigen.train.batches import prefetch
from artigen.train.loop import LoopConfig, finished_steps, train

Report = Callable[[Mapping[str, float]], None]


def train_appearance_vae(
    vae: AppearanceVae,
    examples: Sequence[AppearanceExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    pictures: int,
    losses: AppearanceLossConfig,
    extractor: FeatureExtractor | None = None,
    on_report: Report | None = None,
) -> AppearanceVae:
    """Trains {E, D} on pictures of objects in the joint states that the examples hold.

    Args:
        vae: untrained, or what the folder's checkpoint continues.
        examples: in memory; closed ones alone train without articulation.
        folder: of the stage.
        cfg: budget and rates.
        batch: objects per step.
        pictures: of each object per step.
        losses: weights of the terms.
        extractor: of the perceptual term, if it has a weight.
        on_report: called with every line of metrics.
    """

    def terms(network: nn.Module, drawn: PictureBatch, generator: torch.Generator) -> dict[str, Tensor]:
        shape = (len(drawn.coords), vae.encoder.cfg.latent_channels)
        noise = torch.randn(shape, generator=generator, device=generator.device)
        encoded = network(drawn.coords, drawn.feats, noise)
        with torch.autocast(drawn.coords.device.type, enabled=False):  # places need all of their digits
            made = draw_pictures(encoded.splats, drawn, raster_config(vae, drawn.coords.device))
            return appearance_losses(encoded, made, drawn, losses, extractor)

    start = finished_steps(folder)
    batches = prefetch(draw_picture_batches(examples, batch, pictures, cfg.seed, start=start))
    train(vae, terms, batches, folder, cfg, on_report=on_report)
    return vae


@torch.no_grad()
def encode_appearance(
    vae: AppearanceVae, examples: Sequence[AppearanceExample]
) -> tuple[list[Tensor], list[Tensor]]:
    """Posterior means and standard deviations of every object's voxels, in half precision on the CPU."""
    device = next(vae.parameters()).device
    means, stds = [], []
    for one in examples:
        coords, feats = voxel_batch([one])
        mean, logvar = vae.encoder(coords.to(device), feats.to(device))
        means.append(mean.half().cpu())
        stds.append(torch.exp(0.5 * logvar).half().cpu())
    return means, stds
