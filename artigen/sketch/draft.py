"""`Draft`: a table of rows that is being written, with what the network needs to go on."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.sketch.batch import PLACES
from artigen.sketch.blocks import PictureMemory
from artigen.sketch.decoder import Decoder, Memory, Pair
from artigen.sketch.request import RequestRows
from artigen.sketch.rows import number_axis
from artigen.sketch.rules import Writer
from artigen.sketch.slots import slots


@dataclass(frozen=True, kw_only=True, eq=False)
class NamedPlanes:
    """What rows name that later numbers may refer to, as in `artigen.sketch.batch.RowBatch`."""

    low: Int[np.ndarray, "B T 4"]
    high: Int[np.ndarray, "B T 4"]
    anchor: Int[np.ndarray, "B T 4"]
    named: Bool[np.ndarray, "B T"]
    ranged: Bool[np.ndarray, "B T"]
    part: Int[np.ndarray, "B T"]
    keys: Float[np.ndarray, "B T S P"]
    """Keys of the planes."""

    def take(self, which: Sequence[int]) -> "NamedPlanes":
        """Those of some tables, in order; without a copy if these are all."""
        if len(which) == len(self.part):
            return self
        return NamedPlanes(**{name: value[which] for name, value in vars(self).items()})

    def join(self, after: "NamedPlanes") -> "NamedPlanes":
        """These, then those of further rows."""
        pairs = {name: (value, getattr(after, name)) for name, value in vars(self).items()}
        return NamedPlanes(**{name: np.concatenate(pair, axis=1) for name, pair in pairs.items()})


@dataclass(frozen=True, kw_only=True, eq=False)
class Draft:
    """A partially written table with the network's state."""

    writer: Writer
    state: Float[np.ndarray, "D"]
    """Network state after the last row."""
    planes: NamedPlanes
    """Those of the table's own rows, [1, T, ...]."""
    memory: Memory
    """What the next row attends to."""


def begin_draft(decoder: Decoder, request: RequestRows, picture: PictureMemory | None = None) -> Draft:
    """An empty table for a request.

    Args:
        picture: Picture memory of the object; None without a picture.
    """
    memory = decoder.begin(picture)
    own, states = begin_own(memory, 1), np.zeros((1, 0))
    for place, (row, known) in enumerate(zip(request.rows, request.known, strict=True)):
        cells = _embed_request(decoder, row, known)[None]
        at = np.array([min(place, PLACES - 1)])
        states, own = decoder.read(cells, np.array([0]), at, memory, own, requested=True)
    sides, width = decoder.keys.shape[1], decoder.own_keys.shape[1]
    table = {name: np.zeros((1, 0, 4), dtype=int) for name in ("low", "high", "anchor")}
    flags = {name: np.zeros((1, 0), dtype=bool) for name in ("named", "ranged")}
    keys = np.zeros((1, 0, sides // width, width), dtype=np.float32)
    planes = NamedPlanes(**table, **flags, part=np.zeros((1, 0), dtype=int), keys=keys)
    return Draft(
        writer=Writer(request=request), state=states[0], planes=planes, memory=extend_memory(memory, own, 0)
    )


def begin_own(memory: Memory, count: int) -> list[Pair]:
    """Keys and values of the tables' own rows before the first."""
    empty = [keys[None, :, :0].repeat(count, axis=0) for keys, _ in memory.rows]
    return list(zip(empty, empty, strict=True))


def extend_memory(memory: Memory, own: Sequence[Pair], index: int) -> Memory:
    """The memory of one table with its own rows."""
    pairs = zip(memory.rows, own, strict=True)
    return Memory(
        rows=tuple(
            (np.concatenate([old[0], new[0][index]], axis=1), np.concatenate([old[1], new[1][index]], axis=1))
            for old, new in pairs
        ),
        picture=memory.picture,
    )


def _embed_request(
    decoder: Decoder, row: Int[np.ndarray, "W"], known: Bool[np.ndarray, "W"]
) -> Float[np.ndarray, "D"]:
    """Embedding of a row of a request."""
    slot, number = slots().of_cell[row[0]], number_axis(row[None])[0] >= 0
    exists = slot >= 0
    symbols, numbers, unknown = exists & known & ~number, exists & known & number, exists & ~known
    return (
        decoder.embed_symbols(slot[symbols], row[symbols]).sum(axis=0)
        + decoder.embed_numbers(slot[numbers], row[numbers]).sum(axis=0)
        + decoder.unknown[slot[unknown]].sum(axis=0)
    )
