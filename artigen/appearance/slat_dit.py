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
from artigen.latent.structure_dit import ModulatedBlock, StructureDitConfig
from artigen.models.attention import plain_norm
from artigen.models.embeddings import TimestepEmbedder, embed_positions


@dataclass(frozen=True, kw_only=True)
class SlatDitConfig:
    """Sizes; the defaults are those of `slat_flow_img_dit_L_64l8p2_fp16`."""

    resolution: int = 64
    """Edge of the voxel grid."""
    in_channels: int = 8
    """Channels of a voxel's latent; the velocity has as many."""
    model_channels: int = 1024
    """Width of a token."""
    cond_channels: int = 1024
    """Width of a condition token."""
    num_blocks: int = 24
    """Transformer blocks."""
    num_heads: int = 16
    """Attention heads."""
    mlp_ratio: float = 4.0
    """Hidden width of a feed-forward layer over the model's."""
    io_block_channels: tuple[int, ...] = (128,)
    """Channels of the convolutions, finest first; every entry halves the resolution."""
    num_io_res_blocks: int = 2
    """Convolution blocks per entry, on either side."""
    use_skip_connection: bool = True
    """Whether the convolutions after the transformer see those before it."""
    qk_rms_norm: bool = True
    """Whether queries and keys of the self-attention are normalised."""
    qk_rms_norm_cross: bool = False
    """The same for the cross-attention."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SlatDitPlan:
    """Precomputed neighbourhoods of a set of voxels, finest level first."""

    coords: tuple[Int[Tensor, "_ 4"], ...]
    neighbours: tuple[Neighbours, ...]
    coarsenings: tuple[Coarsening, ...]
    padding: Padding


@dataclass(frozen=True)
class BlockStep:
    """A convolution block's way between levels: it halves, doubles or keeps the resolution."""

    source: int
    target: int


class SlatDit(nn.Module):
    """Velocity of the latents of voxels at a time, given a condition."""

    def __init__(self, cfg: SlatDitConfig) -> None:
        super().__init__()
        self.cfg = cfg
        width = cfg.model_channels
        inner = StructureDitConfig(
            model_channels=width,
            cond_channels=cfg.cond_channels,
            num_heads=cfg.num_heads,
            mlp_ratio=cfg.mlp_ratio,
            qk_rms_norm=cfg.qk_rms_norm,
            qk_rms_norm_cross=cfg.qk_rms_norm_cross,
        )
        levels = (*cfg.io_block_channels, width)
        skip = 2 if cfg.use_skip_connection else 1
        self.t_embedder = TimestepEmbedder(width)
        self.input_layer = nn.Linear(cfg.in_channels, levels[0])
        self.input_blocks, self.out_blocks = nn.ModuleList(), nn.ModuleList()
        self.input_steps: list[BlockStep] = []
        for level, (channels, following) in enumerate(pairwise(levels)):
            for _ in range(cfg.num_io_res_blocks - 1):
                self.input_blocks.append(SparseResBlock3d(channels, channels, width))
                self.input_steps.append(BlockStep(level, level))
            self.input_blocks.append(SparseResBlock3d(channels, following, width))
            self.input_steps.append(BlockStep(level, level + 1))
        self.blocks = nn.ModuleList(ModulatedBlock(inner) for _ in range(cfg.num_blocks))
        for channels, coarser in reversed(list(pairwise(levels))):
            self.out_blocks.append(SparseResBlock3d(coarser * skip, channels, width))
            self.out_blocks.extend(
                SparseResBlock3d(channels * skip, channels, width) for _ in range(cfg.num_io_res_blocks - 1)
            )
        self.out_steps = [BlockStep(step.target, step.source) for step in reversed(self.input_steps)]
        self.out_layer = nn.Linear(levels[0], cfg.in_channels)
        self._initialise()

    def _initialise(self) -> None:
        """Xavier for linear layers; modulation and output start at zero, so that blocks start as identity."""
        for name, parameter in self.named_parameters():
            if "adaLN_modulation" in name or name.startswith("out_layer") or name.endswith("bias"):
                nn.init.zeros_(parameter)
            elif name.startswith("t_embedder"):
                nn.init.normal_(parameter, std=0.02)
            elif not name.endswith(("norm1.weight", "norm2.weight", "gamma", "conv.weight")):
                nn.init.xavier_uniform_(parameter)

    @property
    def dtype(self) -> torch.dtype:
        """Number type of the blocks."""
        return next(self.blocks.parameters()).dtype

    def plan(self, coords: Int[Tensor, "N 4"], samples: int) -> SlatDitPlan:
        """Neighbours and parents of voxels (sample, x, y, z): compute once per set, use at every step.

        Raises:
            ValueError: If a sample is empty, a voxel comes twice, or one lies outside of the grid.
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

    def project_condition(self, cond: Float[Tensor, "B M K"]) -> tuple[tuple[Tensor, Tensor], ...]:
        """Keys and values of every block's cross-attention: compute once per condition, use at every step."""
        return tuple(block.cross_attn.project(cond.to(self.dtype)) for block in self._modulated())

    def forward(
        self,
        feats: Float[Tensor, "N C"],
        times: Float[Tensor, "B"],
        plan: SlatDitPlan,
        cond: Float[Tensor, "B M K"] | None = None,
        keys: tuple[tuple[Tensor, Tensor], ...] | None = None,
    ) -> Float[Tensor, "N C"]:
        """Velocity at ``times`` (0 to 1000), for a condition or for its `project_condition`, row by row."""
        if keys is None:
            if cond is None:
                raise ValueError("a velocity needs a condition, or the keys projected from it")
            keys = self.project_condition(cond)
        emb = self.t_embedder(times).to(self.dtype)
        h = self.input_layer(feats.to(self.input_layer.weight.dtype)).to(self.dtype)
        skips = []
        for block, step in zip(self.input_blocks, self.input_steps, strict=True):
            h = self._convolve(block, step, h, emb, plan)
            skips.append(h)
        h = h + embed_positions(plan.coords[-1][:, 1:].float(), self.cfg.model_channels).to(h.dtype)
        tokens = plan.padding.pad(h)
        for block, pair in zip(self._modulated(), keys, strict=True):
            tokens = block(tokens, emb, pair, plan.padding.mask)
        h = plan.padding.unpad(tokens)
        for block, step, skip in zip(self.out_blocks, self.out_steps, reversed(skips), strict=True):
            joined = torch.cat([h, skip], dim=1) if self.cfg.use_skip_connection else h
            h = self._convolve(block, step, joined, emb, plan)
        h = plain_norm(h, eps=1e-5).to(self.out_layer.weight.dtype)
        return self.out_layer(h).to(feats.dtype)

    def _modulated(self) -> list[ModulatedBlock]:
        return [block for block in self.blocks if isinstance(block, ModulatedBlock)]

    def _convolve(
        self, block: nn.Module, step: BlockStep, h: Tensor, emb: Tensor, plan: SlatDitPlan
    ) -> Float[Tensor, "_ D"]:
        if step.target > step.source:
            h = merge_features(h, plan.coarsenings[step.source])
        elif step.target < step.source:
            h = split_features(h, plan.coarsenings[step.target])
        return block(h, emb, plan.coords[step.target][:, 0], plan.neighbours[step.target])
