"""Embeddings of time and position."""

import math

import torch
from jaxtyping import Float
from torch import Tensor, nn

FREQUENCIES = 256


def embed_times(times: Float[Tensor, "B"]) -> Float[Tensor, "B W"]:
    """Cosines, then sines, of the times at ``FREQUENCIES / 2`` frequencies from 1 down to 1/10000."""
    half = FREQUENCIES // 2
    rates = torch.exp(
        -math.log(10000.0) * torch.arange(half, dtype=torch.float32, device=times.device) / half
    )
    angles = times.float()[:, None] * rates
    return torch.cat([angles.cos(), angles.sin()], dim=-1)


def embed_positions(places: Float[Tensor, "N 3"], channels: int) -> Float[Tensor, "N C"]:
    """Sines, then cosines, per axis; axes are concatenated and padded with zeros."""
    half = channels // 3 // 2
    rates = 1.0 / 10000.0 ** (torch.arange(half, dtype=torch.float32, device=places.device) / half)
    angles = places.float()[:, :, None] * rates
    waves = torch.cat([angles.sin(), angles.cos()], dim=-1).flatten(1)
    return nn.functional.pad(waves, (0, channels - waves.shape[1]))


def grid_positions(edge: int) -> Float[Tensor, "N 3"]:
    """Index triples of a cube's cells, z fastest."""
    line = torch.arange(edge, dtype=torch.float32)
    return torch.stack(torch.meshgrid(line, line, line, indexing="ij"), dim=-1).reshape(-1, 3)


class TimestepEmbedder(nn.Module):
    """Time (0 to 1000) to a vector."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.mlp = nn.Sequential(nn.Linear(FREQUENCIES, channels), nn.SiLU(), nn.Linear(channels, channels))

    def forward(self, times: Float[Tensor, "B"]) -> Float[Tensor, "B C"]:
        return self.mlp(embed_times(times).to(next(self.parameters()).dtype))
