"""The 3D convolutional structure VAE of TRELLIS, any number of input and output channels.

Parameter names and shapes are those of `SparseStructureEncoder` and `SparseStructureDecoder`, so public
checkpoints load strictly; the paper's {E, D} is the same network with 35 channels (section 4.1).
"""

from dataclasses import dataclass
from itertools import pairwise

import torch
from jaxtyping import Float
from torch import Tensor, nn

from artigen.latent.volumes import ChannelLayerNorm, Downsample3d, ResBlock3d, Upsample3d


@dataclass(frozen=True, kw_only=True)
class ConvVaeConfig:
    """Sizes of encoder and decoder; the defaults are the paper's."""

    in_channels: int = 35
    """Channels of the voxel field."""
    latent_channels: int = 8
    """Channels of the latent."""
    channels: tuple[int, ...] = (32, 128, 512)
    """Channels per level, finest first; every further level halves the resolution."""
    res_blocks: int = 2
    """Residual blocks per level."""
    middle_blocks: int = 2
    """Residual blocks at the coarsest level."""


class ConvEncoder(nn.Module):
    """Field to the mean and log-variance of its latent."""

    def __init__(self, cfg: ConvVaeConfig) -> None:
        super().__init__()
        self.input_layer = nn.Conv3d(cfg.in_channels, cfg.channels[0], 3, padding=1)
        self.blocks = nn.ModuleList()
        for level, channels in enumerate(cfg.channels):
            self.blocks.extend(ResBlock3d(channels) for _ in range(cfg.res_blocks))
            if level + 1 < len(cfg.channels):
                self.blocks.append(Downsample3d(channels, cfg.channels[level + 1]))
        last = cfg.channels[-1]
        self.middle_block = nn.Sequential(*(ResBlock3d(last) for _ in range(cfg.middle_blocks)))
        self.out_layer = nn.Sequential(
            ChannelLayerNorm(last), nn.SiLU(), nn.Conv3d(last, 2 * cfg.latent_channels, 3, padding=1)
        )

    def forward(
        self, x: Float[Tensor, "B C X Y Z"]
    ) -> tuple[Float[Tensor, "B D A B2 C2"], Float[Tensor, "B D A B2 C2"]]:
        """Mean and log-variance of the latent."""
        h = self.input_layer(x)
        for block in self.blocks:
            h = block(h)
        mean, logvar = self.out_layer(self.middle_block(h)).chunk(2, dim=1)
        return mean, logvar


class ConvDecoder(nn.Module):
    """Latent to the channels of the field: logits and plain values, as the caller reads them."""

    def __init__(self, cfg: ConvVaeConfig) -> None:
        super().__init__()
        widths = tuple(reversed(cfg.channels))
        self.input_layer = nn.Conv3d(cfg.latent_channels, widths[0], 3, padding=1)
        self.middle_block = nn.Sequential(*(ResBlock3d(widths[0]) for _ in range(cfg.middle_blocks)))
        self.blocks = nn.ModuleList()
        for channels, following in pairwise((*widths, 0)):
            self.blocks.extend(ResBlock3d(channels) for _ in range(cfg.res_blocks))
            if following:
                self.blocks.append(Upsample3d(channels, following))
        self.out_layer = nn.Sequential(
            ChannelLayerNorm(widths[-1]), nn.SiLU(), nn.Conv3d(widths[-1], cfg.in_channels, 3, padding=1)
        )

    def forward(self, z: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B D A B2 C2"]:
        h = self.middle_block(self.input_layer(z))
        for block in self.blocks:
            h = block(h)
        return self.out_layer(h)


def kl_divergence(mean: Tensor, logvar: Tensor) -> Tensor:
    """KL to the unit Gaussian, as a mean over elements (TRELLIS' weighting; 0.001 in the paper)."""
    return 0.5 * torch.mean(mean**2 + logvar.exp() - logvar - 1.0)
