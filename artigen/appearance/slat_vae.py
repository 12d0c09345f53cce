"""The sparse transformer VAE of structured latents: TRELLIS' trunk and its encoder, name by name.

Voxels carry features. Attention stays within windows of 8^3 cells that are shifted by half a window in every
other block. Section 4.2 of the paper adopts this network.
"""

from dataclasses import dataclass

from jaxtyping import Float, Int
from torch import Tensor, nn

from artigen.appearance.sparse import check_voxels
from artigen.appearance.windows import WindowPlan, attend_windows, plan_windows
from artigen.models.attention import FeedForward, plain_norm
from artigen.models.embeddings import embed_positions
from artigen.voxels.frames import FACINGS


@dataclass(frozen=True, kw_only=True)
class SlatVaeConfig:
    """Sizes of an encoder or decoder; the defaults are those of `slat_enc_swin8_B_64l8_fp16`."""

    resolution: int = 64
    """Edge of the voxel grid."""
    in_channels: int = 1024
    """Channels of a voxel's features; the decoder does not use it."""
    latent_channels: int = 8
    """Channels of a voxel's latent."""
    model_channels: int = 768
    """Width of a token."""
    num_blocks: int = 12
    """Transformer blocks."""
    num_heads: int = 12
    """Attention heads."""
    mlp_ratio: float = 4.0
    """Hidden width of a feed-forward layer over the model's."""
    window_size: int = 8
    """Edge of an attention window in voxels."""
    sided: bool = False
    """Whether voxels have two sides: the network takes the direction of the outer one
    (`artigen.voxels.frames`), decodes in its frame, and has a linear layer around the transformer. TRELLIS
    has none of this."""


WindowPlans = tuple[WindowPlan, WindowPlan]
"""Windows of the even and of the odd blocks."""


class WindowAttention(nn.Module):
    """Every voxel attends to the voxels of its window."""

    def __init__(self, channels: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.to_qkv = nn.Linear(channels, 3 * channels)
        self.to_out = nn.Linear(channels, channels)

    def forward(self, x: Float[Tensor, "N C"], plan: WindowPlan) -> Float[Tensor, "N C"]:
        return self.to_out(attend_windows(self.to_qkv(x).unflatten(-1, (3, self.heads, -1)), plan))


class WindowBlock(nn.Module):
    """Attention and feed-forward, each behind a plain norm."""

    def __init__(self, cfg: SlatVaeConfig) -> None:
        super().__init__()
        self.attn = WindowAttention(cfg.model_channels, cfg.num_heads)
        self.mlp = FeedForward(cfg.model_channels, cfg.mlp_ratio)

    def forward(self, x: Float[Tensor, "N C"], plan: WindowPlan) -> Float[Tensor, "N C"]:
        x = x + self.attn(plain_norm(x), plan)
        return x + self.mlp(plain_norm(x))


class SlatTrunk(nn.Module):
    """Features of voxels to other features of the same voxels."""

    def __init__(self, cfg: SlatVaeConfig, in_channels: int, out_channels: int) -> None:
        super().__init__()
        self.cfg = cfg
        self.input_layer = nn.Linear(in_channels, cfg.model_channels)
        self.blocks = nn.ModuleList(WindowBlock(cfg) for _ in range(cfg.num_blocks))
        self.out_layer = nn.Linear(cfg.model_channels, out_channels)
        self.skip = nn.Linear(in_channels, out_channels, bias=False) if cfg.sided else None
        self.facing = nn.Embedding(FACINGS, cfg.model_channels) if cfg.sided else None
        for name, parameter in self.named_parameters():
            if name.startswith(("out_layer", "skip", "facing")) or name.endswith("bias"):
                nn.init.zeros_(parameter)
            else:
                nn.init.xavier_uniform_(parameter)

    def plan(self, coords: Int[Tensor, "N 4"]) -> WindowPlans:
        """Windows of voxels (sample, x, y, z): compute once per set of voxels.

        Raises:
            ValueError: If a sample is empty, a voxel occurs twice, or one lies outside the grid.
        """
        check_voxels(coords, int(coords[:, 0].max()) + 1 if len(coords) else 0, self.cfg.resolution)
        window = self.cfg.window_size
        return plan_windows(coords, window, 0), plan_windows(coords, window, window // 2)

    def transform(
        self,
        coords: Int[Tensor, "N 4"],
        feats: Float[Tensor, "N C"],
        plans: WindowPlans | None = None,
        facings: Int[Tensor, "N"] | None = None,
    ) -> Float[Tensor, "N D"]:
        """Output of the last layer, in the number type of ``feats``.

        Raises:
            ValueError: If facings are missing, or given for voxels without sides.
        """
        if (facings is not None) != self.cfg.sided:
            raise ValueError(
                f"facings of voxels are {'missing' if facings is None else 'given'}, expected "
                f"{'one for each' if self.cfg.sided else 'none'}"
            )
        plans = self.plan(coords) if plans is None else plans
        h = self.input_layer(feats.to(self.input_layer.weight.dtype))
        h = h + embed_positions(coords[:, 1:].float(), self.cfg.model_channels).to(h.dtype)
        if self.facing is not None:
            h = h + self.facing(facings)
        for number, block in enumerate(self.blocks):
            h = block(h, plans[number % 2])
        out = self.out_layer(plain_norm(h, eps=1e-5)).to(feats.dtype)
        return out if self.skip is None else out + self.skip(feats)


class SlatEncoder(SlatTrunk):
    """Features of voxels to the mean and log-variance of their latents."""

    def __init__(self, cfg: SlatVaeConfig) -> None:
        super().__init__(cfg, cfg.in_channels, 2 * cfg.latent_channels)

    def forward(
        self,
        coords: Int[Tensor, "N 4"],
        feats: Float[Tensor, "N C"],
        plans: WindowPlans | None = None,
        facings: Int[Tensor, "N"] | None = None,
    ) -> tuple[Float[Tensor, "N D"], Float[Tensor, "N D"]]:
        """Mean and log-variance, row by row.

        Args:
            coords: Sample, x, y, z of each voxel, in any order.
            plans: Window plans of these voxels; computed when None.
            facings: Directions of the outer sides, where voxels have two sides.
        """
        mean, logvar = self.transform(coords, feats, plans, facings).chunk(2, dim=1)
        return mean, logvar
