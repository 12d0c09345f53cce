"""Active voxels as plain tensors: positions ``[N, 4]`` (sample, x, y, z), features ``[N, C]``, any order.

What depends on the places alone (neighbours, parents, how tokens are padded) is computed once per set of
voxels and handed to the layers, which then only see rows. No sparse library is needed.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

SPAN = 1024
"""Coordinates stay below this, less one cell of margin on both sides."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Neighbours:
    """Neighbour lists: per cell of the 3x3x3 kernel, receiving rows and rows that are read.

    The kernel's cells are in the order of its axes, last one fastest; the middle one, where every row reads
    itself, is left out.
    """

    receiving: tuple[Int[Tensor, "_"], ...]
    reading: tuple[Int[Tensor, "_"], ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Coarsening:
    """Larger voxels: their places, sorted, and the row of each fine voxel's parent."""

    coords: Int[Tensor, "M 4"]
    parent: Int[Tensor, "N"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Padding:
    """Rows of several samples as one padded batch of tokens, and back.

    ``rows`` says which row fills a token (padding: any row), ``slots`` which token, counted through the
    batch, holds a row; ``mask`` is True where a token is one, None if all are.
    """

    rows: Int[Tensor, "B L"]
    slots: Int[Tensor, "N"]
    mask: Bool[Tensor, "B 1 1 L"] | None

    def pad(self, feats: Float[Tensor, "N C"]) -> Float[Tensor, "B L C"]:
        """Rows to tokens."""
        return feats.index_select(0, self.rows.flatten()).unflatten(0, self.rows.shape)

    def unpad(self, tokens: Float[Tensor, "B L C"]) -> Float[Tensor, "N C"]:
        """Tokens back to rows."""
        return tokens.flatten(0, 1).index_select(0, self.slots)


def check_voxels(coords: Int[Tensor, "N 4"], samples: int, edge: int) -> None:
    """Refuses voxels that a network over ``samples`` grids of ``edge`` cells cannot answer for.

    Raises:
        ValueError: If a sample has no voxel, a sample or coordinate is out of range, or a voxel comes twice.
    """
    if not len(coords) or coords.min() < 0 or coords[:, 1:].max() >= edge:
        raise ValueError(f"{len(coords)} voxels, expected at least one, all inside of {edge} cells")
    counts = torch.bincount(coords[:, 0])
    if len(counts) != samples or (counts == 0).any():
        raise ValueError(f"voxels per sample are {counts.tolist()}, expected some in each of {samples}")
    if len(voxel_keys(coords).unique()) != len(coords):
        raise ValueError("a voxel comes twice in one sample")


def voxel_keys(coords: Int[Tensor, "N 4"]) -> Int[Tensor, "N"]:
    """One number per place, ordered as (sample, x, y, z); a step along an axis is a fixed difference."""
    sample, x, y, z = coords.long().unbind(1)
    return ((sample * SPAN + x + 1) * SPAN + y + 1) * SPAN + z + 1


def find_neighbours(coords: Int[Tensor, "N 4"]) -> Neighbours:
    """Neighbours within the same sample, by looking up the keys of the places around each voxel."""
    keys, order = voxel_keys(coords).sort()
    line = torch.arange(-1, 2, device=coords.device)
    steps = torch.cartesian_prod(line, line, line)
    steps = steps[steps.any(dim=1)]
    wanted = keys + ((steps[:, 0] * SPAN + steps[:, 1]) * SPAN + steps[:, 2])[:, None]
    at = torch.searchsorted(keys, wanted).clamp(max=len(keys) - 1)
    cell, row = (keys[at] == wanted).nonzero(as_tuple=True)
    counts = torch.bincount(cell, minlength=len(steps)).tolist()
    return Neighbours(receiving=order[row].split(counts), reading=order[at[cell, row]].split(counts))


def coarsen(coords: Int[Tensor, "N 4"], factor: int) -> Coarsening:
    """Merges voxels into parents ``factor`` times their size, sorted by (sample, x, y, z)."""
    coarse = torch.cat([coords[:, :1], coords[:, 1:] // factor], dim=1)
    keys, parent = voxel_keys(coarse).unique(return_inverse=True)
    places = coarse.new_empty(len(keys), 4)
    places[parent] = coarse
    return Coarsening(coords=places, parent=parent)


def merge_features(feats: Float[Tensor, "N C"], coarsening: Coarsening) -> Float[Tensor, "M C"]:
    """Sum over a parent's children over one more than their number, as TRELLIS' weights expect it."""
    total = feats.new_zeros(len(coarsening.coords), feats.shape[1]).index_add(0, coarsening.parent, feats)
    counts = torch.bincount(coarsening.parent, minlength=len(coarsening.coords))
    return total / (counts + 1).to(feats.dtype)[:, None]


def split_features(feats: Float[Tensor, "M C"], coarsening: Coarsening) -> Float[Tensor, "N C"]:
    """Every child takes its parent's features."""
    return feats.index_select(0, coarsening.parent)


def rank_in_group(groups: Int[Tensor, "N"], counts: Int[Tensor, "G"]) -> Int[Tensor, "N"]:
    """Position of each row among the rows of its group, in the order of the rows."""
    order = groups.argsort(stable=True)
    starts = counts.cumsum(0) - counts
    rank = torch.empty_like(order)
    rank[order] = torch.arange(len(order), device=order.device) - starts[groups[order]]
    return rank


def plan_padding(samples: Int[Tensor, "N"]) -> Padding:
    """Lays rows out by sample; ``samples`` counts from 0 without gaps."""
    samples = samples.long()
    counts = torch.bincount(samples)
    longest = int(counts.max())
    slots = samples * longest + rank_in_group(samples, counts)
    rows = torch.arange(len(counts) * longest, device=samples.device) % len(samples)
    rows[slots] = torch.arange(len(samples), device=samples.device)
    taken = torch.arange(longest, device=samples.device) < counts[:, None]
    return Padding(
        rows=rows.reshape(-1, longest),
        slots=slots,
        mask=None if len(samples) == len(rows) else taken[:, None, None, :],
    )
