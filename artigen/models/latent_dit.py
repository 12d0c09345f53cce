"""The compact structure flow: a transformer over 2^3-cell tokens of the latent that predicts the data.

It differs from TRELLIS' network (`artigen.models.structure_dit`) in four ways: one modulation for all
blocks with a small table per block (a third fewer weights), tokens of 2^3 cells (eight times fewer), its
output is the clean latent, from which the velocity follows (a narrow network cannot carry the noise that a
velocity holds), and it can be told where the parts lie. See docs/training.md.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn

from artigen.models.attention import plain_norm
from artigen.models.embeddings import TimestepEmbedder, embed_positions, grid_positions
from artigen.models.structure_dit import ModulatedBlock, StructureDitConfig
from artigen.models.volumes import as_tokens, as_volume, gather_pixels, shuffle_pixels

EARLIEST = 0.05
"""Times below this count as this where the velocity divides by time."""


@dataclass(frozen=True, kw_only=True)
class LatentDitConfig:
    """Sizes of the compact structure flow."""

    edge: int = 16
    """Edge of the latent."""
    channels: int = 8
    """Channels of the latent."""
    patch: int = 2
    """Latent cells per token along an edge."""
    width: int = 256
    """Width of a token, also of a condition token."""
    blocks: int = 5
    """Transformer blocks."""
    heads: int = 4
    """Attention heads."""
    hint: int = 0
    """Channels of a hint on the latent's grid (`artigen.models.outlines`); 0 takes none."""


class LatentDit(nn.Module):
    """The clean latent, guessed from a noisy one at a time under a condition."""

    positions: Tensor

    def __init__(self, cfg: LatentDitConfig) -> None:
        super().__init__()
        self.cfg = cfg
        token = cfg.channels * cfg.patch**3
        inner = StructureDitConfig(
            model_channels=cfg.width, cond_channels=cfg.width, num_heads=cfg.heads, share_mod=True
        )
        self.t_embedder = TimestepEmbedder(cfg.width)
        self.modulation = nn.Sequential(nn.SiLU(), nn.Linear(cfg.width, 6 * cfg.width))
        self.table = nn.Parameter(torch.zeros(cfg.blocks, 6 * cfg.width))
        self.pooled = nn.Linear(cfg.width, cfg.width)
        self.register_buffer(
            "positions", embed_positions(grid_positions(cfg.edge // cfg.patch), cfg.width), persistent=False
        )
        self.input_layer = nn.Linear(token, cfg.width)
        self.hint_layer = nn.Linear(cfg.hint * cfg.patch**3, cfg.width, bias=False) if cfg.hint else None
        self.blocks = nn.ModuleList(ModulatedBlock(inner) for _ in range(cfg.blocks))
        self.out_layer = nn.Linear(cfg.width, token)
        for name, parameter in self.named_parameters():
            if name.startswith(("modulation", "out_layer", "pooled")):
                nn.init.zeros_(parameter)

    def forward(
        self,
        x: Float[Tensor, "B C X Y Z"],
        times: Float[Tensor, "B"],
        cond: Float[Tensor, "B M K"],
        hint: Float[Tensor, "B H X Y Z"] | None = None,
    ) -> Float[Tensor, "B C X Y Z"]:
        """The clean latent, for times in [0, 1], the tokens of a condition, and what is known of its cells.

        Raises:
            ValueError: If there is a hint and the network takes none.
        """
        patch = self.cfg.patch
        h = self.input_layer(as_tokens(gather_pixels(x, patch))) + self.positions
        if hint is not None:
            if self.hint_layer is None:
                raise ValueError(f"a hint of {hint.shape[1]} channels, this network takes none")
            h = h + self.hint_layer(as_tokens(gather_pixels(hint, patch)))
        mod = self.modulation(self.t_embedder(1000.0 * times) + self.pooled(cond.mean(dim=1)))
        for block, row in zip(self.blocks, self.table, strict=True):
            assert isinstance(block, ModulatedBlock)
            h = block(h, mod + row, block.cross_attn.project(cond))
        out = self.out_layer(plain_norm(h, eps=1e-5)).float()
        return shuffle_pixels(as_volume(out, self.cfg.edge // patch), patch)


def velocity_of(x: Tensor, clean: Tensor, times: Float[Tensor, "B"]) -> Tensor:
    """The velocity that leads from a point of the path to a guessed clean latent."""
    t = times.clamp(min=EARLIEST).reshape(-1, *[1] * (x.ndim - 1))
    return (x - clean) / t
