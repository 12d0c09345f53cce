"""Planes: coordinates named by earlier rows, which the network refers to when it writes later ones.

A number is coded as one of these planes, as a plane and an offset, or by two digits; the probabilities of the
three encodings add up (`NumberParts`).
"""

from dataclasses import dataclass
from typing import Any, Protocol

import torch
from array_api_compat import array_namespace, device
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

    axis: Int[Any, "B N"]
    """0 to 2 for coordinates, `LENGTH` for lengths."""
    low: Int[Any, "B N"]
    """The low side of the row's piece on that axis."""
    high: Int[Any, "B N"]
    has_low: Bool[Any, "B N"]
    """Whether the low side precedes the number."""
    has_high: Bool[Any, "B N"]
    starts: Bool[Any, "B N"]
    """Whether the number is that low side."""
    ends: Bool[Any, "B N"]
    """Whether the number is the high side."""
    ranges: Bool[Any, "B N"]
    """Whether the number is the range of a joint."""
    anchor: Int[Any, "B N"]
    """Lowest side of the first piece of the row's part."""
    anchored: Bool[Any, "B N"]
    """Whether that piece precedes the row."""


class NamedRows(Protocol):
    """What `name_sides` reads of rows, whose fields are those of `RowBatch`, in any array library."""

    @property
    def low(self) -> Int[Any, "B T 4"]: ...
    @property
    def high(self) -> Int[Any, "B T 4"]: ...
    @property
    def anchor(self) -> Int[Any, "B T 4"]: ...
    @property
    def named(self) -> Bool[Any, "B T"]: ...
    @property
    def ranged(self) -> Bool[Any, "B T"]: ...
    @property
    def part(self) -> Int[Any, "B T"]: ...


@dataclass(frozen=True, kw_only=True, eq=False)
class Sides:
    """Planes that rows name on each axis, the last of which is that of lengths."""

    values: Int[Any, "B 4 T S"]
    """Coordinates; those of sides 4 and 7 are relative to the current row and part."""
    free: Bool[Any, "B 4 T S"]
    """Whether the row names this plane."""


def name_sides(rows: NamedRows) -> Sides:
    """The `SIDES` that each row names, as arrays of the same library."""
    xp = array_namespace(rows.low)
    low, high = rows.low, rows.high
    step = 2 * low - xp.roll(low, 1, axis=1)
    values = [low, high, -low, -high, high - low, (low + high) // 2, step, low - rows.anchor]
    follows = rows.named & xp.roll(rows.named, 1, axis=1) & (rows.part == xp.roll(rows.part, 1, axis=1))
    placed, never = rows.named & (rows.part > 0), xp.zeros_like(rows.named)
    free = []
    for axis in range(LENGTH):
        mirrored = rows.named if axis == MIRROR_AXIS else never
        free.append([rows.named, rows.named, mirrored, mirrored, rows.named, rows.named, follows, placed])
    free.append([rows.ranged, *[never] * (SIDES - 1)])
    stacked = xp.stack([xp.stack(sides, axis=-1) for sides in free], axis=1)
    return Sides(values=xp.permute_dims(xp.stack(values, axis=-1), (0, 2, 1, 3)), free=stacked)


def list_planes(
    sides: Sides, places: Places, earlier: Bool[Any, "#B #N T"]
) -> tuple[Int[Any, "B N C"], Bool[Any, "B N C"]]:
    """Coordinates of the planes that each number may refer to, and a mask of those that are available.

    Args:
        earlier: Rows that precede each number's own.
    """
    xp = array_namespace(places.axis)
    axis = places.axis
    objects = xp.arange(axis.shape[0], device=device(axis))[:, None]
    coordinate = axis < LENGTH
    nothing, always = xp.zeros_like(axis), xp.ones_like(coordinate)
    shift = [nothing, nothing, nothing, nothing, places.low, nothing, nothing, places.anchor]
    may = [always] * SIDES
    may[0], may[4], may[6], may[7] = coordinate | places.ranges, places.ends, places.starts, places.anchored
    values = sides.values[objects, axis] + xp.stack(shift, axis=-1)[:, :, None]
    free = sides.free[objects, axis] & xp.stack(may, axis=-1)[:, :, None] & earlier[..., None]
    own = xp.stack([places.low, places.high], axis=-1)
    has = xp.stack([places.has_low, places.has_high], axis=-1) & coordinate[..., None]
    shape = (*axis.shape, -1)
    return (
        xp.concat([xp.reshape(values, shape), own], axis=-1),
        xp.concat([xp.reshape(free, shape), has], axis=-1),
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
