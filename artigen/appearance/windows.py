"""Windowed attention of active voxels, shifted or not.

Windows hold very different numbers of voxels. They are sorted by that number and padded to the next of a few
sizes, so that all windows of a size go through one call of `scaled_dot_product_attention`.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor
from torch.nn import functional

from artigen.appearance.sparse import rank_in_group, voxel_keys

SIZES = (8, 16, 24, 32, 48, 64, 80, 96, 112, 128, 160, 192, 224, 256, 320, 384, 448, 512)
"""What a window is padded to; larger ones to the next multiple of the last."""


@dataclass(frozen=True, kw_only=True, eq=False)
class WindowBucket:
    """Windows padded to one size: how many, that size, and which tokens are voxels (None: all)."""

    windows: int
    size: int
    mask: Bool[Tensor, "W 1 1 S"] | None


@dataclass(frozen=True, kw_only=True, eq=False)
class WindowPlan:
    """Where each voxel goes.

    The padded tokens of all buckets lie one after another; ``rows`` says which voxel fills a token
    (padding: any voxel), ``slots`` which token holds a voxel.
    """

    buckets: tuple[WindowBucket, ...]
    rows: Int[Tensor, "P"]
    slots: Int[Tensor, "N"]


def group_windows(coords: Int[Tensor, "N 4"], window: int, shift: int) -> Int[Tensor, "N"]:
    """Number of each voxel's window, from 0 without gaps.

    Voxels share a window if they share the sample and ``(x, y, z) + shift`` divided by ``window``.
    """
    places = torch.cat([coords[:, :1], (coords[:, 1:] + shift) // window], dim=1)
    return voxel_keys(places).unique(return_inverse=True)[1]


def plan_windows(coords: Int[Tensor, "N 4"], window: int, shift: int) -> WindowPlan:
    """Lays voxels (sample, x, y, z) out by window; costs some milliseconds and serves all blocks."""
    groups = group_windows(coords, window, shift)
    counts = torch.bincount(groups)
    sizes = _padded_sizes(counts)
    order = sizes.argsort(stable=True)
    starts = torch.empty_like(sizes)
    starts[order] = sizes[order].cumsum(0) - sizes[order]
    slots = starts[groups] + rank_in_group(groups, counts)
    rows = torch.arange(int(sizes.sum()), device=coords.device) % len(coords)
    rows[slots] = torch.arange(len(coords), device=coords.device)
    buckets = []
    for size in sizes.unique().tolist():
        held = counts[order][sizes[order] == size]
        taken = torch.arange(size, device=coords.device) < held[:, None]
        full = bool((held == size).all())
        buckets.append(
            WindowBucket(windows=len(held), size=size, mask=None if full else taken[:, None, None, :])
        )
    return WindowPlan(buckets=tuple(buckets), rows=rows, slots=slots)


def attend_windows(qkv: Float[Tensor, "N 3 H D"], plan: WindowPlan) -> Float[Tensor, "N C"]:
    """Softmax attention of each voxel to the voxels of its window, heads side by side in the result."""
    tokens = qkv.index_select(0, plan.rows)
    parts = tokens.split([bucket.windows * bucket.size for bucket in plan.buckets])
    done = []
    for bucket, part in zip(plan.buckets, parts, strict=True):
        q, k, v = part.unflatten(0, (bucket.windows, bucket.size)).permute(2, 0, 3, 1, 4).unbind(0)
        out = functional.scaled_dot_product_attention(q, k, v, attn_mask=bucket.mask)
        done.append(out.transpose(1, 2).flatten(2).flatten(0, 1))
    return torch.cat(done).index_select(0, plan.slots)


def _padded_sizes(counts: Int[Tensor, "W"]) -> Int[Tensor, "W"]:
    steps = torch.tensor(SIZES, device=counts.device)
    listed = steps[torch.searchsorted(steps, counts).clamp(max=len(SIZES) - 1)]
    return torch.where(counts > SIZES[-1], -(-counts // SIZES[-1]) * SIZES[-1], listed)
