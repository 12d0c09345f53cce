"""The sparse flow transformer of TRELLIS: `SLatFlowModel`, name by name.

Convolutions on the voxels, transformer blocks on parents of 2^3 voxels, convolutions again, with skips (the
paper fine-tunes this network's public weights, section 4.2).
"""

from dataclasses import dataclass
from itertools import pairwise

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from artigen.appearance.sparse import (
    Coarsening,
    Neighbours,
    Padding,
    check_voxels,
    coarsen,
    find_neighbours,
    merge_features,
    plan_padding,
    split_features,
)
from artigen.appearance.sparse_conv import SparseResBlock3d
from artigen.latent.structure_dit import DitConfig, FlowTransformer
from artigen.models.attention import plain_norm
from artigen.models.embeddings import embed_positions


@dataclass(frozen=True, kw_only=True)
class SlatDitConfig(DitConfig):
    """Sizes; the defaults are those of `slat_flow_img_dit_L_64l8p2_fp16`."""

    resolution: int = 64
    """Edge of the voxel grid."""
    io_block_channels: tuple[int, ...] = (128,)
    """Channels of the convolutions, finest first; every entry halves the resolution."""
    num_io_res_blocks: int = 2
    """Convolution blocks per entry, on either side."""
    use_skip_connection: bool = True
    """Whether the convolutions after the transformer see those before it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SlatDitPlan:
    """Precomputed neighbourhoods of a set of voxels, finest level first."""

    coords: tuple[Int[Tensor, "_ 4"], ...]
    neighbours: tuple[Neighbours, ...]
    coarsenings: tuple[Coarsening, ...]
    padding: Padding


@dataclass(frozen=True)
class BlockStep:
    """Levels between which a convolution block leads: it halves, doubles or keeps the resolution."""

    source: int
    target: int


class SlatDit(FlowTransformer):
    """Velocity of the latents of voxels at a time, given a condition."""

    def __init__(self, cfg: SlatDitConfig) -> None:
        super().__init__(cfg)
        self.cfg = cfg
        width = cfg.model_channels
        levels = (*cfg.io_block_channels, width)
        skip = 2 if cfg.use_skip_connection else 1
        self.input_layer = nn.Linear(cfg.in_channels, levels[0])
        self.input_blocks, self.out_blocks = nn.ModuleList(), nn.ModuleList()
        self.input_steps: list[BlockStep] = []
        for level, (channels, following) in enumerate(pairwise(levels)):
            for _ in range(cfg.num_io_res_blocks - 1):
                self.input_blocks.append(SparseResBlock3d(channels, channels, width))
                self.input_steps.append(BlockStep(level, level))
            self.input_blocks.append(SparseResBlock3d(channels, following, width))
            self.input_steps.append(BlockStep(level, level + 1))
        for channels, coarser in reversed(list(pairwise(levels))):
            self.out_blocks.append(SparseResBlock3d(coarser * skip, channels, width))
            self.out_blocks.extend(
                SparseResBlock3d(channels * skip, channels, width) for _ in range(cfg.num_io_res_blocks - 1)
            )
        self.out_steps = [BlockStep(step.target, step.source) for step in reversed(self.input_steps)]
        self.out_layer = nn.Linear(levels[0], cfg.in_channels)
        self.initialise()

    def plan(self, coords: Int[Tensor, "N 4"], samples: int) -> SlatDitPlan:
        """Neighbours and parents of voxels (sample, x, y, z): compute once per set, use at every step.

        Raises:
            ValueError: If a sample is empty, a voxel occurs twice, or one lies outside the grid.
        """
        check_voxels(coords, samples, self.cfg.resolution)
        coarsenings = []
        places = [coords]
        for _ in self.cfg.io_block_channels:
            coarsenings.append(coarsen(places[-1], 2))
            places.append(coarsenings[-1].coords)
        return SlatDitPlan(
            coords=tuple(places),
            neighbours=tuple(find_neighbours(level) for level in places),
            coarsenings=tuple(coarsenings),
            padding=plan_padding(places[-1][:, 0]),
        )

    def forward(
        self,
        feats: Float[Tensor, "N C"],
        times: Float[Tensor, "B"],
        plan: SlatDitPlan,
        cond: Float[Tensor, "B M K"],
    ) -> Float[Tensor, "N C"]:
        """Velocity at ``times`` (0 to 1000), for a condition, row by row."""
        emb, cond = self.t_embedder(times).to(self.dtype), cond.to(self.dtype)
        h = self.input_layer(feats.to(self.input_layer.weight.dtype)).to(self.dtype)
        skips = []
        for block, step in zip(self.input_blocks, self.input_steps, strict=True):
            h = self._convolve(block, step, h, emb, plan)
            skips.append(h)
        h = h + embed_positions(plan.coords[-1][:, 1:].float(), self.cfg.model_channels).to(h.dtype)
        tokens = plan.padding.pad(h)
        for block in self.blocks:
            tokens = block(tokens, emb, cond, plan.padding.mask)
        h = plan.padding.unpad(tokens)
        for block, step, skip in zip(self.out_blocks, self.out_steps, reversed(skips), strict=True):
            joined = torch.cat([h, skip], dim=1) if self.cfg.use_skip_connection else h
            h = self._convolve(block, step, joined, emb, plan)
        h = plain_norm(h, eps=1e-5).to(self.out_layer.weight.dtype)
        return self.out_layer(h).to(feats.dtype)

    def _convolve(
        self, block: nn.Module, step: BlockStep, h: Tensor, emb: Tensor, plan: SlatDitPlan
    ) -> Float[Tensor, "_ D"]:
        if step.target > step.source:
            h = merge_features(h, plan.coarsenings[step.source])
        elif step.target < step.source:
            h = split_features(h, plan.coarsenings[step.target])
        return block(h, emb, plan.coords[step.target][:, 0], plan.neighbours[step.target])
