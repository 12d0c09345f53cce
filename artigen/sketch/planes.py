"""Planes: coordinates named by earlier rows, which the network refers to when it writes later ones.

A number is coded as one of these planes, as a plane and an offset, or by two digits; the probabilities of the
three encodings add up (`NumberParts`).
"""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from artigen.sketch.batch import RowBatch
from artigen.sketch.rows import LENGTH, REACH, ROW_KINDS, WIDTH, column

OFFSET = 96
"""Largest distance (steps) from a known plane at which a coordinate may be coded as an offset."""
FINE = 32
"""Values of the fine digit of a number."""
COARSE = 2 * REACH // FINE
SIDES = 8
"""Planes that a row names on each axis.

In this order: its low side; its high side; both mirrored at the middle plane of the object; the current low
side plus the row's size; its middle; its low side advanced by the step from the row before it; and its low
side moved from its part into the current part.
"""
OWN = 2
"""Planes that the current row has named itself: its low and its high side."""
MIRROR_AXIS = 1
FAR = -1e9
"""Log probability of impossible choices."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NumberParts:
    """Log probabilities of the three encodings, of planes for the first two, of offsets and of coarse
    digits."""

    ways: Float[Tensor, "B N 3"]
    same: Float[Tensor, "B N C"]
    near: Float[Tensor, "B N C"]
    offset: Float[Tensor, "B N O"]
    coarse: Float[Tensor, "B N K"]

    def score(
        self,
        target: Int[Tensor, "B N"],
        planes: Int[Tensor, "B N C"],
        coarse: Int[Tensor, "B N"],
        fine: Float[Tensor, "B N"],
    ) -> Float[Tensor, "B N"]:
        """Log likelihood of values, summed over all encodings."""
        apart = target[..., None] - planes
        same = self.same.masked_fill(apart != 0, FAR).logsumexp(dim=-1)
        inside = apart.abs() <= OFFSET
        offset = self.offset.gather(-1, (apart + OFFSET).clamp(0, 2 * OFFSET))
        near = (self.near + offset).masked_fill(~inside, FAR).logsumexp(dim=-1)
        anew = self.coarse.gather(-1, coarse[..., None])[..., 0] + fine
        return (self.ways + torch.stack([same, near, anew], dim=-1)).logsumexp(dim=-1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Places:
    """Positions of numbers in their rows, and the earlier numbers of those rows."""

    axis: Int[Tensor, "B N"]
    """0 to 2 for coordinates, `LENGTH` for lengths."""
    low: Int[Tensor, "B N"]
    """The low side of the row's piece on that axis."""
    high: Int[Tensor, "B N"]
    has_low: Bool[Tensor, "B N"]
    """Whether the low side precedes the number."""
    has_high: Bool[Tensor, "B N"]
    starts: Bool[Tensor, "B N"]
    """Whether the number is that low side."""
    ends: Bool[Tensor, "B N"]
    """Whether the number is the high side."""
    ranges: Bool[Tensor, "B N"]
    """Whether the number is the range of a joint."""
    anchor: Int[Tensor, "B N"]
    """Lowest side of the first piece of the row's part."""
    anchored: Bool[Tensor, "B N"]
    """Whether that piece precedes the row."""


def list_planes(
    batch: RowBatch, places: Places, earlier: Bool[Tensor, "#B #N T"]
) -> tuple[Int[Tensor, "B N C"], Bool[Tensor, "B N C"]]:
    """Coordinates of the planes that each number may refer to, and a mask of those that are available.

    Args:
        batch: The rows that may have named planes.
        places: Positions of the numbers.
        earlier: Rows that precede each number's own.
    """
    axis = places.axis
    low, high, anchor = (
        values.gather(2, axis[:, None, :].expand(-1, values.shape[1], -1)).transpose(1, 2)
        for values in (batch.low, batch.high, batch.anchor)
    )
    step = 2 * low - low.roll(1, dims=2)
    planes = [low, high, -low, -high, places.low[..., None] + high - low]
    planes += [(low + high).div(2, rounding_mode="floor"), step, places.anchor[..., None] + low - anchor]
    ranged = earlier & batch.ranged[:, None, :] & places.ranges[..., None]
    coordinate = (axis < LENGTH)[..., None]
    named = earlier & batch.named[:, None, :] & coordinate
    mirrored = named & (axis == MIRROR_AXIS)[..., None]
    follows = batch.named & batch.named.roll(1, dims=1) & (batch.part == batch.part.roll(1, dims=1))
    again = named & follows[:, None, :] & places.starts[..., None]
    placed = named & (batch.part > 0)[:, None, :] & places.anchored[..., None]
    free = [named | ranged, named, mirrored, mirrored, named & places.ends[..., None], named, again, placed]
    own = torch.stack([places.low, places.high], dim=-1)
    has = torch.stack([places.has_low, places.has_high], dim=-1) & coordinate
    return (
        torch.cat([torch.stack(planes, dim=-1).flatten(2), own], dim=-1),
        torch.cat([torch.stack(free, dim=-1).flatten(2), has], dim=-1),
    )


def find_places(
    batch: RowBatch, b: Int[Tensor, "B N"], t: Int[Tensor, "B N"], c: Int[Tensor, "B N"]
) -> Places:
    """Positions of numbers in object ``b``, row ``t`` and column ``c``.

    The six columns from the first number of a piece on hold its low and its high corner.
    """
    axes = batch.axes[b, t]
    axis = batch.axes[b, t, c].clamp(min=0)
    first = (axes >= 0).int().argmax(dim=-1)
    piece = axes.gather(-1, (first + 5).clamp(max=WIDTH - 1)[..., None])[..., 0] >= 0
    piece &= axes.gather(-1, first[..., None])[..., 0] < LENGTH
    low, high, anchor = (
        values[b, t].gather(-1, axis[..., None])[..., 0] for values in (batch.low, batch.high, batch.anchor)
    )
    return Places(
        axis=axis,
        low=low,
        high=high,
        has_low=piece & (c > first + axis),
        has_high=piece & (c > first + 3 + axis),
        starts=piece & (c == first + axis),
        ends=piece & (c == first + 3 + axis),
        ranges=(batch.rows[b, t, 0] == ROW_KINDS.index("joint")) & (c == column("joint", "upper")),
        anchor=anchor,
        anchored=batch.anchored[b, t],
    )


def gather_numbers(predicted: Bool[Tensor, "B T W"]) -> tuple[Int[Tensor, "B N 2"], Bool[Tensor, "B N"]]:
    """Row and column of each object's predicted numbers, padded, and a mask of the entries that are not
    padding."""
    counts = predicted.flatten(1).sum(dim=1)
    order = predicted.flatten(1).int().argsort(dim=1, descending=True, stable=True)[:, : int(counts.max())]
    given = torch.arange(order.shape[1], device=predicted.device) < counts[:, None]
    order = torch.where(given, order, 0)
    return torch.stack([order // predicted.shape[2], order % predicted.shape[2]], dim=-1), given
