"""Encoder of voxel features and decoder to Gaussians, trained together (section 4.2 of the paper)."""

from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from artigen.appearance.gaussian_decoder import GaussianDecoder, GaussianDecoderConfig
from artigen.appearance.slat_vae import SlatEncoder, SlatVaeConfig, WindowPlans
from artigen.splats.colors import HARMONIC
from artigen.splats.render.splats import Splats
from artigen.voxels.surface import MIDDLE_SPREAD

APPEARANCE_VAE, APPEARANCE_FLOW = "appearance-vae", "appearance-flow"
"""Names of the networks in a model folder."""
NARROW = -6.0
"""Log-variance of an untrained posterior: low, so that features reach the decoder from the first step."""

SIDE_CHANNELS = 13
"""Last features of a voxel with two sides: transmission; colour and height of the outer and of the inner
side; middles and widths of the surface across (`artigen.appearance.sides`)."""
SIDE_LATENTS = 13
"""Latents of a voxel with two sides: colours, heights, transmission, middles and widths."""
COLOR_MIDDLE, COLOR_SPREAD = 0.5, 0.25
"""Offset and divisor of colours in side features: about their mean and standard deviation."""
CLEARING = -6.0
"""Initial weight of a voxel's transmission on the raw opacities of its Gaussians."""
SHRINKING = 0.6
"""Initial weight of the logarithm of a width on offsets across; their spread is then about the width."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Encoded:
    """Gaussians of all voxels, and the posterior of the latents they came from."""

    splats: Splats
    mean: Float[Tensor, "N D"]
    logvar: Float[Tensor, "N D"]


class AppearanceVae(nn.Module):
    """Features of voxels to latents, and those to Gaussians.

    ``feature_mean`` and ``feature_std`` per channel belong to the weights. The encoder reads normalised
    features, which would otherwise be small beside the position embedding.

    Raises:
        ValueError: If encoder and decoder do not fit each other, or latents are too narrow for two sides.
    """

    feature_mean: Tensor
    feature_std: Tensor

    def __init__(self, encoder: SlatVaeConfig, decoder: GaussianDecoderConfig) -> None:
        super().__init__()
        trunk = decoder.trunk
        for name in ("resolution", "latent_channels", "window_size", "sided"):
            one, other = getattr(encoder, name), getattr(trunk, name)
            if one != other:
                raise ValueError(f"{name} is {one} in the encoder and {other} in the decoder")
        if encoder.sided and encoder.latent_channels < SIDE_LATENTS:
            raise ValueError(f"{encoder.latent_channels} latent channels, two sides take {SIDE_LATENTS}")
        self.encoder = SlatEncoder(encoder)
        self.decoder = GaussianDecoder(decoder)
        self.register_buffer("feature_mean", torch.zeros(encoder.in_channels))
        self.register_buffer("feature_std", torch.ones(encoder.in_channels))
        last, width = self.encoder.out_layer, encoder.latent_channels
        nn.init.xavier_uniform_(last.weight[:width])
        nn.init.constant_(last.bias[width:], NARROW)
        if encoder.sided:
            _lead_sides_through(self.encoder, self.decoder)

    def forward(
        self,
        coords: Int[Tensor, "N 4"],
        feats: Float[Tensor, "N C"],
        noise: Float[Tensor, "N D"],
        facings: Int[Tensor, "N"] | None = None,
    ) -> Encoded:
        """Encodes, samples the posterior with the given noise, and decodes.

        Args:
            noise: Standard normal; zero gives the means.
            facings: Directions of the outer sides; ignored where voxels have no sides.
        """
        plans = self.encoder.plan(coords)
        facings = facings if self.encoder.cfg.sided else None
        mean, logvar = self.encode(coords, feats, plans, facings)
        latents = mean + noise * torch.exp(0.5 * logvar)
        return Encoded(splats=self.decoder(coords, latents, plans, facings), mean=mean, logvar=logvar)

    def encode(
        self,
        coords: Int[Tensor, "N 4"],
        feats: Float[Tensor, "N C"],
        plans: WindowPlans | None = None,
        facings: Int[Tensor, "N"] | None = None,
    ) -> tuple[Float[Tensor, "N D"], Float[Tensor, "N D"]]:
        """Mean and log-variance of the latents of voxels (sample, x, y, z) with features."""
        facings = facings if self.encoder.cfg.sided else None
        return self.encoder(coords, (feats - self.feature_mean) / self.feature_std, plans, facings)


@torch.no_grad()
def _lead_sides_through(encoder: SlatEncoder, decoder: GaussianDecoder) -> None:
    """Initialises the skip layers so that untrained networks already give Gaussians near the right ones.

    The first latents are the colours of the outer and of the inner side, both heights, the transmission, and
    the middles and logarithms of widths across.
    """
    assert encoder.skip is not None
    assert decoder.skip is not None
    clear, sides, across = torch.arange(-SIDE_CHANNELS, 0).split([1, SIDE_CHANNELS - 5, 4])
    outer, inner = sides.unflatten(0, (2, -1))
    features = torch.cat([outer[:3], inner[:3], outer[3:4], inner[3:4], clear, across])
    latents = torch.arange(len(features))
    encoder.out_layer.weight[latents] = 0.0
    encoder.skip.weight[latents, features] = 1.0
    half = decoder.gaussians.count // 2
    colors, offsets, scales = (decoder.channels(name) for name in ("color", "offset", "scale"))
    for color, height, rows in (((0, 1, 2), 6, slice(0, half)), ((3, 4, 5), 7, slice(half, None))):
        decoder.skip.weight[colors[rows], torch.tensor(color)] = COLOR_SPREAD / HARMONIC
        decoder.skip.weight[offsets[rows, 0], height] = 1.0
    decoder.skip.weight[decoder.channels("opacity")[:, 0], 8] = CLEARING
    raw = 2.0 / decoder.gaussians.reach  # raw offsets are shares of half the reach
    spread = torch.tanh(decoder.offset_perturbation)
    for axis, (middle, width) in enumerate(((9, 11), (10, 12)), start=1):
        decoder.skip.weight[offsets[:, axis], middle] = raw * MIDDLE_SPREAD
        decoder.skip.weight[offsets[:, axis], width] = SHRINKING * spread[:, axis]
        decoder.skip.weight[scales[:, axis], width] = 1.0
