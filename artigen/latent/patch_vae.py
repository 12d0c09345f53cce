"""The compact structure VAE: patch embedding in and out, convolutions at 16^3, one global attention.

It differs from the paper's network (`artigen.latent.conv_vae`) for speed on two CPU cores: 4^3 patches
instead of convolutions at 64^3 and 32^3 (ten times fewer operations); a separate stem and head for occupancy;
positions relative to the patch; attention over 8^3 tokens, because the function of a part depends on more
than a convolution sees. It also decodes under an outline (`artigen.latent.outline`): label, joint and box of
every part are given, the latent determines which cells are occupied, and each cell only chooses among the
parts that reach it. See docs/explanation/structure.md.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn
from torch.nn import functional

from artigen.latent.outline import DEPTH, HINT_CHANNELS
from artigen.latent.patches import CELLS, PATCH, PatchBatch, patch_centers, relative
from artigen.latent.volumes import (
    ChannelLayerNorm,
    Downsample3d,
    ResBlock3d,
    as_tokens,
    as_volume,
    shuffle_pixels,
)
from artigen.models.attention import FeedForward, SelfAttention, plain_norm
from artigen.models.embeddings import embed_positions, grid_positions
from artigen.voxels.fields import CHANNELS, ROW

LEAST = 1e-6
"""Least probability of a class, so that its logarithm is finite."""
CHANNEL_GROUPS = (
    (ROW.label, True),
    (ROW.joint_type, True),
    (slice(ROW.axis.start, ROW.box.stop), False),
    (ROW.category, True),
)
"""Channels after occupancy, in order, and whether they are a class."""
NEVER = -12.0
"""Logit of the impossible; finite, because true cells may lie slightly outside an inexact outline."""


@dataclass(frozen=True, kw_only=True)
class PatchVaeConfig:
    """Sizes of the compact structure VAE."""

    resolution: int = 64
    """Edge of the field."""
    latent_channels: int = 8
    """Channels of the latent, whose edge is a quarter of the field's."""
    width: int = 96
    """Channels of the convolutions."""
    encoder_blocks: int = 2
    """Residual blocks of the encoder."""
    decoder_blocks: int = 4
    """Residual blocks of the decoder."""
    global_width: int = 160
    """Width of the tokens of the global attention."""
    global_blocks: int = 2
    """Transformer blocks over those tokens, in encoder and decoder each."""

    @property
    def edge(self) -> int:
        """Edge of the latent."""
        return self.resolution // PATCH


class GlobalMixer(nn.Module):
    """Adds the output of attention over the whole volume at half its resolution; initialised to zero."""

    positions: Tensor

    def __init__(self, cfg: PatchVaeConfig) -> None:
        super().__init__()
        edge = cfg.edge // 2
        self.edge = edge
        self.down = Downsample3d(cfg.width, cfg.global_width)
        self.register_buffer(
            "positions", embed_positions(grid_positions(edge), cfg.global_width), persistent=False
        )
        self.attentions = nn.ModuleList(
            SelfAttention(cfg.global_width, cfg.global_width // 32, rms_norm=True)
            for _ in range(cfg.global_blocks)
        )
        self.feeds = nn.ModuleList(FeedForward(cfg.global_width, 4.0) for _ in range(cfg.global_blocks))
        self.up = nn.Linear(cfg.global_width, 8 * cfg.width)
        nn.init.zeros_(self.up.weight)
        nn.init.zeros_(self.up.bias)

    def forward(self, x: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B C X Y Z"]:
        h = as_tokens(self.down(x)) + self.positions
        for attention, feed in zip(self.attentions, self.feeds, strict=True):
            h = h + attention(plain_norm(h))
            h = h + feed(plain_norm(h))
        return x + shuffle_pixels(as_volume(self.up(plain_norm(h)), self.edge), 2)


class PatchEncoder(nn.Module):
    """Patches to the mean and log-variance of the latent."""

    def __init__(self, cfg: PatchVaeConfig) -> None:
        super().__init__()
        self.cfg = cfg
        attributes = CHANNELS - 1
        self.occupancy_stem = nn.Linear(CELLS, cfg.width)
        self.attribute_stem = nn.Linear(CELLS * attributes, cfg.width)
        self.stem = nn.Linear(cfg.width, cfg.width)
        self.empty = nn.Parameter(torch.zeros(cfg.width))
        self.blocks = nn.ModuleList(ResBlock3d(cfg.width) for _ in range(cfg.encoder_blocks))
        self.mixer = GlobalMixer(cfg)
        self.out_layer = nn.Sequential(
            ChannelLayerNorm(cfg.width),
            nn.SiLU(),
            nn.Conv3d(cfg.width, 2 * cfg.latent_channels, 3, padding=1),
        )

    def forward(self, patches: PatchBatch) -> tuple[Float[Tensor, "B C X Y Z"], Float[Tensor, "B C X Y Z"]]:
        """Mean and log-variance of the latent."""
        occupied = patches.occupied()
        centers = patch_centers(patches.index, patches.edge)
        attributes = relative(patches.attributes(), centers, -1.0) * occupied[..., None]
        h = self.occupancy_stem(2.0 * occupied.float() - 1.0) + self.attribute_stem(attributes.flatten(1))
        h = self.stem(functional.silu(h))
        dense = self.empty.to(h.dtype).repeat(patches.samples * patches.edge**3, 1)
        dense = dense.index_copy(0, patches.index, h)
        x = as_volume(dense.reshape(patches.samples, -1, h.shape[1]), patches.edge)
        for block in self.blocks:
            x = block(x)
        mean, logvar = self.out_layer(self.mixer(x)).float().chunk(2, dim=1)
        return mean, logvar


class PatchDecoder(nn.Module):
    """Latent and hint to features of patches, and those to occupancy and parts of their cells."""

    def __init__(self, cfg: PatchVaeConfig) -> None:
        super().__init__()
        self.cfg = cfg
        half = cfg.decoder_blocks // 2
        self.input_layer = nn.Conv3d(cfg.latent_channels, cfg.width, 3, padding=1)
        self.hint_layer = nn.Conv3d(HINT_CHANNELS, cfg.width, 1, bias=False)
        self.before = nn.ModuleList(ResBlock3d(cfg.width) for _ in range(half))
        self.mixer = GlobalMixer(cfg)
        self.after = nn.ModuleList(ResBlock3d(cfg.width) for _ in range(cfg.decoder_blocks - half))
        self.norm = nn.LayerNorm(cfg.width)
        self.occupancy_head = nn.Sequential(
            nn.Linear(cfg.width, 4 * cfg.width), nn.SiLU(), nn.Linear(4 * cfg.width, CELLS)
        )
        self.choice_head = nn.Sequential(
            nn.Linear(cfg.width, 4 * cfg.width), nn.SiLU(), nn.Linear(4 * cfg.width, CELLS * DEPTH)
        )

    def forward(
        self, z: Float[Tensor, "B C X Y Z"], hint: Float[Tensor, "B H X Y Z"]
    ) -> Float[Tensor, "N D"]:
        """Features of every patch of the batch, ``N = B * edge^3``."""
        x = self.input_layer(z) + self.hint_layer(hint)
        for block in self.before:
            x = block(x)
        x = self.mixer(x)
        for block in self.after:
            x = block(x)
        return self.norm(as_tokens(x).flatten(0, 1))

    def occupancy(
        self, features: Float[Tensor, "N D"], inside: Bool[Tensor, "N K Q"]
    ) -> Float[Tensor, "N K"]:
        """Logits of the cells of patches; a cell in no part's box holds nothing."""
        logits = self.occupancy_head(features).float()
        return logits.masked_fill(~inside.any(dim=-1), NEVER)

    def attributes(
        self, features: Float[Tensor, "P D"], rows: Float[Tensor, "P Q C"], inside: Bool[Tensor, "P K Q"]
    ) -> Float[Tensor, "P K C"]:
        """Channels after occupancy (class channels as logits) of the cells of patches.

        In training they are the mean over the parts in whose box a cell lies, weighted by probability; in
        evaluation they are those of the likeliest part.

        Args:
            rows: Candidate parts of each patch.
            inside: Whether each cell lies in the box of each candidate.
        """
        choice = self.choice_head(features).float().unflatten(-1, (CELLS, DEPTH))
        chances = choice.masked_fill(~inside, NEVER).softmax(dim=-1)
        if not self.training:
            chances = functional.one_hot(chances.argmax(dim=-1), DEPTH).to(chances.dtype)
        mixed = chances @ rows
        return torch.cat(
            [
                mixed[..., part].clamp(min=LEAST).log() if is_class else mixed[..., part]
                for part, is_class in CHANNEL_GROUPS
            ],
            dim=-1,
        )
