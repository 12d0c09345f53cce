"""Voxels and weights for the tests of sparse networks."""

from typing import TypeVar

import torch

Network = TypeVar("Network", bound=torch.nn.Module)


def redraw(network: Network, generator: torch.Generator) -> Network:
    """Gives every parameter a value of its own, so that no branch is silent."""
    for name, parameter in network.named_parameters():
        value = torch.randn(parameter.shape, generator=generator)
        parameter.copy_(1 + 0.1 * value if "gamma" in name else 0.2 * value)
    return network


def draw_voxels(generator: torch.Generator, counts: tuple[int, ...], edge: int = 16) -> torch.Tensor:
    """Voxels of several samples, shuffled all together."""
    rows = []
    for sample, count in enumerate(counts):
        flat = torch.randperm(edge**3, generator=generator)[:count]
        places = [flat // edge**2, flat // edge % edge, flat % edge]
        rows.append(torch.stack([torch.full_like(flat, sample), *places], dim=1))
    every = torch.cat(rows).int()
    return every[torch.randperm(len(every), generator=generator)]
