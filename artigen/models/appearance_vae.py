"""Encoder of voxel features and decoder to Gaussians, trained together (section 4.2 of the paper)."""

from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from artigen.models.gaussian_decoder import HARMONIC, GaussianDecoder, GaussianDecoderConfig
from artigen.models.slat_vae import SlatEncoder, SlatVaeConfig, WindowPlans
from artigen.splats.render.splats import Splats

APPEARANCE_VAE, APPEARANCE_PALETTE, APPEARANCE_FLOW = (
    "appearance-vae",
    "appearance-palette",
    "appearance-flow",
)
"""Names of the networks in a model folder."""
NARROW = -6.0
"""Log-variance of an untrained posterior: what the features say reaches the decoder from the first step."""

COLOR_SPREAD = 0.25
"""About the deviation of colours, by which the encoder divides them."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Encoded:
    """Gaussians of all voxels, and the posterior of the latents they came from."""

    splats: Splats
    mean: Float[Tensor, "N D"]
    logvar: Float[Tensor, "N D"]


class AppearanceVae(nn.Module):
    """Features of voxels to latents, and those to Gaussians.

    ``feature_mean`` and ``feature_std`` per channel belong to the weights: features are small numbers beside
    the waves that say where a voxel is, so the encoder reads them normalised.

    Raises:
        ValueError: If the two do not fit each other.
    """

    feature_mean: Tensor
    feature_std: Tensor

    def __init__(self, encoder: SlatVaeConfig, decoder: GaussianDecoderConfig) -> None:
        super().__init__()
        trunk = decoder.trunk
        for name in ("resolution", "latent_channels", "window_size"):
            one, other = getattr(encoder, name), getattr(trunk, name)
            if one != other:
                raise ValueError(f"{name} is {one} in the encoder and {other} in the decoder")
        self.encoder = SlatEncoder(encoder)
        self.decoder = GaussianDecoder(decoder)
        self.register_buffer("feature_mean", torch.zeros(encoder.in_channels))
        self.register_buffer("feature_std", torch.ones(encoder.in_channels))
        last, width = self.encoder.out_layer, encoder.latent_channels
        nn.init.xavier_uniform_(last.weight[:width])
        nn.init.constant_(last.bias[width:], NARROW)
        if self.encoder.skip is not None and self.decoder.skip is not None:
            _lead_colors_through(self.encoder, self.decoder)

    @property
    def count(self) -> int:
        """Gaussians per voxel."""
        return self.decoder.gaussians.count

    def forward(
        self, coords: Int[Tensor, "N 4"], feats: Float[Tensor, "N C"], noise: Float[Tensor, "N D"]
    ) -> Encoded:
        """Encodes, draws from the posterior with the given noise, and decodes.

        Args:
            coords: sample, x, y, z of each voxel.
            feats: its features.
            noise: standard normal; zero gives the means.
        """
        plans = self.encoder.plan(coords)
        mean, logvar = self.encode(coords, feats, plans)
        latents = mean + noise * torch.exp(0.5 * logvar)
        return Encoded(splats=self.decoder(coords, latents, plans), mean=mean, logvar=logvar)

    def encode(
        self, coords: Int[Tensor, "N 4"], feats: Float[Tensor, "N C"], plans: WindowPlans | None = None
    ) -> tuple[Float[Tensor, "N D"], Float[Tensor, "N D"]]:
        """Mean and log-variance of the latents of voxels (sample, x, y, z) with features."""
        return self.encoder(coords, (feats - self.feature_mean) / self.feature_std, plans)


@torch.no_grad()
def _lead_colors_through(encoder: SlatEncoder, decoder: GaussianDecoder) -> None:
    """Lets untrained networks give each Gaussian its voxel's colour, with which features start."""
    assert encoder.skip is not None
    assert decoder.skip is not None
    color = torch.arange(3)
    encoder.out_layer.weight[color] = 0.0
    encoder.skip.weight[color, color] = 1.0
    channels = decoder.color_channels()
    decoder.skip.weight[channels, color] = COLOR_SPREAD / HARMONIC
