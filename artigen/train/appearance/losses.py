"""Losses of the appearance VAE: pictures of articulated Gaussians against the true ones (section 4.2.2).

Weights are TRELLIS'; its perceptual term takes any feature extractor here and is left out by default.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.appearance.features import FeatureExtractor
from artigen.appearance.gaussian_decoder import select_voxels
from artigen.appearance.vae import AppearanceVae, Encoded
from artigen.appearance.views import pick_cameras
from artigen.latent.conv_vae import kl_divergence
from artigen.metrics.pictures import ssim_map
from artigen.splats.render import RasterConfig, move_splats, rasterize
from artigen.splats.render.splats import Splats
from artigen.train.appearance.batches import PictureBatch

CPU_FRAGMENTS, GPU_FRAGMENTS = 1 << 19, 1 << 24


@dataclass(frozen=True, kw_only=True)
class AppearanceLossConfig:
    """Weights of the terms; the defaults are TRELLIS'."""

    l1: float = 1.0
    """Mean absolute difference of pictures."""
    exposed: float = 1.0
    """How many times it counts at pixels of newly exposed surface, of which there are few."""
    ssim: float = 0.2
    """One minus structural similarity."""
    kl: float = 1e-6
    """KL of the latents to the unit Gaussian, as a mean over elements."""
    volume: float = 1e4
    """Mean product of the three scales of a Gaussian (unit-cube lengths)."""
    opacity: float = 1e-3
    """Mean squared distance of opacities to 1."""
    perceptual: float = 0.0
    """Mean absolute difference of feature maps of the pictures; needs an extractor that lets gradients
    through."""


def appearance_losses(
    encoded: Encoded,
    drawn: Float[Tensor, "B M H W 3"],
    batch: PictureBatch,
    cfg: AppearanceLossConfig,
    extractor: FeatureExtractor | None = None,
) -> dict[str, Tensor]:
    """The terms, each with its weight, by name.

    Args:
        encoded: what the networks say about the batch.
        drawn: pictures of its Gaussians, as `draw_pictures` makes them.
        batch: the truth.
        cfg: weights.
        extractor: of the perceptual term.

    Raises:
        ValueError: If there is a perceptual term and no extractor.
    """
    first, second = (values.flatten(0, 1).permute(0, 3, 1, 2) for values in (drawn, batch.rgb))
    weight = 1.0 + (cfg.exposed - 1.0) * batch.exposed.flatten(0, 1)[:, None]
    splats = encoded.splats
    terms = {
        "l1": cfg.l1 * (weight * (first - second).abs()).mean(),
        "ssim": cfg.ssim * (1.0 - ssim_map(first, second).mean()),
        "kl": cfg.kl * kl_divergence(encoded.mean, encoded.logvar),
        "volume": cfg.volume * splats.scales.prod(dim=1).mean(),
        "opacity": cfg.opacity * ((splats.opacities - 1.0) ** 2).mean(),
    }
    if cfg.perceptual:
        if extractor is None:
            raise ValueError(f"a perceptual term of weight {cfg.perceptual:g} needs a feature extractor")
        maps = [extractor(torch.cat([one, torch.ones_like(one[:, :1])], dim=1)) for one in (first, second)]
        terms["perceptual"] = cfg.perceptual * (maps[0] - maps[1]).abs().mean()
    return terms


def draw_pictures(splats: Splats, batch: PictureBatch, cfg: RasterConfig) -> Float[Tensor, "B M H W 3"]:
    """Pictures of a batch: the Gaussians of each object, moved with their parts, from its cameras.

    Args:
        splats: of all voxels of the batch, voxel after voxel.
        batch: joint states, cameras and backgrounds.
        cfg: of the rasteriser.
    """
    return torch.stack(
        [
            draw_sample(
                select_voxels(splats, batch.coords[:, 0] == sample),
                batch.part_ids[batch.coords[:, 0] == sample],
                batch,
                sample,
                cfg,
            )
            for sample in range(len(batch.cameras))
        ]
    )


def draw_sample(
    splats: Splats, part_ids: Int[Tensor, "N"], batch: PictureBatch, sample: int, cfg: RasterConfig
) -> Float[Tensor, "M H W 3"]:
    """The pictures of one object of a batch; ``part_ids`` are those of its voxels."""
    owners = part_ids.repeat_interleave(len(splats.means) // len(part_ids))
    cameras = batch.cameras[sample]
    out = []
    for picture, displacements in enumerate(batch.displacements[sample]):
        one = torch.tensor([picture])
        out.append(
            rasterize(
                move_splats(splats, owners, displacements),
                pick_cameras(cameras, one),
                background=batch.background[sample, picture],
                cfg=cfg,
            ).color[0]
        )
    return torch.stack(out)


def raster_config(vae: AppearanceVae, device: torch.device) -> RasterConfig:
    """The rasteriser that a decoder's Gaussians are meant for, with a device's working memory."""
    return RasterConfig(
        filter_variance=vae.decoder.gaussians.screen_filter,
        fragments=GPU_FRAGMENTS if device.type == "cuda" else CPU_FRAGMENTS,
    )
