"""The structure flow transformer of TRELLIS: `SparseStructureFlowModel`, name by name.

The paper initialises its structure flow from this network's public weights (section 4.3).
"""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn

from artigen.latent.volumes import as_tokens, as_volume, gather_pixels, shuffle_pixels
from artigen.models.attention import (
    NORM_EPS,
    CrossAttention,
    FeedForward,
    SelfAttention,
    learned_norm,
    modulate,
    plain_norm,
)
from artigen.models.embeddings import TimestepEmbedder, embed_positions, grid_positions


@dataclass(frozen=True, kw_only=True)
class DitConfig:
    """Sizes that TRELLIS' two flow transformers share; the defaults are those of their large models."""

    in_channels: int = 8
    """Channels of the latent; the velocity has as many."""
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
    qk_rms_norm: bool = True
    """Whether queries and keys of the self-attention are normalised."""
    qk_rms_norm_cross: bool = False
    """The same for the cross-attention."""
    share_mod: bool = False
    """Whether all blocks share one modulation."""


@dataclass(frozen=True, kw_only=True)
class StructureDitConfig(DitConfig):
    """Sizes; the defaults are those of `ss_flow_img_dit_L_16l8_fp16`."""

    resolution: int = 16
    """Edge of the latent."""
    patch_size: int = 1
    """Latent cells per token along an edge."""


class ModulatedBlock(nn.Module):
    """Self-attention and feed-forward modulated by time, cross-attention to the condition between them."""

    def __init__(self, cfg: DitConfig) -> None:
        super().__init__()
        width = cfg.model_channels
        self.norm2 = nn.LayerNorm(width, eps=NORM_EPS)
        self.self_attn = SelfAttention(width, cfg.num_heads, rms_norm=cfg.qk_rms_norm)
        self.cross_attn = CrossAttention(
            width, cfg.cond_channels, cfg.num_heads, rms_norm=cfg.qk_rms_norm_cross
        )
        self.mlp = FeedForward(width, cfg.mlp_ratio)
        self.adaLN_modulation = (
            None if cfg.share_mod else nn.Sequential(nn.SiLU(), nn.Linear(width, 6 * width))
        )

    def forward(
        self,
        x: Float[Tensor, "B L C"],
        mod: Float[Tensor, "B D"],
        cond: Float[Tensor, "B M E"],
        mask: Bool[Tensor, "B 1 1 L"] | None = None,
    ) -> Float[Tensor, "B L C"]:
        mod = mod if self.adaLN_modulation is None else self.adaLN_modulation(mod)
        shift_attn, scale_attn, gate_attn, shift_mlp, scale_mlp, gate_mlp = mod.chunk(6, dim=1)
        h = self.self_attn(modulate(plain_norm(x), shift_attn, scale_attn), mask)
        x = x + h * gate_attn.unsqueeze(1)
        x = x + self.cross_attn(learned_norm(x, self.norm2), cond)
        h = self.mlp(modulate(plain_norm(x), shift_mlp, scale_mlp))
        return x + h * gate_mlp.unsqueeze(1)


def run_blocks(
    blocks: nn.ModuleList,
    table: Float[Tensor, "K D"],
    x: Float[Tensor, "B L C"],
    mod: Float[Tensor, "B D"],
    cond: Float[Tensor, "B M E"],
    mask: Bool[Tensor, "B 1 1 L"] | None = None,
) -> Float[Tensor, "B L C"]:
    """Passes tokens through blocks that share one modulation, to which each adds its row of a table."""
    for block, row in zip(blocks, table, strict=True):
        x = block(x, mod + row, cond, mask)
    return x


class FlowTransformer(nn.Module):
    """A network around modulated blocks, with TRELLIS' initialisation."""

    def __init__(self, cfg: DitConfig) -> None:
        super().__init__()
        self.t_embedder = TimestepEmbedder(cfg.model_channels)
        self.blocks = nn.ModuleList(ModulatedBlock(cfg) for _ in range(cfg.num_blocks))

    def initialise(self) -> None:
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


class StructureDit(FlowTransformer):
    """Velocity of a latent at a time, given a condition."""

    pos_emb: Tensor

    def __init__(self, cfg: StructureDitConfig) -> None:
        super().__init__(cfg)
        self.cfg = cfg
        width, edge = cfg.model_channels, cfg.resolution // cfg.patch_size
        if cfg.share_mod:
            self.adaLN_modulation = nn.Sequential(nn.SiLU(), nn.Linear(width, 6 * width))
        self.register_buffer("pos_emb", embed_positions(grid_positions(edge), width))
        self.input_layer = nn.Linear(cfg.in_channels * cfg.patch_size**3, width)
        self.out_layer = nn.Linear(width, cfg.in_channels * cfg.patch_size**3)
        self.initialise()

    def forward(
        self, x: Float[Tensor, "B C X Y Z"], times: Float[Tensor, "B"], cond: Float[Tensor, "B M K"]
    ) -> Float[Tensor, "B C X Y Z"]:
        """Velocity at ``times`` (0 to 1000), for a condition."""
        patch = self.cfg.patch_size
        h = self.input_layer(as_tokens(gather_pixels(x, patch))) + self.pos_emb
        mod = self.t_embedder(times)
        if self.cfg.share_mod:
            mod = self.adaLN_modulation(mod)
        h, mod, cond = (value.to(self.dtype) for value in (h, mod, cond))
        for block in self.blocks:
            h = block(h, mod, cond)
        h = self.out_layer(plain_norm(h.to(x.dtype), eps=1e-5))
        return shuffle_pixels(as_volume(h, self.cfg.resolution // patch), patch)
