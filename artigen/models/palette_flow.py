"""The palette flow: a transformer over the parts of an object that draws the colours of each.

What colours an object has is decided near pure noise, where thousands of voxels repeat what a few numbers
say. So these are drawn first, for all parts at once and under the same conditions, as outlines are drawn
before structure; the flow of structured latents is told them. The paper draws all at once (section 4.2).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn
from torch.nn import functional

from artigen.fields import DEFAULT_LAYOUT, after_occupancy
from artigen.models.attention import plain_norm
from artigen.models.conditions import ConditionBatch, ConditionConfig, ConditionEncoder
from artigen.models.embeddings import TimestepEmbedder
from artigen.models.latent_dit import velocity_of
from artigen.models.structure_dit import ModulatedBlock, StructureDitConfig, run_blocks
from artigen.palettes import PALETTE, find_twins
from artigen.sampling import SamplerConfig, diffuse, sample_flow

SEEN = 8
"""Numbers that say what a picture shows where a part is."""
LOOKS = 5
"""Places across and down a part at which a picture is looked at."""


@dataclass(frozen=True, kw_only=True)
class PaletteFlowConfig:
    """Sizes of the palette flow."""

    width: int = 192
    """Width of a token."""
    blocks: int = 4
    """Transformer blocks."""
    heads: int = 3
    """Attention heads."""
    rows: int = DEFAULT_LAYOUT.channels - 1
    """What is known of a part: the channels of a field after occupancy."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Painted:
    """Parts of objects side by side, with their palettes; rows not ``given`` are padding."""

    rows: Float[Tensor, "B N C"]
    palettes: Float[Tensor, "B N 7"]
    given: Bool[Tensor, "B N"]

    def to(self, device: torch.device | str) -> "Painted":
        """The same batch on another device."""
        return Painted(**{name: value.to(device) for name, value in vars(self).items()})


class PaletteFlow(nn.Module):
    """Velocity of normalised palettes of given parts, under a condition.

    ``mean`` and ``std`` per channel belong to the weights: palettes are ``drawn * std + mean``.
    """

    mean: Tensor
    std: Tensor

    def __init__(self, cfg: PaletteFlowConfig, conditions: ConditionConfig) -> None:
        super().__init__()
        self.cfg = cfg
        inner = StructureDitConfig(
            model_channels=cfg.width, cond_channels=conditions.width, num_heads=cfg.heads, share_mod=True
        )
        self.conditions = ConditionEncoder(conditions)
        self.t_embedder = TimestepEmbedder(cfg.width)
        self.modulation = nn.Sequential(nn.SiLU(), nn.Linear(cfg.width, 6 * cfg.width))
        self.table = nn.Parameter(torch.zeros(cfg.blocks, 6 * cfg.width))
        self.pooled = nn.Linear(conditions.width, cfg.width)
        self.parts = nn.Sequential(
            nn.Linear(cfg.rows + SEEN, cfg.width), nn.SiLU(), nn.Linear(cfg.width, cfg.width)
        )
        self.input_layer = nn.Linear(PALETTE, cfg.width)
        self.blocks = nn.ModuleList(ModulatedBlock(inner) for _ in range(cfg.blocks))
        self.out_layer = nn.Linear(cfg.width, PALETTE)
        self.register_buffer("mean", torch.zeros(PALETTE))
        self.register_buffer("std", torch.ones(PALETTE))
        for name, parameter in self.named_parameters():
            if name.startswith(("modulation", "out_layer", "pooled")):
                nn.init.zeros_(parameter)

    def velocity(
        self,
        x: Float[Tensor, "B N 7"],
        times: Float[Tensor, "B"],
        tokens: Float[Tensor, "B M K"],
        told: Float[Tensor, "B N K"],
        given: Bool[Tensor, "B N"],
    ) -> Float[Tensor, "B N 7"]:
        """Velocity of normalised palettes at times in [0, 1], under embedded conditions.

        Args:
            x: noisy palettes.
            times: one for each object.
            tokens: of the conditions.
            told: rows of the parts, and what the picture shows where they are (`look_at_parts`).
            given: rows that are parts.
        """
        h = self.input_layer(x) + self.parts(told)
        mod = self.modulation(self.t_embedder(1000.0 * times) + self.pooled(tokens.mean(dim=1)))
        h = run_blocks(self.blocks, self.table, h, mod, tokens, given[:, None, None, :])
        return velocity_of(x, self.out_layer(plain_norm(h, eps=1e-5)).float(), times)

    def normalise(self, palettes: Float[Tensor, "B N 7"]) -> Float[Tensor, "B N 7"]:
        """Palettes as the flow sees them."""
        return (palettes - self.mean) / self.std

    def restore(self, x: Float[Tensor, "B N 7"]) -> Float[Tensor, "B N 7"]:
        """Inverse of `normalise`, within bounds: colours and shares in [0, 1]."""
        return (x * self.std + self.mean).clamp(0.0, 1.0)


def look_at_parts(
    rows: Float[Tensor, "B N C"], given: Bool[Tensor, "B N"], asked: ConditionBatch
) -> Float[Tensor, "B N 8"]:
    """What the picture shows about where each part is: mean colour, its deviation, coverage, and 1.

    Pictures are taken from near the front, so a part's box, within that of the object, lies about where it
    does within the pixels that show the object. Where there is no picture, all is 0.

    Args:
        rows: channels after occupancy of each part.
        given: rows that are parts.
        asked: conditions, of which only pictures count.
    """
    box = rows[..., after_occupancy(DEFAULT_LAYOUT.box)]
    sides = torch.stack([-box[..., 1], -box[..., 2]], dim=-1), box[..., 4:6] / 2.0  # to the right, down
    low, high = sides[0] - sides[1], sides[0] + sides[1]
    start = torch.where(given[..., None], low, torch.inf).amin(dim=1, keepdim=True)
    extent = torch.where(given[..., None], high, -torch.inf).amax(dim=1, keepdim=True) - start
    line = (torch.arange(LOOKS, device=rows.device) + 0.5) / LOOKS
    shares = torch.stack(torch.meshgrid(line, line, indexing="ij"), dim=-1).reshape(-1, 2)
    at = (low - start)[:, :, None] + (high - low)[:, :, None] * shares
    at = at / extent.clamp(min=1e-6)[:, :, None]
    first, last = _find_object(asked.image[:, 3])
    places = first[:, None, None] + (last - first)[:, None, None] * at
    found = functional.grid_sample(asked.image, 2.0 * places - 1.0, align_corners=False)
    alpha = found[:, 3:].mean(dim=-1)
    color = found[:, :3].sum(dim=-1) / found[:, 3:].sum(dim=-1).clamp(min=1e-3)
    seen = torch.cat([color, found[:, :3].std(dim=-1), alpha, torch.ones_like(alpha)], dim=1)
    return seen.transpose(1, 2) * (given & asked.has_image[:, None])[..., None]


def _find_object(alpha: Float[Tensor, "B H W"]) -> tuple[Float[Tensor, "B 2"], Float[Tensor, "B 2"]]:
    """First and last corner (right, down; shares of the picture) of the pixels that show something."""
    ends = []
    for shown in ((alpha > 0.5).any(dim=1), (alpha > 0.5).any(dim=2)):
        count = shown.shape[1]
        order = torch.arange(count, device=alpha.device)
        first = torch.where(shown, order, count).amin(dim=1)
        last = torch.where(shown, order, -1).amax(dim=1)
        empty = last < 0
        ends.append((torch.where(empty, 0, first) / count, torch.where(empty, count, last + 1) / count))
    return torch.stack([end[0] for end in ends], dim=1), torch.stack([end[1] for end in ends], dim=1)


def gather_painted(
    tables: Sequence[Float[np.ndarray, "P C"]], palettes: Sequence[Float[np.ndarray, "P 7"]]
) -> Painted:
    """Parts of several objects side by side, padded to the longest."""
    longest = max(len(table) for table in tables)
    rows = np.zeros((len(tables), longest, tables[0].shape[1]), dtype=np.float32)
    colors = np.zeros((len(tables), longest, PALETTE), dtype=np.float32)
    given = np.zeros((len(tables), longest), dtype=bool)
    for number, (table, palette) in enumerate(zip(tables, palettes, strict=True)):
        rows[number, : len(table)], colors[number, : len(table)] = table, palette
        given[number, : len(table)] = True
    return Painted(
        rows=torch.from_numpy(rows), palettes=torch.from_numpy(colors), given=torch.from_numpy(given)
    )


@torch.no_grad()
def sample_palettes(
    flow: PaletteFlow,
    table: Float[np.ndarray, "P C"],
    asked: ConditionBatch,
    nothing: ConditionBatch,
    generator: torch.Generator,
    cfg: SamplerConfig,
    *,
    fixed: Float[np.ndarray, "P 7"] | None = None,
) -> Float[np.ndarray, "P 7"]:
    """Draws the palettes of one object's parts.

    Parts that match (`artigen.palettes.find_twins`) go one way: they start at the same noise, and their
    velocities are averaged. What is fixed is put onto its own path from the same noise at every step, so that
    the rest is drawn to go with it.

    Args:
        flow: the trained flow.
        table: channels after occupancy of each part.
        asked: one condition.
        nothing: one condition with everything open.
        generator: of the noise, on the CPU.
        cfg: steps and guidance.
        fixed: numbers that are known; NaN where they are to be drawn.
    """
    tokens, without = flow.conditions(asked), flow.conditions(nothing)
    rows = torch.from_numpy(table).float()[None].to(tokens.device)
    given = torch.ones(rows.shape[:2], dtype=torch.bool, device=tokens.device)
    told, blind = (torch.cat([rows, look_at_parts(rows, given, one)], dim=-1) for one in (asked, nothing))
    noise = torch.randn((*rows.shape[:2], PALETTE), generator=generator).to(tokens.device)
    twins = torch.from_numpy(find_twins(table)).to(tokens.device)
    together = functional.one_hot(twins, len(table)).float()
    together = together / together.sum(dim=0).clamp(min=1.0)  # means over the twins of a part
    noise = noise[:, twins]
    known = torch.full_like(noise, torch.nan)
    if fixed is not None:
        known = flow.normalise(torch.from_numpy(fixed).float()[None].to(tokens.device))

    def hold(x: Tensor, times: Tensor) -> Tensor:
        return torch.where(known.isnan(), x, diffuse(known, noise, times))

    def agree(velocity: Tensor) -> Tensor:
        return (together.T @ velocity)[:, twins]

    def conditional(x: Tensor, times: Tensor) -> Tensor:
        return agree(flow.velocity(hold(x, times), times, tokens, told, given))

    def pair(x: Tensor, times: Tensor) -> tuple[Tensor, Tensor]:
        return conditional(x, times), agree(flow.velocity(hold(x, times), times, without, blind, given))

    drawn = sample_flow(noise, conditional, pair, cfg)
    return flow.restore(torch.where(known.isnan(), drawn, known))[0].cpu().numpy()
