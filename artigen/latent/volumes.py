"""Layers on dense volumes ``[B, C, X, Y, Z]``, named and computed as in TRELLIS' structure VAE."""

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional


class ChannelLayerNorm(nn.LayerNorm):
    """Layer norm over the channels of every cell, in float32."""

    def forward(self, input: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B C X Y Z"]:
        last = input.movedim(1, -1).float()
        normed = functional.layer_norm(last, self.normalized_shape, self.weight, self.bias, self.eps)
        return normed.movedim(-1, 1).to(input.dtype)


class ResBlock3d(nn.Module):
    """Two 3x3x3 convolutions behind norm and SiLU, and a skip; the second one starts at zero."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.norm1 = ChannelLayerNorm(channels)
        self.norm2 = ChannelLayerNorm(channels)
        self.conv1 = nn.Conv3d(channels, channels, 3, padding=1)
        self.conv2 = nn.Conv3d(channels, channels, 3, padding=1)
        for parameter in self.conv2.parameters():
            nn.init.zeros_(parameter)

    def forward(self, x: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B C X Y Z"]:
        h = self.conv1(functional.silu(self.norm1(x)))
        return x + self.conv2(functional.silu(self.norm2(h)))


class Downsample3d(nn.Module):
    """Halves the resolution with a strided convolution."""

    def __init__(self, channels: int, out_channels: int) -> None:
        super().__init__()
        self.conv = nn.Conv3d(channels, out_channels, 2, stride=2)

    def forward(self, x: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B D A B2 C2"]:
        return self.conv(x)


class Upsample3d(nn.Module):
    """Doubles the resolution: a convolution to eight times the channels, then `shuffle_pixels`."""

    def __init__(self, channels: int, out_channels: int) -> None:
        super().__init__()
        self.conv = nn.Conv3d(channels, out_channels * 8, 3, padding=1)

    def forward(self, x: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B D A B2 C2"]:
        return shuffle_pixels(self.conv(x), 2)


def shuffle_pixels(x: Float[Tensor, "B C X Y Z"], factor: int) -> Float[Tensor, "B D A B2 C2"]:
    """Spreads groups of ``factor^3`` channels over cells: the inverse of `gather_pixels`."""
    batch, channels, *edges = x.shape
    x = x.reshape(batch, channels // factor**3, factor, factor, factor, *edges)
    x = x.permute(0, 1, 5, 2, 6, 3, 7, 4)
    return x.reshape(batch, channels // factor**3, *(edge * factor for edge in edges))


def gather_pixels(x: Float[Tensor, "B C X Y Z"], factor: int) -> Float[Tensor, "B D A B2 C2"]:
    """Stacks the cells of every ``factor^3`` block as channels, channel-major."""
    batch, channels, *edges = x.shape
    small = [edge // factor for edge in edges]
    x = x.reshape(batch, channels, small[0], factor, small[1], factor, small[2], factor)
    x = x.permute(0, 1, 3, 5, 7, 2, 4, 6)
    return x.reshape(batch, channels * factor**3, *small)


def as_tokens(x: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B L C"]:
    """One token per cell, z fastest."""
    return x.flatten(2).transpose(1, 2).contiguous()


def as_volume(tokens: Float[Tensor, "B L C"], edge: int) -> Float[Tensor, "B C X Y Z"]:
    """The cube of cells that `as_tokens` flattened."""
    return tokens.transpose(1, 2).reshape(tokens.shape[0], tokens.shape[2], edge, edge, edge)


def sample_gaussian(
    mean: Float[Tensor, "*S"], logvar: Float[Tensor, "*S"], noise: Float[Tensor, "*S"]
) -> Float[Tensor, "*S"]:
    """A draw from the posterior by the reparametrisation trick."""
    return mean + torch.exp(0.5 * logvar) * noise
