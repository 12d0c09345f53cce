"""Training of the appearance VAE: encode, decode, articulate, render, compare (paper, section 4.2.2)."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from artigen.appearance.vae import SIDE_CHANNELS, AppearanceVae, Encoded
from artigen.examples.appearance import AppearanceExample
from artigen.examples.appearance_batches import (
    PictureBatch,
    draw_picture_batches,
    draw_pictures,
    raster_config,
    voxel_batch,
)
from artigen.examples.batches import prefetch
from artigen.latent.conv_vae import kl_divergence
from artigen.metrics.pictures import ssim_map
from artigen.train.loop import LoopConfig, finished_steps, process_seed, train

HIDDEN = 0.5
"""Share of training steps in which view features of the voxels beyond a plane are hidden."""
LEAST = 1e-2
"""Least standard deviation of a feature: a smaller one would magnify rounding errors of half precision."""


@dataclass(frozen=True, kw_only=True)
class AppearanceLossConfig:
    """Weights of the terms; the defaults are TRELLIS'."""

    l1: float = 1.0
    """Mean absolute difference of pictures."""
    exposed: float = 1.0
    """Factor on the L1 term at pixels of newly exposed surface, of which there are few."""
    ssim: float = 0.2
    """One minus structural similarity."""
    kl: float = 1e-6
    """KL of the latents to the unit Gaussian, as a mean over elements."""
    volume: float = 1e4
    """Mean product of the three scales of a Gaussian (unit-cube lengths)."""
    opacity: float = 1e-3
    """Mean squared distance of opacities to 1."""


def appearance_losses(
    encoded: Encoded, drawn: Float[Tensor, "B M H W 3"], batch: PictureBatch, cfg: AppearanceLossConfig
) -> dict[str, Tensor]:
    """The terms, each with its weight, by name."""
    first, second = (values.flatten(0, 1).permute(0, 3, 1, 2) for values in (drawn, batch.rgb))
    weight = 1.0 + (cfg.exposed - 1.0) * batch.exposed.flatten(0, 1)[:, None]
    splats = encoded.splats
    return {
        "l1": cfg.l1 * (weight * (first - second).abs()).mean(),
        "ssim": cfg.ssim * (1.0 - ssim_map(first, second).mean()),
        "kl": cfg.kl * kl_divergence(encoded.mean, encoded.logvar),
        "volume": cfg.volume * splats.scales.prod(dim=1).mean(),
        "opacity": cfg.opacity * ((splats.opacities - 1.0) ** 2).mean(),
    }


def train_appearance_vae(
    vae: AppearanceVae,
    examples: Sequence[AppearanceExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    pictures: int,
    losses: AppearanceLossConfig,
) -> AppearanceVae:
    """Trains {E, D} on pictures of objects in the joint states that the examples hold.

    Args:
        vae: New VAE; a checkpoint in the folder is resumed.
        examples: Examples in memory; closed ones alone train without articulation.
    """

    scaled = SIDE_CHANNELS if vae.encoder.cfg.sided else 0

    def terms(network: nn.Module, drawn: PictureBatch, generator: torch.Generator) -> dict[str, Tensor]:
        shape = (len(drawn.coords), vae.encoder.cfg.latent_channels)
        noise = torch.randn(shape, generator=generator, device=generator.device)
        feats = hide_views(drawn.coords, drawn.feats, generator, kept=scaled) if scaled else drawn.feats
        encoded = network(drawn.coords, feats, noise, drawn.facings)
        with torch.autocast(drawn.coords.device.type, enabled=False):  # positions need full precision
            made = draw_pictures(encoded.splats, drawn, raster_config(vae, drawn.coords.device))
            return appearance_losses(encoded, made, drawn, losses)

    center, spread = measure_features(examples, scaled=scaled)
    vae.feature_mean.copy_(center)
    vae.feature_std.copy_(spread)
    start = finished_steps(folder)
    seed = process_seed(cfg.seed)
    batches = prefetch(draw_picture_batches(examples, batch, pictures, seed, start=start))
    train(vae, terms, batches, folder, cfg)
    return vae


def hide_views(
    coords: Int[Tensor, "N 4"], feats: Float[Tensor, "N C"], generator: torch.Generator, *, kept: int
) -> Float[Tensor, "N C"]:
    """With probability `HIDDEN`, gives voxels beyond a random plane the features of unseen voxels.

    Pictures do not constrain unseen voxels, so a network that recognised them could make boards transparent
    at no cost. Hiding the views of seen voxels trains the network on such features.

    Args:
        kept: Number of last channels that hidden voxels keep.
    """
    chance, share, *normal = torch.randn(5, generator=generator, device=generator.device).split(1)
    heights = coords[:, 1:].float() @ torch.cat(normal)
    beyond = heights > heights.quantile(torch.special.ndtr(share))
    cleared = torch.cat([torch.zeros_like(feats[:, :-kept]), feats[:, -kept:]], dim=1)
    return torch.where((beyond & (torch.special.ndtr(chance) < HIDDEN))[:, None], cleared, feats)


def measure_features(
    examples: Sequence[AppearanceExample], *, scaled: int = 0
) -> tuple[Float[Tensor, "C"], Float[Tensor, "C"]]:
    """Mean and standard deviation per channel over the voxels that any view shows.

    Args:
        scaled: Number of last channels that are already scaled and get mean 0 and deviation 1.

    Raises:
        ValueError: If there is no such voxel.
    """
    count, total, squares = 0, 0.0, 0.0
    for one in examples:
        seen = one.features[one.views > 0].astype(np.float64)
        count, total, squares = count + len(seen), total + seen.sum(0), squares + (seen**2).sum(0)
    if not count:
        raise ValueError(f"{len(examples)} objects without a voxel that was seen")
    center = np.asarray(total) / count
    spread = np.sqrt(np.maximum(np.asarray(squares) / count - center**2, 0.0))
    left = len(center) - scaled
    center[left:], spread[left:] = 0.0, 1.0
    return torch.from_numpy(center).float(), torch.from_numpy(spread.clip(min=LEAST)).float()


@torch.no_grad()
def encode_appearance(
    vae: AppearanceVae, examples: Sequence[AppearanceExample]
) -> tuple[list[Tensor], list[Tensor]]:
    """Posterior means and standard deviations of every object's voxels, in half precision on the CPU."""
    device = next(vae.parameters()).device
    means, stds = [], []
    for one in examples:
        coords, feats, facings = (value.to(device) for value in voxel_batch([one]))
        mean, logvar = vae.encode(coords, feats, facings=facings)
        means.append(mean.half().cpu())
        stds.append(torch.exp(0.5 * logvar).half().cpu())
    return means, stds
