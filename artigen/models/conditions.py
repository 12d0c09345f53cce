"""Conditions of the generative models: any subset of category, counts, size, sentence and picture.

A condition becomes a row of tokens. Every open field is a learned token of its own, so that one network
serves every subset. Leaving everything open gives the unconditional velocity of guidance.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from artigen.conditioning.image import MARGIN
from artigen.kind import paper_kinds
from artigen.models.batch import TensorBatch
from artigen.models.public_encoders import ClipConfig, DinoConfig, PublicPictures, PublicSentences
from artigen.shapes.shape import Shape
from artigen.types import PART_LABELS, PartLabel

MAX_COUNT = 24
"""Counts from here on share one token."""
ALONE = 0.25
"""Share of the pictures in training whose other conditions are all left open."""
FIELDS = 1 + len(PART_LABELS) + 1


@dataclass(frozen=True, kw_only=True)
class StructureCondition:
    """Condition of a structure; None is unconstrained. Metres."""

    category: str | None = None
    counts: tuple[tuple[PartLabel, int], ...] = ()
    size: tuple[float, float, float] | None = None
    """Depth, width, height: the extent along x, y and z."""
    image: Float[np.ndarray, "4 H W"] | None = None
    """RGB and alpha in [0, 1], premultiplied on black."""
    text: str | None = None
    """A sentence, for models that read sentences; for others, it must be parsed into counts and sizes."""


def describe_shape(shape: Shape) -> StructureCondition:
    """Category, counts of every label and size of a shape."""
    exact = shape.condition
    held = dict(exact.counts)
    return StructureCondition(
        category=shape.category,
        counts=tuple((label, held.get(label, 0)) for label in PART_LABELS),
        size=(exact.depth, exact.width, exact.height),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class ConditionBatch(TensorBatch):
    """Conditions as numbers: -1 where a class is open; ``has_`` marks the other fields that are given."""

    category: Int[Tensor, "B"]
    counts: Int[Tensor, "B L"]
    size: Float[Tensor, "B 3"]
    has_size: Bool[Tensor, "B"]
    image: Float[Tensor, "B 4 H W"]
    has_image: Bool[Tensor, "B"]
    texts: tuple[str | None, ...]


@dataclass(frozen=True, kw_only=True)
class ConditionConfig:
    """How a condition is embedded."""

    width: int = 256
    """Width of a token."""
    categories: tuple[str, ...] = field(default_factory=paper_kinds)
    """Categories that have a token of their own."""
    image_size: int = 128
    """Edge of the picture in pixels; 0 leaves pictures out."""
    image_patch: int = 16
    """Edge of a picture token in pixels."""
    image_width: int = 128
    """Width of the picture encoder."""
    image_blocks: int = 3
    """Transformer blocks of the picture encoder."""
    dino: DinoConfig | None = None
    """DINOv2 instead of the picture encoder; its width is that of all tokens."""
    clip: ClipConfig | None = None
    """CLIP, which reads sentences; None for no sentences."""

    @property
    def image_margin(self) -> float:
        """Free border around the object in a picture, as a share of the edge, as its encoder expects."""
        return MARGIN if self.dino is None else 1 / 12

    def __post_init__(self) -> None:
        if self.dino is not None and self.dino.width != self.width:
            raise ValueError(
                f"DINOv2 has tokens of width {self.dino.width}, expected {self.width}, that of all conditions"
            )


def gather_conditions(asked: Sequence[StructureCondition], cfg: ConditionConfig) -> ConditionBatch:
    """Batches conditions.

    Raises:
        ValueError: If a category has no token, a count is negative, or an image has another size.
    """
    size = max(cfg.image_size, 1)
    images = torch.zeros(len(asked), 4, size, size)
    counts = torch.full((len(asked), len(PART_LABELS)), -1)
    for row, one in enumerate(asked):
        if one.category is not None and one.category not in cfg.categories:
            raise ValueError(f"category {one.category!r} is not one of {', '.join(cfg.categories)}")
        for label, count in one.counts:
            if count < 0:
                raise ValueError(f"{count} parts called {label}, expected 0 or more")
            counts[row, PART_LABELS.index(label)] = min(count, MAX_COUNT)
        if one.image is not None:
            if one.image.shape != (4, size, size):
                raise ValueError(f"image of shape {one.image.shape}, expected {(4, size, size)}")
            images[row] = torch.from_numpy(np.ascontiguousarray(one.image))
    return ConditionBatch(
        category=torch.tensor(
            [-1 if c.category is None else cfg.categories.index(c.category) for c in asked]
        ),
        counts=counts,
        size=torch.tensor([c.size or (1.0, 1.0, 1.0) for c in asked]),
        has_size=torch.tensor([c.size is not None for c in asked]),
        image=images,
        has_image=torch.tensor([c.image is not None for c in asked]),
        texts=tuple(c.text for c in asked) if cfg.clip is not None else (None,) * len(asked),
    )


def drop_conditions(batch: ConditionBatch, share: float, generator: torch.Generator) -> ConditionBatch:
    """Opens conditions at random: all of a sample with probability ``share``, and every field likewise.

    Pictures are opened more often: two draws must both keep one.
    """
    count, labels = batch.counts.shape

    def kept(*shape: int) -> Tensor:
        return torch.rand(shape, generator=generator, device=generator.device) >= share

    all_kept = kept(count)
    return ConditionBatch(
        category=torch.where(all_kept & kept(count), batch.category, -1),
        counts=torch.where(all_kept[:, None] & kept(count, labels), batch.counts, -1),
        size=batch.size,
        has_size=batch.has_size & all_kept & kept(count),
        image=batch.image,
        has_image=batch.has_image & all_kept & (kept(count) & kept(count)),
        texts=_keep_texts(batch.texts, all_kept & kept(count)) if any(batch.texts) else batch.texts,
    )


def isolate_pictures(batch: ConditionBatch, share: float, generator: torch.Generator) -> ConditionBatch:
    """Drops all conditions but the picture, for a share of the samples that have one.

    Where conditions are dropped one by one, all others are hardly ever absent at once, and a network that
    never sees a picture alone learns to rely on the other conditions.
    """
    alone = (
        torch.rand(len(batch.counts), generator=generator, device=generator.device) < share
    ) & batch.has_image
    return replace(
        batch,
        category=torch.where(alone, -1, batch.category),
        counts=torch.where(alone[:, None], -1, batch.counts),
        has_size=batch.has_size & ~alone,
        texts=_keep_texts(batch.texts, ~alone),
    )


def _keep_texts(texts: tuple[str | None, ...], kept: Bool[Tensor, "B"]) -> tuple[str | None, ...]:
    return tuple(text if keep else None for text, keep in zip(texts, kept.tolist(), strict=True))


class ConditionEncoder(nn.Module):
    """Conditions to tokens ``[B, fields + picture tokens, width]``."""

    def __init__(self, cfg: ConditionConfig) -> None:
        super().__init__()
        self.cfg = cfg
        self.category = nn.Embedding(len(cfg.categories) + 1, cfg.width)
        self.counts = nn.Embedding(len(PART_LABELS) * (MAX_COUNT + 2), cfg.width)
        self.size = nn.Sequential(nn.Linear(6 * 8, cfg.width), nn.SiLU(), nn.Linear(cfg.width, cfg.width))
        self.no_size = nn.Parameter(torch.zeros(cfg.width))
        self.places = nn.Parameter(0.02 * torch.randn(FIELDS, cfg.width))
        self.image: ImageEncoder | PublicPictures | None = None
        if cfg.image_size:
            self.image = ImageEncoder(cfg) if cfg.dino is None else PublicPictures(cfg.dino)
        self.text = None if cfg.clip is None else PublicSentences(cfg.clip, cfg.width)

    def forward(self, batch: ConditionBatch) -> Float[Tensor, "B M C"]:
        """One token per field, then the tokens of the picture, then those of the sentence."""
        row = torch.arange(len(PART_LABELS), device=batch.counts.device) * (MAX_COUNT + 2)
        size = torch.where(batch.has_size[:, None], self.size(embed_sizes(batch.size)), self.no_size)
        fields = torch.cat(
            [self.category(batch.category + 1)[:, None], self.counts(batch.counts + 1 + row), size[:, None]],
            dim=1,
        )
        tokens = [fields + self.places]
        if self.image is not None:
            tokens.append(self.image(batch.image, batch.has_image))
        if self.text is not None:
            tokens.append(self.text(batch.texts))
        return torch.cat(tokens, dim=1)


class ImageEncoder(nn.Module):
    """A small vision transformer; a missing picture is one learned token, repeated."""

    def __init__(self, cfg: ConditionConfig) -> None:
        super().__init__()
        edge, width = cfg.image_size // cfg.image_patch, cfg.image_width
        self.patches = nn.Conv2d(4, width, cfg.image_patch, stride=cfg.image_patch)
        self.places = nn.Parameter(0.02 * torch.randn(edge**2, width))
        self.missing = nn.Parameter(torch.zeros(cfg.width))
        layer = nn.TransformerEncoderLayer(
            width,
            width // 32,
            4 * width,
            dropout=0.0,
            activation="gelu",
            batch_first=True,
            norm_first=True,
        )
        self.blocks = nn.TransformerEncoder(
            layer, cfg.image_blocks, norm=nn.LayerNorm(width), enable_nested_tensor=False
        )
        self.out_layer = nn.Linear(width, cfg.width)

    def forward(self, image: Float[Tensor, "B 4 H W"], given: Bool[Tensor, "B"]) -> Float[Tensor, "B M C"]:
        rows = given.nonzero()[:, 0]  # missing pictures cost no computation
        if not len(rows):
            rows = rows.new_zeros(1)  # every weight needs a gradient where several GPUs train
        tokens = self.patches(2.0 * image[rows] - 1.0).flatten(2).transpose(1, 2) + self.places
        seen = self.out_layer(self.blocks(tokens))
        every = self.missing.to(seen.dtype).expand(len(image), *seen.shape[1:])
        return torch.where(given[:, None, None], every.index_copy(0, rows, seen), every)


def embed_sizes(size: Float[Tensor, "B 3"]) -> Float[Tensor, "B W"]:
    """Sines and cosines of the logarithms of lengths (m): equal steps are equal ratios."""
    rates = 2.0 ** torch.arange(8, device=size.device)
    angles = torch.log(size.clamp(min=1e-3))[:, :, None] * rates
    return torch.cat([angles.sin(), angles.cos()], dim=-1).flatten(1)
