"""Losses of the sketch network: the likelihood of tables, and auxiliary losses of the image encoder."""

from dataclasses import replace

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn
from torch.nn import functional

from artigen.examples.sketch import SketchBatch
from artigen.examples.sketch_photos import EDGE, PhotoBatch, vary_photos
from artigen.sketch.batch import RowBatch
from artigen.sketch.blocks import PictureMemory
from artigen.sketch.network import SketchNetwork
from artigen.sketch.picture import MAX_COUNT, PicturePrediction
from artigen.sketch.rows import COUNTED, ROW_KINDS, column
from artigen.types import PART_LABELS

READING = 0.3
"""Weight of the auxiliary losses of the picture encoder, relative to the likelihood of tables."""
HEADER = 10.0
"""Weight of the fields of a header where there is a picture: they are few among hundreds, and the picture
determines them."""


class SketchLosses(nn.Module):
    """The losses of a sketch network as a module: likelihood, and auxiliary losses of the picture encoder."""

    def __init__(self, network: SketchNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(self, batch: SketchBatch) -> dict[str, Tensor]:
        """Negative log-likelihoods of symbols and numbers (nats), and the auxiliary terms, by name."""
        if batch.photos is None:
            return self.rate_rows(batch.rows)
        seen, memory = self.network.encode_pictures(batch.photos.image)
        terms = reading_losses(seen, batch.photos) | guessing_losses(seen, batch.rows)
        return terms | self.rate_rows(batch.rows, memory)

    def rate_rows(self, rows: RowBatch, memory: PictureMemory | None = None) -> dict[str, Tensor]:
        """Negative log-likelihoods (nats) per predicted field."""
        symbols, numbers = self.network(rows, memory)
        count = len(symbols) + len(numbers)
        if memory is not None:
            for_symbols, for_numbers = weigh_fields(rows)
            symbols, numbers = symbols * for_symbols, numbers * for_numbers
        return {"symbols": symbols.sum() / count, "numbers": numbers.sum() / count}


def weigh_fields(rows: RowBatch) -> tuple[Float[Tensor, "M"], Float[Tensor, "N"]]:
    """Weights of the symbols and of the numbers of a batch, in the order of their likelihoods."""
    weights = torch.where(find_headers(rows), HEADER, 1.0)[..., None].expand(rows.predicted.shape)
    return weights[rows.predicted & (rows.axes < 0)], weights[rows.predicted & (rows.axes >= 0)]


def sketch_losses(
    network: nn.Module, batch: SketchBatch, generator: torch.Generator, edge: int = EDGE
) -> dict[str, Tensor]:
    """Loss terms of a batch, after augmentation of its pictures to ``edge`` pixels."""
    return network(vary_batch(batch, generator, edge))


def vary_batch(batch: SketchBatch, generator: torch.Generator, edge: int) -> SketchBatch:
    """A batch with its pictures, if it has any, augmented to ``edge`` pixels."""
    if batch.photos is None:
        return batch
    return replace(batch, photos=vary_photos(batch.photos, generator, edge))


def reading_losses(seen: PicturePrediction, photos: PhotoBatch) -> dict[str, Tensor]:
    """Losses of the encoder's picture readings, each with its weight.

    The map of parts is the rate of a Poisson process: unlike a squared error, its likelihood penalises
    predictions of zero where parts are few.
    """
    truth = spread_spots(photos, seen.density.shape[-1])
    off = seen.density.sum(dim=(2, 3)) - truth.sum(dim=(2, 3))
    size = seen.labels.shape[-2:]
    labels = functional.interpolate(photos.labels[:, None].float(), size, mode="nearest-exact")[:, 0].long()
    poisson = seen.density - truth * seen.density.clamp(min=1e-6).log()
    return {
        "parts": READING * 0.3 * poisson.sum(dim=(2, 3)).mean(),
        "in view": READING * 0.1 * off.abs().mean(),
        "labels": READING * 0.5 * functional.cross_entropy(seen.labels, labels),
        "view": READING * 2.0 * functional.mse_loss(seen.view, photos.view),
    }


def guessing_losses(seen: PicturePrediction, rows: RowBatch) -> dict[str, Tensor]:
    """Losses of the encoder's header predictions, each with its weight."""
    header = rows.rows[find_headers(rows)]
    first = column("object", COUNTED[0])
    counts = functional.pad(header[:, first : first + len(COUNTED)], (1, 0), value=1)  # one base
    category = header[:, column("object", "category")]
    wrong = functional.cross_entropy(seen.counts.flatten(0, 1), counts.clamp(max=MAX_COUNT).flatten())
    return {
        "counts": READING * wrong,
        "category": READING * 0.3 * functional.cross_entropy(seen.category, category),
    }


def find_headers(rows: RowBatch) -> Bool[Tensor, "B T"]:
    """Mask of the rows with category, counts and extents of each object; those of requests are left out."""
    return (rows.rows[..., 0] == ROW_KINDS.index("object")) & ~rows.requested


def spread_spots(photos: PhotoBatch, edge: int) -> Float[Tensor, "B L h w"]:
    """Density of parts of each label per cell: a bump of sum 1 around the middle of every part in view."""
    places = torch.arange(edge, device=photos.centers.device) + 0.5
    at = (photos.centers + 1.0) * (edge / 2)
    bumps = torch.exp(-0.5 * (places - at[..., None]) ** 2)
    inside = (photos.given & (at >= 0).all(dim=-1) & (at <= edge).all(dim=-1))[..., None]
    across, down = (bumps / bumps.sum(dim=-1, keepdim=True).clamp(min=1e-6)).unbind(dim=2)
    kinds = functional.one_hot(photos.kinds, len(PART_LABELS)) * inside
    return torch.einsum("bnl,bnh,bnw->blhw", kinds.to(down.dtype), down, across)
