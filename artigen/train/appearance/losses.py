"""Losses of the appearance VAE: pictures of articulated Gaussians against the true ones (section 4.2.2).

Weights are those of TRELLIS, without its perceptual term.
"""

from dataclasses import dataclass

from jaxtyping import Float
from torch import Tensor

from artigen.appearance.vae import Encoded
from artigen.examples.appearance_batches import PictureBatch
from artigen.latent.conv_vae import kl_divergence
from artigen.metrics.pictures import ssim_map


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
    encoded: Encoded,
    drawn: Float[Tensor, "B M H W 3"],
    batch: PictureBatch,
    cfg: AppearanceLossConfig,
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
