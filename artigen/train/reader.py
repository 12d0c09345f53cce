"""Training of the picture reader: pictures of examples, and the parts that they show."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn
from torch.nn import functional

from artigen.errors import SourceError
from artigen.models.conditions import MAX_COUNT, ConditionConfig
from artigen.models.outline import part_labels
from artigen.models.picture_reader import CELL, PictureReader, Reading
from artigen.train.batches import condition_batch, draw_batches, prefetch
from artigen.train.examples import StructureExample
from artigen.train.loop import LoopConfig, Report, process_seed, train
from artigen.train.photographs import NOTHING
from artigen.types import PART_LABELS

IN_VIEW = 2
"""Pixels of a part, at least, for it to be in view."""
ZOOM, SHIFT = 0.09, 0.05
"""Largest change of scale, and shift as a share of the edge, of a picture in training."""
GAIN, GAMMA, GRAIN = 0.3, 0.3, 0.02
"""Largest change of the colour channels and of contrast, and noise, of a picture in training."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SeenParts:
    """Pictures with the parts that they show, and all that is to be read off them."""

    image: Float[Tensor, "B 4 H W"]
    labels: Int[Tensor, "B H W"]
    """Label in the middle of each pixel; their number where there is none."""
    centers: Float[Tensor, "B N 2"]
    """Mean place of what one sees of a part: right and down, from -1 to 1."""
    kinds: Int[Tensor, "B N"]
    """Labels of the parts."""
    given: Bool[Tensor, "B N"]
    """Which of the rows are parts in view."""
    counts: Int[Tensor, "B L"]
    category: Int[Tensor, "B"]
    log_extents: Float[Tensor, "B 3"]

    def to(self, device: torch.device | str) -> "SeenParts":
        """The same batch on another device."""
        return SeenParts(**{name: value.to(device, non_blocking=True) for name, value in vars(self).items()})


def train_picture_reader(
    reader: PictureReader,
    examples: Sequence[StructureExample],
    folder: Path,
    cfg: LoopConfig,
    *,
    batch: int,
    on_report: Report | None = None,
) -> PictureReader:
    """Trains the picture reader.

    Args:
        reader: On the CPU; it is moved.
        examples: With pictures, and the parts that they show.
        folder: Of the stage.
        cfg: Budget and rates.
        batch: Pictures per step.
        on_report: Called with every line of metrics.

    Raises:
        SourceError: If an example has no picture, or it is not known what it shows.
    """
    blind = [example.name for example in examples if example.image is None or example.shown is None]
    if blind:
        raise SourceError(
            f"{len(blind)} examples, {blind[0]} the first, have no picture whose parts are known; "
            "make the data anew"
        )

    def terms(network: nn.Module, drawn: SeenParts, generator: torch.Generator) -> dict[str, Tensor]:
        return network(vary_pictures(drawn, generator))

    make = partial(see_parts, conditions=reader.conditions)
    batches: Iterator[SeenParts] = prefetch(draw_batches(examples, make, batch, process_seed(cfg.seed)))
    train(ReaderLosses(reader), terms, batches, folder, cfg, on_report=on_report)
    return reader


class ReaderLosses(nn.Module):
    """The losses of a picture reader as a network of their own, so that several GPUs can share a batch."""

    def __init__(self, reader: PictureReader) -> None:
        super().__init__()
        self.reader = reader

    def forward(self, drawn: SeenParts) -> dict[str, Tensor]:
        """Maps, counts, category and proportions, each with its weight.

        The map is the rate of a Poisson process: unlike a squared error, its likelihood is not content with
        zeros where parts are few.
        """
        said: Reading = self.reader(drawn.image)
        truth = spread_parts(drawn)
        middle = drawn.labels[:, CELL // 2 :: CELL, CELL // 2 :: CELL]
        off = said.density.sum(dim=(2, 3)) - truth.sum(dim=(2, 3))
        return {
            "density": 0.3
            * (said.density - truth * said.density.clamp(min=1e-6).log()).sum(dim=(2, 3)).mean(),
            "in view": 0.1 * off.abs().mean(),
            "labels": 0.5 * functional.cross_entropy(said.labels, middle),
            "counts": functional.cross_entropy(said.counts.flatten(0, 1), drawn.counts.flatten()),
            "category": 0.3 * functional.cross_entropy(said.category, drawn.category, ignore_index=-1),
            "extents": 2.0 * functional.mse_loss(said.log_extents, drawn.log_extents),
        }


def see_parts(examples: Sequence[StructureExample], conditions: ConditionConfig) -> SeenParts:
    """Pictures of examples side by side, with what they show."""
    known = condition_batch(examples, conditions)
    found = [_find_parts(example) for example in examples]
    most = max(1, *(len(kinds) for kinds, _ in found))
    kinds = torch.stack([functional.pad(one, (0, most - len(one))) for one, _ in found])
    centers = torch.stack([functional.pad(one, (0, 0, 0, most - len(one))) for _, one in found])
    number = torch.tensor([len(one) for one, _ in found])
    return SeenParts(
        image=known.image,
        labels=torch.stack([_label_pixels(example) for example in examples]),
        centers=centers,
        kinds=kinds,
        given=torch.arange(most) < number[:, None],
        counts=known.counts.clamp(max=MAX_COUNT),
        category=known.category,
        log_extents=(known.size / known.size.amax(dim=1, keepdim=True)).log(),
    )


def vary_pictures(drawn: SeenParts, generator: torch.Generator) -> SeenParts:
    """The same objects seen a little nearer or further off, to a side, mirrored, and in other colours."""
    count, _, edge, _ = drawn.image.shape
    device = generator.device

    def within(limit: float, *shape: int) -> Tensor:
        return limit * (2.0 * torch.rand(shape, generator=generator, device=device) - 1.0)

    zoom = 1.0 + within(ZOOM, count)
    side = torch.randint(2, (count,), generator=generator, device=device) * 2.0 - 1.0
    scale = torch.stack([zoom * side, zoom], dim=1)
    shift = 2.0 * within(SHIFT, count, 2)
    affine = torch.cat([torch.diag_embed(scale), shift[..., None]], dim=2)
    grid = functional.affine_grid(affine, [count, 1, edge, edge], align_corners=False)
    image = functional.grid_sample(drawn.image, grid, align_corners=False)
    nothing = len(PART_LABELS)
    marks = (drawn.labels[:, None] - nothing).to(image.dtype)  # beyond the edge there is nothing
    labels = functional.grid_sample(marks, grid, mode="nearest", align_corners=False).round().long()
    alpha = image[:, 3:]
    color = (image[:, :3] / alpha.clamp(min=1e-2)).clamp(0.0, 1.0)
    color = color ** torch.exp(within(GAMMA, count, 1, 1, 1)) * (1.0 + within(GAIN, count, 3, 1, 1))
    color = color + GRAIN * torch.randn(color.shape, generator=generator, device=device)
    return replace(
        drawn,
        image=torch.cat([color.clamp(0.0, 1.0) * alpha, alpha], dim=1),
        labels=labels[:, 0] + nothing,
        centers=(drawn.centers - shift[:, None]) / scale[:, None],
    )


def spread_parts(drawn: SeenParts) -> Float[Tensor, "B L h w"]:
    """Parts of each label per cell: around the middle of every part in view a bump whose sum is 1."""
    edge = drawn.image.shape[-1] // CELL
    places = torch.arange(edge, device=drawn.centers.device) + 0.5
    at = (drawn.centers + 1.0) * (edge / 2)
    bumps = torch.exp(-0.5 * (places - at[..., None]) ** 2)
    inside = (drawn.given & (at >= 0).all(dim=-1) & (at <= edge).all(dim=-1))[..., None]
    across, down = (bumps / bumps.sum(dim=-1, keepdim=True).clamp(min=1e-6)).unbind(dim=2)
    kinds = functional.one_hot(drawn.kinds, len(PART_LABELS)) * inside
    return torch.einsum("bnl,bnh,bnw->blhw", kinds.to(down.dtype), down, across)


def _find_parts(example: StructureExample) -> tuple[Int[Tensor, "N"], Float[Tensor, "N 2"]]:
    """Labels and places of the parts that a picture shows."""
    assert example.shown is not None
    rows, columns = np.indices(example.shown.shape)
    shown = example.shown.ravel()
    pixels = np.bincount(shown, minlength=NOTHING + 1)[:NOTHING]
    seen = np.flatnonzero(pixels >= IN_VIEW)
    middles = [
        np.bincount(shown, places.ravel() + 0.5, NOTHING + 1)[seen] / pixels[seen]
        for places in (columns, rows)
    ]
    centers = 2.0 * np.stack(middles, axis=1) / len(example.shown) - 1.0
    return _labels_of(example)[seen], torch.from_numpy(centers).float()


def _label_pixels(example: StructureExample) -> Int[Tensor, "H W"]:
    assert example.shown is not None
    names = functional.pad(_labels_of(example), (0, NOTHING + 1), value=len(PART_LABELS))[: NOTHING + 1]
    return names[torch.from_numpy(example.shown.astype(np.int64))]


def _labels_of(example: StructureExample) -> Int[Tensor, "P"]:
    return part_labels(torch.from_numpy(np.array(example.field.table))[None])[0]
