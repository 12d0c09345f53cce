"""Batches of rows and requests for the network."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Int
from torch import Tensor

from artigen.models.batch import TensorBatch
from artigen.sketch.piece import PIECE_KINDS
from artigen.sketch.request import RequestRows
from artigen.sketch.rows import FIELDS, ROW_KINDS, WIDTH, column, find_predicted, number_axis
from artigen.sketch.sketch import lowest_corner
from artigen.types import JOINT_TYPES

PARTS, PLACES = 64, 32
"""Number of embeddings for parts and for positions within a part; larger indices share the last one."""
_PIECES = [ROW_KINDS.index(kind) for kind in PIECE_KINDS]
_FIRST = np.array([column(kind, "x0") if kind in PIECE_KINDS else 0 for kind in ROW_KINDS])
_OBJECT, _PART, _JOINT = (ROW_KINDS.index(kind) for kind in ("object", "part", "joint"))


@dataclass(frozen=True, kw_only=True, eq=False)
class RowBatch(TensorBatch):
    """Rows of several objects, padded on the right; the rows of the request come first.

    ``known`` marks given cells (only requests have unknown ones), ``predicted`` those that the network
    predicts, ``requested`` the rows of the request. ``axes`` follow `artigen.sketch.rows.number_axis`.
    ``part`` and ``piece`` number the parts, and the rows within a part, up to each row.
    """

    rows: Int[Tensor, "B T W"]
    known: Bool[Tensor, "B T W"]
    predicted: Bool[Tensor, "B T W"]
    axes: Int[Tensor, "B T W"]
    requested: Bool[Tensor, "B T"]
    part: Int[Tensor, "B T"]
    piece: Int[Tensor, "B T"]
    low: Int[Tensor, "B T 4"]
    """Lowest corner of the row's solid; the last column is the range of a joint, which later joints may
    repeat."""
    high: Int[Tensor, "B T 4"]
    named: Bool[Tensor, "B T"]
    """Whether the row names planes."""
    ranged: Bool[Tensor, "B T"]
    """Whether the row names the range of a joint."""
    anchor: Int[Tensor, "B T 4"]
    """Lowest corner of the first piece of the row's part."""
    anchored: Bool[Tensor, "B T"]
    """Whether that piece comes before the row."""


def make_batch(tables: Sequence[Int[np.ndarray, "T W"]], requests: Sequence[RequestRows]) -> RowBatch:
    """Prepends its request to each object and pads to the longest."""
    pairs = list(zip(requests, tables, strict=True))
    longest = max(len(request.rows) + len(rows) for request, rows in pairs)
    shape = (len(pairs), longest)
    rows = np.full((*shape, WIDTH), 0)
    rows[:, :, 0] = ROW_KINDS.index("end")
    known, predicted = np.ones((*shape, WIDTH), dtype=bool), np.zeros((*shape, WIDTH), dtype=bool)
    request_rows, own = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    for index, (request, table) in enumerate(pairs):
        start, end = len(request.rows), len(request.rows) + len(table)
        rows[index, :start], rows[index, start:end] = request.rows, table
        known[index, :start] = request.known
        request_rows[index, :start], own[index, start:end] = True, True
    predicted[own] = find_predicted(rows[own])
    flat = rows.reshape(-1, WIDTH)
    part, piece = number_rows(rows, request_rows)
    planes = row_planes(flat)
    low, high = planes.low.reshape(*shape, 4), planes.high.reshape(*shape, 4)
    anchor, anchored = find_anchors(low, part)
    return RowBatch(
        rows=torch.from_numpy(rows),
        known=torch.from_numpy(known),
        predicted=torch.from_numpy(predicted),
        axes=torch.from_numpy(number_axis(flat).reshape(rows.shape)),
        requested=torch.from_numpy(request_rows),
        part=torch.from_numpy(part),
        piece=torch.from_numpy(piece),
        low=torch.from_numpy(low),
        high=torch.from_numpy(high),
        named=torch.from_numpy(planes.named.reshape(shape) & ~request_rows),
        ranged=torch.from_numpy(planes.ranged.reshape(shape)),
        anchor=torch.from_numpy(anchor),
        anchored=torch.from_numpy(anchored),
    )


def number_rows(
    rows: Int[np.ndarray, "B T W"], requested: Bool[np.ndarray, "B T"]
) -> tuple[Int[np.ndarray, "B T"], Int[np.ndarray, "B T"]]:
    """Part index of each row, from 1 (0 before the first part), and its position within the part, both
    clipped to the `PARTS` and `PLACES` that the network distinguishes."""
    starts = (rows[:, :, 0] == _PART) & ~requested
    part = np.minimum(np.cumsum(starts, axis=1), PARTS - 1)
    at = np.arange(rows.shape[1])[None]
    last = np.maximum.accumulate(np.where(starts, at, 0), axis=1)
    return part, np.minimum(at - last, PLACES - 1)


def find_anchors(
    low: Int[np.ndarray, "B T 4"], part: Int[np.ndarray, "B T"]
) -> tuple[Int[np.ndarray, "B T 4"], Bool[np.ndarray, "B T"]]:
    """Lowest corner of the first piece of each row's part, and whether that piece precedes the row."""
    at = np.arange(part.shape[1])[None]
    begins = np.diff(part, axis=1, prepend=0) > 0
    first = np.maximum.accumulate(np.where(begins, at, 0), axis=1) + 1  # the row after the part row
    anchored = (part > 0) & (at > first)
    anchor = np.take_along_axis(low, np.minimum(first, part.shape[1] - 1)[..., None], axis=1)
    return np.where(anchored[..., None] | (at == first)[..., None], anchor, 0), anchored


@dataclass(frozen=True, kw_only=True, eq=False)
class Planes:
    """Planes named by rows: corners, with the range of joints in the last column."""

    low: Int[np.ndarray, "N 4"]
    high: Int[np.ndarray, "N 4"]
    named: Bool[np.ndarray, "N"]
    """Rows that have corners."""
    ranged: Bool[np.ndarray, "N"]
    """Joints that have a range."""


def row_planes(rows: Int[np.ndarray, "N W"]) -> Planes:
    """The planes that each row names."""
    kind = rows[:, 0]
    piece = np.isin(kind, _PIECES)
    first = _FIRST[kind]
    at = np.where(piece[:, None], first[:, None] + np.arange(6), 0)
    corners = np.where(piece[:, None], np.take_along_axis(rows, at, axis=1), 0)
    low, high = np.zeros((len(rows), 4), dtype=int), np.zeros((len(rows), 4), dtype=int)
    low[:, :3], high[:, :3] = corners[:, :3], corners[:, 3:]
    whole = kind == _OBJECT
    extents = rows[whole, column("object", "depth") : column("object", "depth") + 3]
    low[whole, :3] = lowest_corner(extents)
    high[whole, :3] = low[whole, :3] + extents
    moving = (kind == _JOINT) & (rows[:, column("joint", "type")] > 0)
    turning = moving & (rows[:, column("joint", "type")] != JOINT_TYPES.index("prismatic"))
    origin = rows[turning, column("joint", "x") : column("joint", "x") + 3]
    low[turning, :3], high[turning, :3] = origin, origin
    reach = rows[:, column("joint", "upper")]
    ranged = moving & (reach > 0)
    low[ranged, 3] = high[ranged, 3] = reach[ranged]
    return Planes(low=low, high=high, named=piece | whole | turning, ranged=ranged)


def sample_request(rows: Int[np.ndarray, "T W"], rng: np.random.Generator) -> RequestRows:
    """Samples a request that the object satisfies; the number of specified fields is random."""
    finishes = rows[rows[:, 0] == ROW_KINDS.index("finish")]
    if rng.random() < 0.5:
        finishes = finishes[:0]
    finishes = finishes[rng.random(len(finishes)) < 0.5]
    table = np.concatenate([rows[:1], finishes])
    known = np.zeros(table.shape, dtype=bool)
    known[:, 0] = True
    names = [field.name for field in FIELDS["object"]]
    known[0, 1] = rng.random() < 0.9
    known[0, 2] = rng.random() < 0.15
    known[0, 3 : len(names) - 2] = _some(rng, len(names) - 5)
    known[0, len(names) - 2 : len(names) + 1] = _some(rng, 3)
    if len(finishes):
        known[1:, column("finish", "role")] = True
        known[1:, column("finish", "material")] = rng.random(len(finishes)) < 0.5
        first = column("finish", "r")
        known[1:, first : first + 3] = (rng.random(len(finishes)) < 0.8)[:, None]
        table = table.copy()
        noise = rng.integers(-2, 3, (len(finishes), 3))
        table[1:, first : first + 3] = np.clip(table[1:, first : first + 3] + noise, 0, 63)
    return RequestRows(rows=table, known=known)


def _some(rng: np.random.Generator, count: int) -> Bool[np.ndarray, "N"]:
    """Random mask that is empty, full or partial."""
    share = rng.choice([0.0, 0.5, 1.0], p=[0.3, 0.3, 0.4])
    return rng.random(count) < share
