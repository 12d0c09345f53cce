"""Convolutions on active voxels, with the parameter names of TRELLIS.

A submanifold convolution reads and writes active voxels only. Its weights are laid out as (out, kernel x,
kernel y, kernel z, in), as public checkpoints store them.
"""

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional

from artigen.appearance.sparse import Neighbours
from artigen.models.attention import NORM_EPS, learned_norm, plain_norm

EDGE = 3
MIDDLE = EDGE**3 // 2


class KernelWeights(nn.Module):
    """Weight ``[out, 3, 3, 3, in]`` and bias of a convolution."""

    def __init__(self, channels: int, out_channels: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.empty(out_channels, EDGE, EDGE, EDGE, channels))
        self.bias = nn.Parameter(torch.zeros(out_channels))
        bound = (EDGE**3 * channels) ** -0.5
        nn.init.uniform_(self.weight, -bound, bound)


class SparseConv3d(nn.Module):
    """Submanifold convolution with a kernel of 3x3x3."""

    def __init__(self, channels: int, out_channels: int) -> None:
        super().__init__()
        self.conv = KernelWeights(channels, out_channels)

    def forward(self, feats: Float[Tensor, "N C"], neighbours: Neighbours) -> Float[Tensor, "N D"]:
        """Features of the same voxels; sums in float32."""
        kernel = self.conv.weight.flatten(1, 3)
        middle = functional.linear(feats, kernel[:, MIDDLE], self.conv.bias)
        total = middle.float()
        around = [cell for cell in range(EDGE**3) if cell != MIDDLE]
        for cell, rows, read in zip(around, neighbours.receiving, neighbours.reading, strict=True):
            total.index_add_(0, rows, functional.linear(feats.index_select(0, read), kernel[:, cell]).float())
        return total.to(middle.dtype)


class SparseResBlock3d(nn.Module):
    """Two convolutions, the second one modulated by time and starting at zero, and a skip."""

    def __init__(self, channels: int, out_channels: int, embedding: int) -> None:
        super().__init__()
        self.norm1 = nn.LayerNorm(channels, eps=NORM_EPS)
        self.conv1 = SparseConv3d(channels, out_channels)
        self.conv2 = SparseConv3d(out_channels, out_channels)
        self.emb_layers = nn.Sequential(nn.SiLU(), nn.Linear(embedding, 2 * out_channels))
        self.skip_connection = (
            nn.Identity() if channels == out_channels else nn.Linear(channels, out_channels)
        )
        nn.init.zeros_(self.conv2.conv.weight)

    def forward(
        self,
        feats: Float[Tensor, "N C"],
        emb: Float[Tensor, "B E"],
        samples: Int[Tensor, "N"],
        neighbours: Neighbours,
    ) -> Float[Tensor, "N D"]:
        """Features of the same voxels."""
        h = self.conv1(functional.silu(learned_norm(feats, self.norm1)), neighbours)
        scale, shift = self.emb_layers(emb)[samples].chunk(2, dim=1)
        h = self.conv2(functional.silu(plain_norm(h) * (1 + scale) + shift), neighbours)
        return h + self.skip_connection(feats)
