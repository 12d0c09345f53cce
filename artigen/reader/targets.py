"""Marks of a training picture as targets of the network."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor

from artigen.models.batch import TensorBatch
from artigen.reader.labels import THINGS, UNKNOWN
from artigen.reader.network import STRIDE

MARK = np.dtype(
    [
        ("thing", np.int8),
        ("box", np.float32, (4,)),
        ("sized", np.int8),
        ("corners", np.float32, (4, 2)),
        ("door", np.int8),
        ("hinge", np.int8),
        ("open", np.int8),
        ("pane", np.int8),
        ("material", np.int8),
        ("kind", np.int16),
        ("stand", np.int8),
        ("view", np.float32, (3,)),
        ("size", np.float32, (3,)),
    ]
)
"""A thing in a picture: its box (left, top, right, bottom; pixels), whether that is the whole of it (1) or
only where its middle is (0), corners of a front (pixels, from the upper left clockwise), and what is known of
it. Attributes that are not known are -1, numbers NaN."""
SPREAD, LEAST_SPREAD = 0.1, 0.65
"""Standard deviation of a peak as a share of its box, and the least one in cells."""
CORE = 0.5
"""Height of a peak from which a cell learns box and attributes, and counts fully whatever its weight."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    """A training picture with its marks."""

    pixels: UInt8[np.ndarray, "S S 3"]
    marks: np.ndarray
    """Rows of `MARK`."""
    weight: Float[np.ndarray, "T h w"]
    """Weight of each cell without a peak, by thing: 1 where nothing is known to be, 0 where something may
    be."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ReaderBatch(TensorBatch):
    """Training pictures with their targets."""

    pixels: Tensor
    """uint8, [B, 3, S, S]."""
    heat: Float[Tensor, "B T h w"]
    weight: Float[Tensor, "B T h w"]
    place: Int[Tensor, "N 4"]
    """Picture, thing, row and column of cells that learn a box."""
    box: Float[Tensor, "N 4"]
    """Distances from the cell's middle to left, top, right and bottom (pixels); NaN where unknown."""
    corners: Float[Tensor, "N 8"]
    """Corners as shares of the box; NaN where unknown."""
    door: Int[Tensor, "N"]
    hinge: Int[Tensor, "N"]
    open: Int[Tensor, "N"]
    pane: Int[Tensor, "N"]
    material: Int[Tensor, "N"]
    kind: Int[Tensor, "N"]
    stand: Int[Tensor, "N"]
    view: Float[Tensor, "N 3"]
    size: Float[Tensor, "N 3"]
    """Logarithms of width, depth and height (m)."""


def make_mark(thing: int, box: np.ndarray, **known: object) -> np.ndarray:
    """A row of `MARK` of which only some is known."""
    row = np.zeros((), MARK)
    for name in MARK.names or ():
        row[name] = np.nan if np.issubdtype(MARK[name].base, np.floating) else UNKNOWN
    row["thing"], row["box"], row["sized"] = thing, box, 1
    for name, value in known.items():
        row[name] = value
    return row


def make_targets(
    marks: np.ndarray, size: int
) -> tuple[Float[np.ndarray, "T h w"], Int[np.ndarray, "N 4"], Int[np.ndarray, "N"]]:
    """Peaks of the marks of a picture of ``size`` pixels, and the cells that learn from them.

    Returns:
        Height of the peaks; thing, row and column of cells (the first column is zero); and the mark of each.
    """
    edge = size // STRIDE
    middles = (np.arange(edge) + 0.5) * STRIDE
    heat = np.zeros((len(THINGS), edge, edge), np.float32)
    best = np.zeros_like(heat)
    owner = np.full(heat.shape, -1, np.int32)
    for number, mark in enumerate(marks):
        thing, (x0, y0, x1, y1) = int(mark["thing"]), mark["box"]
        column = int(np.clip((x0 + x1) / 2 / STRIDE, 0, edge - 1))
        row = int(np.clip((y0 + y1) / 2 / STRIDE, 0, edge - 1))
        wide, high = (max(SPREAD * extent, LEAST_SPREAD * STRIDE) for extent in (x1 - x0, y1 - y0))
        across = np.exp(-0.5 * ((middles - middles[column]) / wide) ** 2)
        along = np.exp(-0.5 * ((middles - middles[row]) / high) ** 2)
        peak = (along[:, None] * across).astype(np.float32)
        heat[thing] = np.maximum(heat[thing], peak)
        own = (peak > CORE) & (peak > best[thing])
        best[thing] = np.where(own, peak, best[thing])
        owner[thing] = np.where(own, number, owner[thing])
    thing, row, column = np.nonzero(owner >= 0)
    place = np.stack([np.zeros_like(thing), thing, row, column], axis=1)
    return heat, place, owner[thing, row, column]


def make_batch(pictures: Sequence[Picture]) -> ReaderBatch:
    """Targets of pictures of one size."""
    size = pictures[0].pixels.shape[0]
    heats, places, marks = [], [], []
    for number, picture in enumerate(pictures):
        heat, place, owner = make_targets(picture.marks, size)
        place[:, 0] = number
        heats.append(heat)
        places.append(place)
        marks.append(picture.marks[owner])
    place, known = np.concatenate(places), np.concatenate(marks)
    x, y = (place[:, 3] + 0.5) * STRIDE, (place[:, 2] + 0.5) * STRIDE
    x0, y0, x1, y1 = known["box"].T
    box = np.stack([x - x0, y - y0, x1 - x, y1 - y], axis=1)
    box[known["sized"] == 0] = np.nan
    extent = np.stack([x1 - x0, y1 - y0], axis=1)[:, None]
    corners = (known["corners"] - known["box"][:, None, :2]) / np.maximum(extent, 1.0)

    def as_tensor(values: np.ndarray) -> Tensor:
        return torch.from_numpy(np.ascontiguousarray(values, dtype=np.float32))

    def index(name: str) -> Tensor:
        return torch.from_numpy(known[name].astype(np.int64))

    return ReaderBatch(
        pixels=torch.from_numpy(np.stack([p.pixels for p in pictures])).permute(0, 3, 1, 2),
        heat=torch.from_numpy(np.stack(heats)),
        weight=as_tensor(np.stack([p.weight for p in pictures])),
        place=torch.from_numpy(place.astype(np.int64)),
        box=as_tensor(box),
        corners=as_tensor(corners.reshape(-1, 8)),
        **{name: index(name) for name in ("door", "hinge", "open", "pane", "material", "kind", "stand")},
        view=as_tensor(known["view"]),
        size=as_tensor(np.log(known["size"])),
    )
