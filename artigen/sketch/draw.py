"""Samples tables of rows from the network within the rules, several in parallel."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.sketch.batch import PARTS, PLACES, RowBatch, make_batch, row_planes
from artigen.sketch.blocks import Cache, PictureMemory, join_memories
from artigen.sketch.network import SketchNetwork
from artigen.sketch.planes import COARSE, FINE, OFFSET, SIDES, NumberParts, Places, list_planes
from artigen.sketch.request import RequestRows
from artigen.sketch.rows import REACH, number_axis
from artigen.sketch.rules import Writer
from artigen.sketch.slots import slots

DIGITS, PLANES = 24, 48
"""Coarse digits and planes with an offset that are considered for a number: the most likely ones."""
LIKELIEST = 64
"""Values sorted first; all are sorted only if these do not cover `DrawConfig.top_p`."""


@dataclass(frozen=True, kw_only=True)
class DrawConfig:
    """Sampling parameters."""

    temperature: float = 0.6
    """Softmax temperature; lower values favour likely choices."""
    top_p: float = 0.98
    """Nucleus sampling: probability mass that is kept."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Draft:
    """A partially written table with the network's state."""

    writer: Writer
    state: Float[Tensor, "D"]
    """Network state after the last row."""
    keys: Float[Tensor, "T K"]
    """Keys of the planes of every row."""
    rows: RowBatch
    cache: tuple[tuple[Float[Tensor, "1 H T E"], Float[Tensor, "1 H T E"]], ...]
    """Keys and values of every block."""
    memory: PictureMemory | None = None
    """Picture memory of the object, if there is a picture."""


@torch.inference_mode()
def begin_drafts(
    network: SketchNetwork, requests: Sequence[RequestRows], memory: PictureMemory | None = None
) -> list[Draft]:
    """Empty tables for requests with the same number of rows.

    Args:
        network: A trained network.
        requests: The requests.
        memory: Picture memory of the objects; None without pictures.

    Raises:
        ValueError: If requests differ in length.
    """
    if len({len(request.rows) for request in requests}) != 1:
        raise ValueError(f"requests of {sorted({len(a.rows) for a in requests})} rows, expected one length")
    empty = np.zeros((0, requests[0].rows.shape[1]), dtype=int)
    batch = make_batch([empty] * len(requests), requests)
    cache = [Cache() for _ in network.blocks]
    cells = network.embed_cells(batch.rows, batch.known, batch.axes)
    states = network.read_rows(cells, batch, cache, memory)
    return [
        Draft(
            writer=Writer(request=request),
            state=states[index, -1],
            keys=states.new_zeros(0, network.cfg.pointer * SIDES),
            rows=_take(batch, [index], slice(0, 0)),
            cache=_slice_cache(cache, index),
            memory=None if memory is None else memory.take([index]),
        )
        for index, request in enumerate(requests)
    ]


@torch.inference_mode()
def continue_drafts(
    network: SketchNetwork,
    drafts: Sequence[Draft],
    until: Callable[[Writer], bool],
    rngs: Sequence[np.random.Generator],
    cfg: DrawConfig | None = None,
    *,
    temperatures: Sequence[float] | None = None,
    fits: Callable[[Writer], bool] = lambda _: True,
) -> list[Draft | None]:
    """Extends tables in parallel until ``until`` holds for each; None for a table that grows too long or has
    a row that does not fit.

    The result for a table does not depend on the other tables.

    Args:
        network: A trained network.
        drafts: Tables with the same number of rows; they are not modified.
        until: Stopping condition, evaluated after every row.
        rngs: Random generator of each draft.
        cfg: Sampling parameters.
        temperatures: Softmax temperature of each draft, instead of that of ``cfg``.
        fits: Whether a table may go on, evaluated before each row is closed.
    """
    cfg = cfg or DrawConfig()
    sampler = _Sampler(network, drafts, rngs, temperatures or [cfg.temperature] * len(drafts), cfg.top_p)
    while sampler.writers:
        sampler.write_row(fits)
        sampler.remove_finished(until)
    return sampler.finished


class _Sampler:
    """Tables that are extended in parallel, row by row."""

    def __init__(
        self,
        network: SketchNetwork,
        drafts: Sequence[Draft],
        rngs: Sequence[np.random.Generator],
        temperatures: Sequence[float],
        top_p: float,
    ) -> None:
        self.network, self.rngs, self.temperatures, self.top_p = network, list(rngs), temperatures, top_p
        self.finished: list[Draft | None] = [None] * len(drafts)
        self.writers = [draft.writer.copy() for draft in drafts]
        self.index = list(range(len(drafts)))
        self.state = torch.stack([draft.state for draft in drafts])
        self.keys = torch.stack([draft.keys for draft in drafts])
        names = vars(drafts[0].rows)
        self.rows = RowBatch(
            **{name: torch.cat([getattr(draft.rows, name) for draft in drafts]) for name in names}
        )
        self.cache = [
            Cache(
                keys=torch.cat([keys for keys, _ in block]), values=torch.cat([values for _, values in block])
            )
            for block in zip(*(draft.cache for draft in drafts), strict=True)
        ]
        self.memory = join_memories([draft.memory for draft in drafts if draft.memory is not None])

    def write_row(self, fits: Callable[[Writer], bool]) -> None:
        """Samples one row of every table, and feeds it to the network where it fits; removes other tables."""
        network = self.network
        before = torch.zeros_like(self.state)
        self.planes, self.projected = network.plane_keys(self.keys), network.state(self.state)
        while True:
            open_rows = [k for k, writer in enumerate(self.writers) if not writer.complete()]
            if not open_rows:
                break
            self._write_fields(open_rows, before)
        kept = [k for k, writer in enumerate(self.writers) if fits(writer)]
        self._keep(kept)
        if not kept:
            return
        before = before[kept]
        last = _describe(self.writers, np.array([writer.close() for writer in self.writers]))
        # The embedding of a row is the sum of its cells, accumulated field by field.
        self.state = network.read_rows(before[:, None, None], last, self.cache, self.memory)[:, -1]
        self.rows = _join(self.rows, last)
        self.keys = torch.cat([self.keys, network.keys(self.state)[:, None]], 1)

    def remove_finished(self, until: Callable[[Writer], bool]) -> None:
        """Removes finished tables and those that grew too long."""
        going = []
        for k, writer in enumerate(self.writers):
            if until(writer) or writer.done:
                self.finished[self.index[k]] = Draft(
                    writer=writer,
                    state=self.state[k],
                    keys=self.keys[k],
                    rows=_take(self.rows, [k], slice(None)),
                    cache=_slice_cache(self.cache, k),
                    memory=None if self.memory is None else self.memory.take([k]),
                )
            elif not writer.stuck:
                going.append(k)
        self._keep(going)

    def _keep(self, going: list[int]) -> None:
        """Removes all tables but the given ones."""
        if len(going) == len(self.writers):
            return
        self.writers = [self.writers[k] for k in going]
        self.index = [self.index[k] for k in going]
        self.rngs = [self.rngs[k] for k in going]
        self.temperatures = [self.temperatures[k] for k in going]
        self.state, self.keys = self.state[going], self.keys[going]
        self.rows = _take(self.rows, going, slice(None))
        self.memory = None if self.memory is None else self.memory.take(going)
        for cache in self.cache:
            assert cache.keys is not None
            assert cache.values is not None
            cache.keys, cache.values = cache.keys[going], cache.values[going]

    def _write_fields(self, some: list[int], before: Float[Tensor, "B D"]) -> None:
        """Samples the next field of every incomplete row and adds its embedding to ``before``."""
        table, writers = slots(), [self.writers[k] for k in some]
        slot = np.array([table.of_cell[w.row[0], len(w.row)] if w.row else 0 for w in writers])
        values = [writer.follows() for writer in writers]
        number = table.size[slot] == 0
        drawn = [at for at, value in enumerate(values) if value is None]
        if drawn:
            which, where = [some[at] for at in drawn], torch.from_numpy(slot[drawn])
            x = self.network.hidden(_pick(self.projected, which), _pick(before, which), where)
            for numbers, draw in ((False, self._draw_symbols), (True, self._draw_numbers)):
                rows = [row for row, at in enumerate(drawn) if number[at] == numbers]
                if rows:
                    found = draw([which[row] for row in rows], x[rows], where[rows])
                    for row, value in zip(rows, found, strict=True):
                        values[drawn[row]] = value
        for writer, value in zip(writers, values, strict=True):
            assert value is not None
            writer.put(value)
        last = torch.tensor([writer.row[-1] for writer in writers])
        cells = self.network.embed_values(torch.from_numpy(slot), last, torch.from_numpy(number))
        before.index_add_(0, torch.tensor(some), cells)

    def _draw_symbols(self, which: list[int], x: Float[Tensor, "N D"], slot: Int[Tensor, "N"]) -> list[int]:
        sizes = slots().size[slot.numpy()]
        can = torch.zeros(len(which), int(sizes.max()), dtype=torch.bool)
        for at, k in enumerate(which):
            can[at, : sizes[at]] = torch.from_numpy(self.writers[k].allowed(int(sizes[at])))
        logits = self.network.slot_logits(x, slot, can.shape[1])
        return self._draw(which, logits.masked_fill(~can, float("-inf")).softmax(dim=-1)).tolist()

    def _draw_numbers(self, which: list[int], x: Float[Tensor, "N D"], slot: Int[Tensor, "N"]) -> list[int]:
        writers = [self.writers[k] for k in which]
        spans = torch.tensor([writer.span() for writer in writers])
        rows = self.rows if len(which) == len(self.writers) else _take(self.rows, which, slice(None))
        earlier = torch.ones(rows.named.shape, dtype=torch.bool)[:, None]
        planes, free = list_planes(rows, _list_places(writers), earlier)
        parts = self.network.number_parts(x[:, None], _pick(self.planes, which), free)
        ways = (
            _plane_chances(parts, planes[:, 0]),
            _offset_chances(parts, planes[:, 0]),
            self._digit_chances(parts, x, spans),
        )
        values, chances = (torch.cat(side, dim=1) for side in zip(*ways, strict=True))
        low, high = int(spans[:, 0].min()), int(spans[:, 1].max())
        inside = (values >= low) & (values <= high)
        summed = torch.zeros(len(x), high - low + 1)
        summed.scatter_add_(1, (values - low).clamp(0, high - low), chances * inside)
        every = torch.arange(low, high + 1)
        inside = (every >= spans[:, :1]) & (every <= spans[:, 1:])
        # A small uniform floor lets every value in the span be drawn.
        return (self._draw(which, summed * inside + 1e-20 * inside) + low).tolist()

    def _digit_chances(
        self, parts: NumberParts, x: Float[Tensor, "N D"], spans: Int[Tensor, "N 2"]
    ) -> tuple[Int[Tensor, "N V"], Float[Tensor, "N V"]]:
        """Values coded as two digits and their probabilities, for the most likely coarse digits."""
        digits = torch.arange(COARSE)
        possible = (digits >= (spans[:, :1] + REACH) // FINE) & (digits <= (spans[:, 1:] + REACH) // FINE)
        coarse = parts.coarse[:, 0].masked_fill(~possible, -1e9)
        best, digit = coarse.topk(min(DIGITS, int(possible.sum(dim=-1).max())), dim=-1)
        fine = self.network.fine_logits(x[:, None], digit)
        chances = (parts.ways[:, 0, 2, None, None] + best[..., None] + fine).exp()
        return (digit[..., None] * FINE + torch.arange(FINE) - REACH).flatten(1), chances.flatten(1)

    def _draw(self, which: list[int], chances: Float[Tensor, "N V"]) -> Int[Tensor, "N"]:
        """Samples one column per row after temperature and nucleus truncation."""
        temperature = torch.tensor([[self.temperatures[k]] for k in which])
        sharp = (chances / chances.amax(dim=-1, keepdim=True)) ** (1.0 / temperature)
        sharp = sharp / sharp.sum(dim=-1, keepdim=True)
        ordered, order = sharp.topk(min(LIKELIEST, sharp.shape[1]), dim=-1)
        if float(ordered.sum(dim=-1).min()) < self.top_p:  # the nucleus exceeds the sorted values
            ordered, order = sharp.sort(dim=-1, descending=True)
        upto = ordered.cumsum(dim=-1)
        kept = (upto - ordered < self.top_p).sum(dim=-1, keepdim=True)
        share = torch.tensor([[self.rngs[k].random()] for k in which])
        least = share * upto.gather(1, kept - 1)
        pick = torch.minimum((upto <= least).sum(dim=-1, keepdim=True), kept - 1)
        return order.gather(1, pick)[:, 0]


def _describe(writers: Sequence[Writer], rows: Int[np.ndarray, "B W"]) -> RowBatch:
    """Batch of the rows that were just closed, with their position in their tables."""
    planes, axes = row_planes(rows), number_axis(rows)
    part, piece, anchor, anchored = (np.array(column) for column in zip(*map(_place, writers), strict=True))
    values = {
        "rows": rows,
        "known": np.ones(rows.shape, dtype=bool),
        "predicted": np.zeros(rows.shape, dtype=bool),
        "axes": axes,
        "requested": np.zeros(len(rows), dtype=bool),
        "part": part,
        "piece": piece,
        "anchor": anchor,
        "anchored": anchored,
        **vars(planes),
    }
    return RowBatch(**{name: torch.from_numpy(value)[:, None] for name, value in values.items()})


def _place(writer: Writer) -> tuple[int, int, list[int], bool]:
    """Part index, position in the part, anchor, and whether the anchor precedes the row that was just
    closed."""
    if not writer.labels:
        return 0, min(len(writer.rows) - 1 + len(writer.request.rows), PLACES - 1), [0] * 4, False
    place, anchor = writer.length(), writer.anchor()
    return (
        min(len(writer.labels), PARTS - 1),
        min(place, PLACES - 1),
        [0] * 4 if anchor is None else [*anchor, 0],
        place > 1,
    )


def _list_places(writers: Sequence[Writer]) -> Places:
    """Positions of the numbers that come next."""
    found = [writer.place() for writer in writers]
    return Places(**{name: torch.tensor([[place[name]] for place in found]) for name in found[0]})


def _slice_cache(
    cache: Sequence[Cache], index: int
) -> tuple[tuple[Float[Tensor, "1 H T E"], Float[Tensor, "1 H T E"]], ...]:
    """Cache of every block for one table."""
    out = []
    for block in cache:
        assert block.keys is not None
        assert block.values is not None
        out.append((block.keys[[index]], block.values[[index]]))
    return tuple(out)


def _take(batch: RowBatch, objects: list[int] | slice, rows: slice) -> RowBatch:
    return RowBatch(**{name: value[objects, rows] for name, value in vars(batch).items()})


def _join(before: RowBatch, after: RowBatch) -> RowBatch:
    return RowBatch(
        **{name: torch.cat([value, getattr(after, name)], dim=1) for name, value in vars(before).items()}
    )


def _plane_chances(
    parts: NumberParts, planes: Int[Tensor, "N C"]
) -> tuple[Int[Tensor, "N C"], Float[Tensor, "N C"]]:
    """Planes and the probabilities of referring to them."""
    return planes, (parts.ways[:, 0, 0, None] + parts.same[:, 0]).exp()


def _offset_chances(
    parts: NumberParts, planes: Int[Tensor, "N C"]
) -> tuple[Int[Tensor, "N V"], Float[Tensor, "N V"]]:
    """Values coded as a plane and an offset and their probabilities, for the most likely planes."""
    near, best = parts.near[:, 0].topk(min(PLANES, planes.shape[1]), dim=-1)
    values = planes.gather(1, best)[..., None] + torch.arange(-OFFSET, OFFSET + 1)
    chances = (parts.ways[:, 0, 1, None, None] + near[..., None] + parts.offset).exp()
    return values.flatten(1), chances.flatten(1)


def _pick(values: Tensor, which: list[int]) -> Tensor:
    """The given rows of a tensor, which are in order; without a copy if these are all."""
    return values if len(which) == len(values) else values[torch.tensor(which)]
