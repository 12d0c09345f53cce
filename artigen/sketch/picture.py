"""`PictureEncoder`: encodes a picture as tokens for the network.

A convolutional pyramid processes the picture at 1/4, 1/8 and 1/16 of its resolution. Visible parts are
counted with density maps: one map per label whose sum is the number of parts in view, as in crowd counting
(Lempitsky and Zisserman 2010). From these sums and a global feature the encoder predicts the total counts,
hidden parts included.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from artigen.sketch.blocks import TokenBlock
from artigen.sketch.words import CATEGORIES
from artigen.types import PART_LABELS

CELL = 4
"""Edge length (pixels) of a cell of the maps."""
TOKEN = 16
"""Edge length (pixels) of the square that a token covers."""
GROUPS = 8
"""Groups of the group normalisation."""
EMPTY = -5.0
"""Initial bias of the density maps before softplus: empty everywhere."""
MAX_COUNT = 24
"""Largest count that is distinguished."""
WAVES = 6
"""Frequencies of the positional encoding of tokens, per axis."""


@dataclass(frozen=True, kw_only=True)
class PictureConfig:
    """Layer sizes of the picture encoder."""

    edge: int = 256
    """Edge length of the picture in pixels."""
    widths: tuple[int, int, int] = (64, 128, 192)
    """Channels at 1/4, 1/8 and 1/16 of the picture's resolution."""
    blocks: tuple[int, int, int] = (1, 2, 2)
    """Residual blocks of each level."""
    stem: int = 32
    """Channels at half the resolution."""
    whole: int = 128
    """Width of the global feature."""
    layers: int = 3
    """Self-attention blocks over the tokens."""
    heads: int = 8
    """Heads of each."""

    def __post_init__(self) -> None:
        if self.edge % TOKEN or self.edge < TOKEN:
            raise ValueError(f"picture edge of {self.edge} pixels: expected a multiple of {TOKEN}")


@dataclass(frozen=True, kw_only=True, eq=False)
class PicturePrediction:
    """Predictions from pictures."""

    tokens: Float[Tensor, "B N D"]
    """One per square of the picture, then two global ones: the appearance, and the predicted counts and
    category."""
    density: Float[Tensor, "B L h w"]
    """Parts of each label per cell; the sum is the number of parts in view."""
    labels: Float[Tensor, "B L+1 h w"]
    """Logits of the label that a cell shows; the last entry is background."""
    counts: Float[Tensor, "B L K"]
    """Logits of the number of parts of each label."""
    category: Float[Tensor, "B G"]
    """Logits of the category."""
    view: Float[Tensor, "B 3"]
    """Yaw and pitch of the camera (radians), and half the object's diagonal over its distance."""

    def __getitem__(self, pictures: slice) -> "PicturePrediction":
        """The predictions from some of the pictures."""
        return PicturePrediction(**{name: value[pictures] for name, value in vars(self).items()})

    def rate(self, category: int, counts: Sequence[int]) -> float:
        """Log probability of a category and of the counts of all labels but the base; first picture only."""
        chances = self.counts[0, 1:].log_softmax(dim=1)
        index = torch.tensor(counts, device=chances.device).clamp(max=MAX_COUNT)
        return float(chances.gather(1, index[:, None]).sum() + self.category[0].log_softmax(dim=0)[category])


class PictureEncoder(nn.Module):
    """The pyramid, its maps and the tokens."""

    places: Tensor

    def __init__(self, cfg: PictureConfig, width: int) -> None:
        super().__init__()
        self.cfg = cfg
        first, _, last = cfg.widths
        kinds, side = len(PART_LABELS), cfg.edge // TOKEN
        self.stem = nn.Sequential(_block(4, cfg.stem, 2), _block(cfg.stem, cfg.stem))
        self.levels = nn.ModuleList(
            nn.Sequential(_block(before, here, 2), *(_Residual(here) for _ in range(blocks)))
            for before, here, blocks in zip((cfg.stem, *cfg.widths), cfg.widths, cfg.blocks, strict=False)
        )
        self.aside = nn.ModuleList(nn.Conv2d(here, first, 1) for here in cfg.widths)
        self.merge = nn.ModuleList(_block(first, first) for _ in cfg.widths[1:])
        self.maps = nn.Conv2d(first, 2 * kinds + 1, 1)
        fine = first * (TOKEN // CELL) ** 2
        self.squares = nn.Linear(fine + last + 4 * WAVES, width)
        whole = 2 * last + first
        self.whole = nn.Sequential(nn.LayerNorm(whole), nn.Linear(whole, cfg.whole), nn.SiLU())
        self.whole_token = nn.Linear(cfg.whole, width)
        guessed = kinds * (MAX_COUNT + 1) + len(CATEGORIES)
        self.weigh = nn.Sequential(
            nn.Linear(kinds * (MAX_COUNT + 1) + cfg.whole, 2 * cfg.whole),
            nn.SiLU(),
            nn.Linear(2 * cfg.whole, guessed),
        )
        self.guess_token = nn.Linear(guessed, width)
        self.view = nn.Linear(cfg.whole, 3)
        self.blocks = nn.ModuleList(TokenBlock(width, cfg.heads) for _ in range(cfg.layers))
        self.norm = nn.RMSNorm(width)
        for block in self.blocks:
            assert isinstance(block, TokenBlock)
            block.shrink(cfg.layers)
        assert self.maps.bias is not None
        nn.init.constant_(self.maps.bias[:kinds], EMPTY)
        self.register_buffer("places", _place_waves(side), persistent=False)

    def forward(self, image: Float[Tensor, "B 4 S S"]) -> PicturePrediction:
        """Encodes pictures: RGB and alpha in [0, 1], premultiplied on black."""
        x, levels = self.stem((2.0 * image - 1.0).contiguous(memory_format=torch.channels_last)), []
        for level in self.levels:
            x = level(x)
            levels.append(x)
        fine = self.aside[-1](x)
        for finer, aside, merge in zip(levels[-2::-1], self.aside[-2::-1], self.merge, strict=True):
            fine = merge(functional.interpolate(fine, scale_factor=2.0) + aside(finer))
        maps = self.maps(fine).float()
        density = functional.softplus(maps[:, : len(PART_LABELS)])
        means = [level.mean(dim=(2, 3), dtype=torch.float32) for level in (x, fine)]
        whole = self.whole(torch.cat([means[0], x.amax(dim=(2, 3)).float(), means[1]], dim=1))
        squares = torch.cat([functional.pixel_unshuffle(fine, TOKEN // CELL), x], dim=1)
        squares = squares.flatten(2).transpose(1, 2)
        places = self.places.to(squares.dtype).expand(len(squares), -1, -1)
        sums = _soft_one_hot(density.sum(dim=(2, 3))).flatten(1)
        counts, category = (
            self.weigh(torch.cat([sums, whole], dim=1))
            .float()
            .tensor_split((len(PART_LABELS) * (MAX_COUNT + 1),), dim=1)
        )
        counts = counts.unflatten(1, (len(PART_LABELS), -1))
        chances = [counts.softmax(dim=2).flatten(1), category.softmax(dim=1)]
        parts = [
            self.squares(torch.cat([squares, places], dim=2)),
            self.whole_token(whole)[:, None],
            self.guess_token(torch.cat(chances, dim=1))[:, None],
        ]
        tokens = torch.cat([part.float() for part in parts], dim=1)
        for block in self.blocks:
            tokens = block(tokens)
        return PicturePrediction(
            tokens=self.norm(tokens),
            density=density,
            labels=maps[:, len(PART_LABELS) :],
            counts=counts,
            category=category,
            view=self.view(whole).float(),
        )


class _GroupNorm(nn.GroupNorm):
    """Normalises in the number type of its input; autocast would convert whole feature maps to float32."""

    def forward(self, input: Float[Tensor, "B C h w"]) -> Float[Tensor, "B C h w"]:
        weight, bias = self.weight.to(input.dtype), self.bias.to(input.dtype)
        with torch.autocast(input.device.type, enabled=False):
            return functional.group_norm(input, self.num_groups, weight, bias, self.eps)


class _Residual(nn.Module):
    def __init__(self, width: int) -> None:
        super().__init__()
        self.block = nn.Sequential(
            _block(width, width), nn.Conv2d(width, width, 3, 1, 1, bias=False), _GroupNorm(GROUPS, width)
        )

    def forward(self, x: Float[Tensor, "B C h w"]) -> Float[Tensor, "B C h w"]:
        return functional.silu(x + self.block(x))


def _block(before: int, width: int, stride: int = 1) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(before, width, 3, stride, 1, bias=False), _GroupNorm(GROUPS, width), nn.SiLU()
    )


def _soft_one_hot(numbers: Float[Tensor, "B L"]) -> Float[Tensor, "B L K"]:
    """Soft one-hot encoding over the integers up to `MAX_COUNT`."""
    return torch.exp(-2.0 * (numbers[..., None] - torch.arange(MAX_COUNT + 1, device=numbers.device)) ** 2)


def _place_waves(side: int) -> Float[Tensor, "N W"]:
    """Sinusoidal encoding of the row and column of each square."""
    at = (np.arange(side) + 0.5) / side
    waves = at[:, None] * np.pi * 2.0 ** np.arange(WAVES)
    line = np.concatenate([np.sin(waves), np.cos(waves)], axis=1)
    rows, columns = np.indices((side, side))
    return torch.from_numpy(np.concatenate([line[rows.ravel()], line[columns.ravel()]], axis=1)).float()
