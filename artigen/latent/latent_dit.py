"""The compact structure flow: convolutions over the latent's cells around a transformer over blocks of them.

It differs from TRELLIS' network (`artigen.latent.structure_dit`) in five ways: one modulation for all
blocks with a small table per block (a third fewer weights); tokens of 2^3 cells (eight times fewer);
convolutions before and behind them, because what a cell holds follows mostly from the boxes and the cells
around it; its output is the clean latent, from which the velocity follows (a narrow network cannot carry
the noise that a velocity holds); and it can be told where the parts lie. See docs/explanation/structure.md.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn

from artigen.latent.structure_dit import ModulatedBlock, StructureDitConfig, run_blocks
from artigen.latent.volumes import (
    ChannelLayerNorm,
    ResBlock3d,
    as_tokens,
    as_volume,
    gather_pixels,
    shuffle_pixels,
)
from artigen.models.attention import plain_norm
from artigen.models.embeddings import TimestepEmbedder, embed_positions, grid_positions

EARLIEST = 0.05
"""Times below this count as this where the velocity divides by time."""
SETTLED = 0.4
"""Time before which errors of the velocity count less in training: what is left there is finer than the
spread of the posterior, which the decoder does not see."""


@dataclass(frozen=True, kw_only=True)
class LatentDitConfig:
    """Sizes of the compact structure flow."""

    edge: int = 16
    """Edge of the latent."""
    channels: int = 8
    """Channels of the latent."""
    cell_width: int = 48
    """Channels of the convolutions."""
    cell_blocks: int = 2
    """Residual blocks behind the transformer; half as many before it."""
    patch: int = 2
    """Latent cells per token along an edge."""
    width: int = 256
    """Width of a token, also of a condition token."""
    blocks: int = 4
    """Transformer blocks."""
    heads: int = 4
    """Attention heads."""
    hint: int = 0
    """Channels of a hint on the latent's grid (`artigen.latent.outline`); 0 takes none."""


class LatentDit(nn.Module):
    """The clean latent, guessed from a noisy one at a time under a condition."""

    positions: Tensor

    def __init__(self, cfg: LatentDitConfig) -> None:
        super().__init__()
        self.cfg = cfg
        token = cfg.cell_width * cfg.patch**3
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
        self.stem = nn.Conv3d(cfg.channels, cfg.cell_width, 3, padding=1)
        self.hint_layer = nn.Conv3d(cfg.hint, cfg.cell_width, 1, bias=False) if cfg.hint else None
        self.cell_shift = nn.Sequential(nn.SiLU(), nn.Linear(cfg.width, cfg.cell_width))
        self.before = nn.ModuleList(ResBlock3d(cfg.cell_width) for _ in range(cfg.cell_blocks // 2))
        self.input_layer = nn.Linear(token, cfg.width)
        self.blocks = nn.ModuleList(ModulatedBlock(inner) for _ in range(cfg.blocks))
        self.out_layer = nn.Linear(cfg.width, token)
        self.after = nn.ModuleList(ResBlock3d(cfg.cell_width) for _ in range(cfg.cell_blocks))
        self.head = nn.Sequential(
            ChannelLayerNorm(cfg.cell_width),
            nn.SiLU(),
            nn.Conv3d(cfg.cell_width, cfg.channels, 3, padding=1),
        )
        for name, parameter in self.named_parameters():
            if name.startswith(("modulation", "out_layer", "pooled", "head.2")):
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
        patch, moment = self.cfg.patch, self.t_embedder(1000.0 * times) + self.pooled(cond.mean(dim=1))
        cells = self.stem(x) + self.cell_shift(moment)[:, :, None, None, None]
        if hint is not None:
            if self.hint_layer is None:
                raise ValueError(f"a hint of {hint.shape[1]} channels, this network takes none")
            cells = cells + self.hint_layer(hint)
        for block in self.before:
            cells = block(cells)
        h = self.input_layer(as_tokens(gather_pixels(cells, patch))) + self.positions
        mod = self.modulation(moment)
        h = run_blocks(self.blocks, self.table, h, mod, cond)
        said = as_volume(self.out_layer(plain_norm(h, eps=1e-5)), self.cfg.edge // patch)
        cells = cells + shuffle_pixels(said, patch)
        for block in self.after:
            cells = block(cells)
        return self.head(cells).float()


def velocity_of(x: Tensor, clean: Tensor, times: Float[Tensor, "B"]) -> Tensor:
    """The velocity that leads from a point of the path to a guessed clean latent."""
    t = times.clamp(min=EARLIEST).reshape(-1, *[1] * (x.ndim - 1))
    return (x - clean) / t


def weigh_times(times: Float[Tensor, "B"]) -> Float[Tensor, "B"]:
    """How much squared errors of the velocity count: as errors of the clean latent do before `SETTLED`."""
    return (times / SETTLED).clamp(max=1.0) ** 2
