"""`draw_tables`: several tables of rows side by side, drawn from the network within the rules."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor
from torch.nn import functional as F

from artigen.sketch.batch import Asked, make_batch, row_planes
from artigen.sketch.network import (
    COARSE,
    FINE,
    MIRROR_AXIS,
    OFFSET,
    NumberParts,
    RowBatch,
    SketchNetwork,
    _Cache,
    slots,
)
from artigen.sketch.rows import LENGTH, PIECE_KINDS, REACH, ROW_KINDS, column
from artigen.sketch.rules import MAX_ROWS, Writer

DIGITS = 24
"""Coarse digits that a number said anew may have: the likeliest within its span."""


@dataclass(frozen=True, kw_only=True)
class DrawConfig:
    """How tables are drawn."""

    temperature: float = 0.8
    """Below 1 the likely becomes likelier."""
    top_p: float = 0.98
    """Share of chance that is drawn from; the unlikeliest rest is left out."""


@torch.no_grad()
def draw_tables(
    network: SketchNetwork,
    requests: Sequence[Asked],
    generator: torch.Generator,
    cfg: DrawConfig | None = None,
    *,
    rows: int = MAX_ROWS,
) -> list[Int[np.ndarray, "T W"] | None]:
    """Draws one table for every request; None where it grew too long.

    Args:
        network: trained.
        requests: all of as many rows.
        generator: of all chance.
        cfg: temperature.
        rows: after so many, tables are returned as they are; by default those that do not end are given up.

    Raises:
        ValueError: If requests differ in their number of rows.
    """
    cfg = cfg or DrawConfig()
    if len({len(asked.rows) for asked in requests}) != 1:
        raise ValueError(f"requests of {sorted({len(a.rows) for a in requests})} rows, expected all alike")
    pen = _Pen(network, requests, generator, cfg)
    while pen.writers and len(pen.writers[0].rows) < rows:
        pen.write_row()
    if rows < MAX_ROWS:
        return [*(np.array(writer.rows) for writer in pen.writers)]
    return pen.tables


class _Pen:
    """The network with what it has read so far, and the tables that it writes."""

    def __init__(
        self,
        network: SketchNetwork,
        requests: Sequence[Asked],
        generator: torch.Generator,
        cfg: DrawConfig,
    ) -> None:
        self.network, self.generator, self.cfg = network, generator, cfg
        self.tables: list[np.ndarray | None] = [None] * len(requests)
        self.writers = [Writer(asked=asked) for asked in requests]
        self.index = list(range(len(requests)))
        self.cache = [_Cache() for _ in network.blocks]
        empty = np.zeros((0, requests[0].rows.shape[1]), dtype=int)
        batch = make_batch([empty] * len(requests), requests)
        states = network.read_rows(
            network.embed_cells(batch.rows, batch.known, batch.axes), batch, self.cache
        )
        self.state = states[:, -1]
        count = len(requests)
        self.keys = torch.zeros(count, 0, network.cfg.pointer * 5)
        self.low = torch.zeros(count, 0, 3, dtype=torch.long)
        self.high = torch.zeros(count, 0, 3, dtype=torch.long)
        self.named = torch.zeros(count, 0, dtype=torch.bool)

    def write_row(self) -> None:
        """Writes one row of every table, reads it, and takes leave of tables that are done."""
        network = self.network
        before = torch.zeros_like(self.state)
        while True:
            open_rows = [k for k, writer in enumerate(self.writers) if not writer.complete()]
            if not open_rows:
                break
            self._write_fields(open_rows, before)
        rows = np.array([writer.close() for writer in self.writers])
        part, piece = self._places()
        low, high, named = row_planes(rows)
        batch = RowBatch(
            rows=torch.from_numpy(rows)[:, None],
            known=torch.ones(rows.shape, dtype=torch.bool)[:, None],
            said=torch.zeros(rows.shape, dtype=torch.bool)[:, None],
            axes=torch.full(rows.shape, -1)[:, None],
            asked=torch.zeros(len(rows), 1, dtype=torch.bool),
            part=part[:, None],
            piece=piece[:, None],
            low=torch.from_numpy(low)[:, None],
            high=torch.from_numpy(high)[:, None],
            named=torch.from_numpy(named)[:, None],
        )
        # The sum of the cells is what was gathered field by field.
        self.state = network.read_rows(before[:, None, None], batch, self.cache)[:, -1]
        self.low, self.high = torch.cat([self.low, batch.low], 1), torch.cat([self.high, batch.high], 1)
        self.named = torch.cat([self.named, batch.named], 1)
        self.keys = torch.cat([self.keys, network.keys(self.state)[:, None]], 1)
        self._drop_finished()

    def _places(self) -> tuple[Int[Tensor, "B"], Int[Tensor, "B"]]:
        """Number of the part, and of the row within it, of the rows just closed."""
        part_kind = ROW_KINDS.index("part")
        places = []
        for writer in self.writers:
            starts = [at for at, row in enumerate(writer.rows) if row[0] == part_kind]
            last = starts[-1] if starts else -len(writer.asked.rows)
            places.append((min(len(starts), 63), min(len(writer.rows) - 1 - last, 31)))
        table = torch.tensor(places)
        return table[:, 0], table[:, 1]

    def _drop_finished(self) -> None:
        going = [k for k, writer in enumerate(self.writers) if not (writer.done or writer.stuck)]
        for k, writer in enumerate(self.writers):
            if writer.done:
                self.tables[self.index[k]] = np.array(writer.rows)
        if len(going) == len(self.writers):
            return
        self.writers = [self.writers[k] for k in going]
        self.index = [self.index[k] for k in going]
        self.state, self.keys, self.named = self.state[going], self.keys[going], self.named[going]
        self.low, self.high = self.low[going], self.high[going]
        for cache in self.cache:
            assert cache.keys is not None and cache.values is not None
            cache.keys, cache.values = cache.keys[going], cache.values[going]

    def _write_fields(self, some: list[int], before: Float[Tensor, "B D"]) -> None:
        """The next field of every row that is not complete; ``before`` gathers what is said."""
        table = slots()
        slot = np.array(
            [
                0
                if not self.writers[k].row
                else table.of_cell[self.writers[k].row[0], len(self.writers[k].row)]
                for k in some
            ]
        )
        implied = {k: self.writers[k].follows() for k in some if self.writers[k].row}
        free = [at for at, k in enumerate(some) if implied.get(k) is None]
        symbols = [at for at in free if table.size[slot[at]]]
        numbers = [at for at in free if not table.size[slot[at]]]
        values = [implied.get(k) or 0 for k in some]
        for rows, draw in ((symbols, self._draw_symbols), (numbers, self._draw_numbers)):
            if rows:
                which = [some[at] for at in rows]
                where = torch.from_numpy(slot[rows])
                x = self.network.think(self.state[which], before[which], where)
                for at, value in zip(rows, draw(which, x, where), strict=True):
                    values[at] = value
        number = torch.tensor([not table.size[s] for s in slot])
        before[some] += self.network.embed_values(torch.from_numpy(slot), torch.tensor(values), number)
        for k, value in zip(some, values, strict=True):
            self.writers[k].put(value)

    def _draw_symbols(self, which: list[int], x: Float[Tensor, "N D"], slot: Int[Tensor, "N"]) -> list[int]:
        logits = self.network.symbol_logits(x, slot)
        table = slots()
        base = torch.from_numpy(table.base)[slot]
        can = torch.zeros_like(logits, dtype=torch.bool)
        for at, k in enumerate(which):
            allowed = self.writers[k].allowed(int(table.size[slot[at]]))
            can[at, base[at] : base[at] + len(allowed)] = torch.from_numpy(allowed)
        chances = logits.masked_fill(~can, float("-inf")).softmax(dim=-1)
        return (self._draw(chances) - base).tolist()

    def _draw_numbers(self, which: list[int], x: Float[Tensor, "N D"], slot: Int[Tensor, "N"]) -> list[int]:
        writers = [self.writers[k] for k in which]
        axes = torch.tensor([writer.axis() for writer in writers])
        spans = torch.tensor([writer.span() for writer in writers])
        planes, free = self._planes(which, axes)
        own = self.network.own_keys.expand(len(which), -1, -1)
        keys = torch.cat([self.keys[which].unflatten(-1, (5, -1)).flatten(1, 2), own], dim=1)
        parts = self.network.number_parts(x[:, None], keys, free[:, None], (axes == LENGTH)[:, None])
        low, high = int(spans[:, 0].min()), int(spans[:, 1].max())
        chances = _spread_planes(parts, planes, low, high) + self._anew(parts, x, spans, low, high)
        values = torch.arange(low, high + 1)
        inside = (values >= spans[:, :1]) & (values <= spans[:, 1:])
        # What lies far from everything the network deems possible is drawn evenly.
        chances = chances * inside + 1e-20 * inside
        return (self._draw(chances) + low).tolist()

    def _anew(
        self, parts: NumberParts, x: Float[Tensor, "N D"], spans: Int[Tensor, "N 2"], low: int, high: int
    ) -> Float[Tensor, "N V"]:
        """Chances of values said as two digits, of which only the likeliest coarse ones are looked at."""
        digits = torch.arange(COARSE)
        possible = (digits >= (spans[:, :1] + REACH) // FINE) & (digits <= (spans[:, 1:] + REACH) // FINE)
        coarse = parts.coarse[:, 0].masked_fill(~possible, -1e9)
        best, digit = coarse.topk(DIGITS, dim=-1)
        fine = self.network.fine_logits(x[:, None], digit)
        chance = (parts.ways[:, 0, 2, None, None] + best[..., None] + fine).exp().flatten(1)
        value = (digit[..., None] * FINE + torch.arange(FINE) - REACH - low).flatten(1)
        inside = (value >= 0) & (value <= high - low)
        out = torch.zeros(len(x), high - low + 1)
        return out.scatter_add_(1, value.clamp(0, high - low), chance * inside)

    def _planes(
        self, which: list[int], axes: Int[Tensor, "N"]
    ) -> tuple[Int[Tensor, "N C"], Bool[Tensor, "N C"]]:
        """As `artigen.sketch.network.list_planes`, for rows that are half written."""
        place = axes.clamp(max=2)
        pick = place[:, None, None].expand(-1, self.low.shape[1], 1)
        low, high = self.low[which].gather(2, pick)[..., 0], self.high[which].gather(2, pick)[..., 0]
        own = torch.zeros(len(which), 2, dtype=torch.long)
        has, ends = torch.zeros(len(which), 2, dtype=torch.bool), torch.zeros(len(which), dtype=torch.bool)
        for at, k in enumerate(which):
            writer = self.writers[k]
            if writer.kind not in PIECE_KINDS:
                continue
            first, column_at = column(writer.kind, "x0"), len(writer.row)
            for side in (0, 1):
                known = column_at > first + 3 * side + int(place[at])
                has[at, side] = known
                own[at, side] = writer.row[first + 3 * side + int(place[at])] if known else 0
            ends[at] = column_at == first + 3 + int(place[at])
        planes = torch.stack([low, high, -low, -high, own[:, :1] + high - low], dim=-1).flatten(1)
        named = self.named[which]
        mirrored = named & (axes == MIRROR_AXIS)[:, None]
        free = torch.stack([named, named, mirrored, mirrored, named & ends[:, None]], dim=-1).flatten(1)
        free = torch.cat([free, has], dim=1) & (axes < LENGTH)[:, None]
        return torch.cat([planes, own], dim=1), free

    def _draw(self, chances: Float[Tensor, "N V"]) -> Int[Tensor, "N"]:
        """One of each row, after temperature, from its likeliest part."""
        cfg = self.cfg
        sharp = (chances / chances.amax(dim=-1, keepdim=True)) ** (1.0 / cfg.temperature)
        sharp = sharp / sharp.sum(dim=-1, keepdim=True)
        ordered, order = sharp.sort(dim=-1, descending=True)
        ordered = ordered * (ordered.cumsum(dim=-1) - ordered < cfg.top_p)
        pick = torch.multinomial(ordered, 1, generator=self.generator)
        return order.gather(1, pick)[:, 0]


def _spread_planes(
    parts: NumberParts, planes: Int[Tensor, "N C"], low: int, high: int
) -> Float[Tensor, "N V"]:
    """Chances of values said by planes, with and without an offset."""
    start, width = low - OFFSET, high - low + 1 + 2 * OFFSET
    at = planes - start
    inside = (at >= 0) & (at < width)
    at = at.clamp(0, width - 1)
    same = torch.zeros(len(planes), width).scatter_add_(
        1, at, (parts.ways[:, 0, :1] + parts.same[:, 0]).exp() * inside
    )
    near = torch.zeros(len(planes), width).scatter_add_(
        1, at, (parts.ways[:, 0, 1:2] + parts.near[:, 0]).exp() * inside
    )
    offsets = parts.offset[:, 0].exp().flip(-1)
    spread = F.conv1d(near[None], offsets[:, None], groups=len(planes))[0]
    return same[:, OFFSET:-OFFSET] + spread
