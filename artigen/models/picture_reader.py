"""The picture reader: what one picture shows, as a condition says it: category, counts, proportions.

How many drawers a cabinet has is seen where the drawers are, so counting is learnt there: a map for each
label whose sum is the number of parts in view, as crowds are counted (Lempitsky and Zisserman 2010). What is
behind doors is then guessed from the whole picture and from what was counted.
"""

from dataclasses import dataclass, replace

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from artigen.datasets.sizes import estimate_size
from artigen.models.conditions import MAX_COUNT, ConditionConfig, StructureCondition
from artigen.types import PART_LABELS

CELL = 4
"""Edge of a cell of the maps, in pixels."""
GROUPS = 8
"""Groups of channels that are normalised together."""
EMPTY = -5.0
"""What an untrained map says everywhere, before it is made positive: nothing is here."""


@dataclass(frozen=True, kw_only=True)
class PictureReaderConfig:
    """Sizes of the picture reader."""

    widths: tuple[int, ...] = (64, 128, 192)
    """Channels of the levels; each has half the resolution of the one before, the first that of the maps."""
    blocks: int = 2
    """Residual blocks of a level."""
    stem: int = 32
    """Channels at half the picture's resolution."""
    hidden: int = 256
    """Width in which counts are weighed against the whole picture."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Reading:
    """What pictures seem to show."""

    density: Float[Tensor, "B L h w"]
    """Parts of each label per cell: the sum is how many are in view."""
    labels: Float[Tensor, "B L+1 h w"]
    """Logits of the label that a cell shows; the last one: none."""
    counts: Float[Tensor, "B L K"]
    """Logits of how many parts of each label there are, those out of view too."""
    category: Float[Tensor, "B G"]
    """Logits."""
    log_extents: Float[Tensor, "B 3"]
    """Logarithms of depth, width and height as shares of the longest."""


class PictureReader(nn.Module):
    """A convolutional pyramid with maps of parts, and a head that weighs their sums."""

    def __init__(self, cfg: PictureReaderConfig, conditions: ConditionConfig) -> None:
        super().__init__()
        self.cfg, self.conditions = cfg, conditions
        first, last, kinds = cfg.widths[0], cfg.widths[-1], len(PART_LABELS)
        self.stem = nn.Sequential(_block(4, cfg.stem, 2), _block(cfg.stem, cfg.stem))
        self.levels = nn.ModuleList(
            nn.Sequential(_block(before, width, 2), *(_Residual(width) for _ in range(cfg.blocks)))
            for before, width in zip((cfg.stem, *cfg.widths), cfg.widths, strict=False)
        )
        self.aside = nn.ModuleList(nn.Conv2d(width, first, 1) for width in cfg.widths)
        self.merge = nn.ModuleList(_block(first, first) for _ in cfg.widths[1:])
        self.maps = nn.Conv2d(first, 2 * kinds + 1, 1)
        whole = 2 * last + first
        self.whole = nn.Sequential(nn.LayerNorm(whole), nn.Linear(whole, cfg.hidden // 2), nn.SiLU())
        self.weigh = nn.Sequential(
            nn.Linear(kinds * (MAX_COUNT + 1) + cfg.hidden // 2, cfg.hidden),
            nn.SiLU(),
            nn.Linear(cfg.hidden, kinds * (MAX_COUNT + 1) + len(conditions.categories) + 3),
        )
        assert self.maps.bias is not None
        nn.init.constant_(self.maps.bias[:kinds], EMPTY)

    def forward(self, image: Float[Tensor, "B 4 H W"]) -> Reading:
        """Reads pictures: RGB and alpha in [0, 1], premultiplied on black."""
        x, levels = self.stem(2.0 * image - 1.0), []
        for level in self.levels:
            x = level(x)
            levels.append(x)
        maps = self.aside[-1](x)
        for finer, aside, merge in zip(levels[-2::-1], self.aside[-2::-1], self.merge, strict=True):
            maps = merge(functional.interpolate(maps, scale_factor=2.0) + aside(finer))
        said = self.maps(maps).float()
        density = functional.softplus(said[:, : len(PART_LABELS)])
        pooled = torch.cat([x.mean(dim=(2, 3)), x.amax(dim=(2, 3)), maps.mean(dim=(2, 3))], dim=1)
        sums = _soft_one_hot(density.sum(dim=(2, 3))).flatten(1)
        out = self.weigh(torch.cat([sums, self.whole(pooled.float())], dim=1)).float()
        counts, rest = out.tensor_split((len(PART_LABELS) * (MAX_COUNT + 1),), dim=1)
        ratios = rest[:, -3:]
        return Reading(
            density=density,
            labels=said[:, len(PART_LABELS) :],
            counts=counts.unflatten(1, (len(PART_LABELS), -1)),
            category=rest[:, :-3],
            log_extents=ratios - ratios.amax(dim=1, keepdim=True),
        )


@torch.no_grad()
def read_condition(
    reader: PictureReader, asked: StructureCondition
) -> tuple[StructureCondition, tuple[str, ...]]:
    """What a condition leaves open, read off its picture: the likeliest of each; and a sentence about it.

    A picture shows proportions, not metres: the size is what is usual for such an object. A condition
    without a picture, or one that leaves nothing open, stays as it is.
    """
    said = asked.category is not None and asked.size is not None and len(asked.counts) == len(PART_LABELS)
    if asked.image is None or said:
        return asked, ()
    seen = _look(reader, asked.image)
    known = dict(asked.counts)
    category = asked.category or reader.conditions.categories[int(seen.category[0].argmax())]
    read = seen.counts[0].argmax(dim=-1).tolist()
    counts = tuple((label, known.get(label, count)) for label, count in zip(PART_LABELS, read, strict=True))
    shares = seen.log_extents[0].exp().cpu().numpy().astype(np.float64)
    longest, _ = estimate_size(category, shares)
    depth, width, height = (longest * shares).tolist()
    whole = replace(asked, category=category, counts=counts, size=asked.size or (depth, width, height))
    parts = ", ".join(f"{count} {label}" for label, count in counts if count and label not in known)
    metres = " x ".join(f"{edge:.2f}" for edge in whole.size or ())
    return whole, (f"picture: read as {category} of {metres} m with {parts or 'no parts'}",)


def _look(reader: PictureReader, image: Float[np.ndarray, "4 H W"]) -> Reading:
    picture = torch.from_numpy(np.ascontiguousarray(image, dtype=np.float32))
    return reader(picture[None].to(next(reader.parameters()).device))


class _Residual(nn.Module):
    def __init__(self, width: int) -> None:
        super().__init__()
        self.block = nn.Sequential(
            _block(width, width), nn.Conv2d(width, width, 3, 1, 1, bias=False), nn.GroupNorm(GROUPS, width)
        )

    def forward(self, x: Float[Tensor, "B C h w"]) -> Float[Tensor, "B C h w"]:
        return functional.silu(x + self.block(x))


def _block(before: int, width: int, stride: int = 1) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(before, width, 3, stride, 1, bias=False), nn.GroupNorm(GROUPS, width), nn.SiLU()
    )


def _soft_one_hot(numbers: Float[Tensor, "B L"]) -> Float[Tensor, "B L K"]:
    """Bumps around every whole number up to `MAX_COUNT`, at which a linear layer can tell numbers apart."""
    return torch.exp(-2.0 * (numbers[..., None] - torch.arange(MAX_COUNT + 1, device=numbers.device)) ** 2)
