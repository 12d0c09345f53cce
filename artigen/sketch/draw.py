"""Samples continuations of a table of rows from the network within the rules, several in parallel."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.sketch.batch import PARTS, PLACES, row_planes
from artigen.sketch.decoder import Decoder, PlaneScores
from artigen.sketch.draft import Draft, NamedPlanes, begin_own, extend_memory
from artigen.sketch.planes import COARSE, FINE, OFFSET, Places, Sides, list_planes, name_sides
from artigen.sketch.rows import REACH
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


def continue_draft(
    decoder: Decoder,
    draft: Draft,
    until: Callable[[Writer], bool],
    rngs: Sequence[np.random.Generator],
    cfg: DrawConfig | None = None,
    *,
    temperatures: Sequence[float] | None = None,
    fits: Callable[[Writer], bool] = lambda _: True,
) -> list[Draft | None]:
    """Extends a table in several ways in parallel until ``until`` holds for each.

    A continuation does not depend on those beside it; one that grows too long or has a row that does not fit
    is None.

    Args:
        draft: The table; it is not modified.
        until: Stopping condition, evaluated after every row.
        rngs: Random generator of each continuation.
        temperatures: Softmax temperature of each continuation, instead of that of ``cfg``.
        fits: Whether a table may go on, evaluated before each row is closed.
    """
    cfg = cfg or DrawConfig()
    sampler = _Sampler(decoder, draft, rngs, temperatures or [cfg.temperature] * len(rngs), cfg.top_p)
    while sampler.writers:
        sampler.write_row(fits)
        sampler.remove_finished(until)
    return sampler.finished


class _Sampler:
    """Continuations that are extended in parallel, row by row."""

    def __init__(
        self,
        decoder: Decoder,
        draft: Draft,
        rngs: Sequence[np.random.Generator],
        temperatures: Sequence[float],
        top_p: float,
    ) -> None:
        count = len(rngs)
        self.decoder, self.rngs, self.top_p = decoder, list(rngs), top_p
        self.temperatures = np.array(temperatures, dtype=float)
        self.finished: list[Draft | None] = [None] * count
        self.writers = [draft.writer.copy() for _ in rngs]
        self.index = list(range(count))
        self.state = np.repeat(draft.state[None], count, axis=0)
        self.planes = NamedPlanes(**{n: np.repeat(v, count, axis=0) for n, v in vars(draft.planes).items()})
        self.memory, self.own = draft.memory, begin_own(draft.memory, count)

    def write_row(self, fits: Callable[[Writer], bool]) -> None:
        """Samples one row of every table, and feeds it to the network where it fits; removes other tables."""
        before = np.zeros_like(self.state)
        self.projected, self.sides = self.decoder.project(self.state), name_sides(self.planes)
        while True:
            open_rows = [k for k, writer in enumerate(self.writers) if not writer.complete()]
            if not open_rows:
                break
            self._write_fields(open_rows, before)
        kept = [k for k, writer in enumerate(self.writers) if fits(writer)]
        self._keep(kept)
        if not kept:
            return
        rows = np.array([writer.close() for writer in self.writers])
        part, piece, anchor = (np.array(one) for one in zip(*map(_place, self.writers), strict=True))
        # The embedding of a row is the sum of its cells, accumulated field by field.
        self.state, self.own = self.decoder.read(before[kept], part, piece, self.memory, self.own)
        planes = row_planes(rows)
        last = {"low": planes.low, "high": planes.high, "named": planes.named, "ranged": planes.ranged}
        last |= {"anchor": anchor, "part": part, "keys": self.decoder.name_planes(self.state)}
        self.planes = self.planes.join(NamedPlanes(**{name: value[:, None] for name, value in last.items()}))

    def remove_finished(self, until: Callable[[Writer], bool]) -> None:
        """Removes finished tables and those that grew too long."""
        going = []
        for k, writer in enumerate(self.writers):
            if until(writer) or writer.done:
                self.finished[self.index[k]] = Draft(
                    writer=writer,
                    state=self.state[k],
                    planes=self.planes.take([k]),
                    memory=extend_memory(self.memory, self.own, k),
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
        self.temperatures, self.state = self.temperatures[going], self.state[going]
        self.planes = self.planes.take(going)
        self.own = [(keys[going], values[going]) for keys, values in self.own]

    def _write_fields(self, some: list[int], before: Float[np.ndarray, "B D"]) -> None:
        """Samples the next field of every incomplete row and adds its embedding to ``before``."""
        table, writers = slots(), [self.writers[k] for k in some]
        slot = np.array([table.of_cell[w.row[0], len(w.row)] if w.row else 0 for w in writers])
        values = [writer.follows() for writer in writers]
        number = table.size[slot] == 0
        drawn = [at for at, value in enumerate(values) if value is None]
        if drawn:
            which = [some[at] for at in drawn]
            x = self.decoder.hidden(_pick(self.projected, which), _pick(before, which), slot[drawn])
            for numbers, draw in ((False, self._draw_symbols), (True, self._draw_numbers)):
                rows = [row for row, at in enumerate(drawn) if number[at] == numbers]
                if rows:
                    found = draw([which[row] for row in rows], _pick(x, rows), slot[drawn][rows])
                    for row, value in zip(rows, found, strict=True):
                        values[drawn[row]] = value
        for writer, value in zip(writers, values, strict=True):
            assert value is not None
            writer.put(value)
        last = np.array([writer.row[-1] for writer in writers])
        for numbers, embed in ((False, self.decoder.embed_symbols), (True, self.decoder.embed_numbers)):
            rows = np.flatnonzero(number == numbers)
            if len(rows):
                before[[some[row] for row in rows]] += embed(slot[rows], last[rows])

    def _draw_symbols(
        self, which: list[int], x: Float[np.ndarray, "N D"], slot: Int[np.ndarray, "N"]
    ) -> list[int]:
        sizes = slots().size[slot]
        can = np.zeros((len(which), sizes.max()), dtype=bool)
        for at, k in enumerate(which):
            can[at, : sizes[at]] = self.writers[k].allowed(int(sizes[at]))
        logits = self.decoder.score_symbols(x, slot, can.shape[1])
        logits = np.where(can, logits, -np.inf)
        return self._draw(which, np.exp(logits - logits.max(axis=1, keepdims=True))).tolist()

    def _draw_numbers(
        self, which: list[int], x: Float[np.ndarray, "N D"], _: Int[np.ndarray, "N"]
    ) -> list[int]:
        writers = [self.writers[k] for k in which]
        spans = np.array([writer.span() for writer in writers])
        sides = Sides(values=_pick(self.sides.values, which), free=_pick(self.sides.free, which))
        planes, free = (
            one[:, 0] for one in list_planes(sides, _list_places(writers), np.ones((1, 1, 1), dtype=bool))
        )
        keys = _pick(self.planes.keys, which)
        scores = self.decoder.score_planes(x, keys.reshape(len(x), -1, keys.shape[3]), free)
        chances = np.exp(scores.ways[:, :1] + scores.same)
        certain = self._find_certain(which, planes, chances, spans)
        if certain is not None:
            return certain
        offset, coarse = self.decoder.score_digits(x)
        ways = (
            (planes, chances),
            _offset_chances(scores, offset, planes),
            self._digit_chances(scores, coarse, x, spans),
        )
        low, summed = _sum_chances(ways, spans)
        return (self._draw(which, summed) + low).tolist()

    def _find_certain(
        self,
        which: list[int],
        planes: Int[np.ndarray, "N C"],
        chances: Float[np.ndarray, "N C"],
        spans: Int[np.ndarray, "N 2"],
    ) -> list[int] | None:
        """Planes that are all that nucleus sampling keeps, or None; most numbers repeat a plane.

        What the other encodings add cannot change the choice, unless a temperature above 1 makes all values
        more alike.
        """
        value = planes[np.arange(len(planes)), chances.argmax(axis=1)]
        sure = (chances * (planes == value[:, None])).sum(axis=1) >= self.top_p
        sure &= (spans[:, 0] <= value) & (value <= spans[:, 1]) & (self.temperatures[which] <= 1.0)
        if not sure.all():
            return None
        for k in which:
            self.rngs[k].random()  # as in `_draw`: tables do not depend on each other
        return value.tolist()

    def _digit_chances(
        self,
        scores: PlaneScores,
        coarse: Float[np.ndarray, "N K"],
        x: Float[np.ndarray, "N D"],
        spans: Int[np.ndarray, "N 2"],
    ) -> tuple[Int[np.ndarray, "N V"], Float[np.ndarray, "N V"]]:
        """Values coded as two digits and their probabilities, for the most likely coarse digits."""
        digits = np.arange(COARSE)
        possible = (digits >= (spans[:, :1] + REACH) // FINE) & (digits <= (spans[:, 1:] + REACH) // FINE)
        count = min(DIGITS, int(possible.sum(axis=1).max()))
        best, digit = _find_largest(np.where(possible, coarse, -np.inf), count)
        chances = np.exp(scores.ways[:, 2, None, None] + best[..., None] + self.decoder.score_fine(x, digit))
        values = digit[..., None] * FINE + np.arange(FINE) - REACH
        return values.reshape(len(x), -1), chances.reshape(len(x), -1)

    def _draw(self, which: list[int], chances: Float[np.ndarray, "N V"]) -> Int[np.ndarray, "N"]:
        """Samples one column per row after temperature and nucleus truncation."""
        sharp = (chances / chances.max(axis=1, keepdims=True)) ** (1.0 / self.temperatures[which, None])
        whole = sharp.sum(axis=1, keepdims=True)
        ordered, order = _find_largest(sharp, min(LIKELIEST, sharp.shape[1]))
        if (ordered.sum(axis=1) < self.top_p * whole[:, 0]).any():  # the nucleus exceeds the sorted values
            ordered, order = _find_largest(sharp, sharp.shape[1])
        upto = ordered.cumsum(axis=1)
        kept = (upto - ordered < self.top_p * whole).sum(axis=1)
        share = np.array([self.rngs[k].random() for k in which])
        rows = np.arange(len(order))
        least = share * upto[rows, kept - 1]
        pick = np.minimum((upto <= least[:, None]).sum(axis=1), kept - 1)
        return order[rows, pick]


def _place(writer: Writer) -> tuple[int, int, list[int]]:
    """Part index, position in the part and anchor of the row that was just closed."""
    if not writer.labels:
        return 0, min(len(writer.rows) - 1 + len(writer.request.rows), PLACES - 1), [0] * 4
    anchor = writer.anchor()
    return (
        min(len(writer.labels), PARTS - 1),
        min(writer.length(), PLACES - 1),
        [0] * 4 if anchor is None else [*anchor, 0],
    )


def _list_places(writers: Sequence[Writer]) -> Places:
    """Positions of the numbers that come next."""
    found = [writer.place() for writer in writers]
    return Places(**{name: np.array([[place[name]] for place in found]) for name in found[0]})


def _offset_chances(
    scores: PlaneScores, offset: Float[np.ndarray, "N O"], planes: Int[np.ndarray, "N C"]
) -> tuple[Int[np.ndarray, "N V"], Float[np.ndarray, "N V"]]:
    """Values coded as a plane and an offset and their probabilities, for the most likely planes."""
    near, best = _find_largest(scores.near, min(PLANES, planes.shape[1]))
    values = planes[np.arange(len(planes))[:, None], best][..., None] + np.arange(-OFFSET, OFFSET + 1)
    chances = np.exp(scores.ways[:, 1, None, None] + near[..., None] + offset[:, None])
    return values.reshape(len(values), -1), chances.reshape(len(values), -1)


def _sum_chances(
    ways: Sequence[tuple[Int[np.ndarray, "N _"], Float[np.ndarray, "N _"]]], spans: Int[np.ndarray, "N 2"]
) -> tuple[int, Float[np.ndarray, "N V"]]:
    """Smallest value of all spans, and the probability of every value from there on, 0 outside of its span.

    A small uniform floor lets every value in the span be drawn.
    """
    values, chances = (np.concatenate(side, axis=1) for side in zip(*ways, strict=True))
    low, high = int(spans[:, 0].min()), int(spans[:, 1].max())
    size = high - low + 1
    values = np.where((values >= low) & (values <= high), values - low, size)
    at = values + np.arange(len(values))[:, None] * (size + 1)
    summed = np.bincount(at.ravel(), chances.ravel(), len(values) * (size + 1)).reshape(len(values), -1)
    every = np.arange(low, high + 1)
    inside = (every >= spans[:, :1]) & (every <= spans[:, 1:])
    return low, np.where(inside, summed[:, :-1] + 1e-20, 0.0)


def _find_largest(
    values: Float[np.ndarray, "N V"], count: int
) -> tuple[Float[np.ndarray, "N C"], Int[np.ndarray, "N C"]]:
    """The largest values of each row in descending order, and their columns."""
    rows = np.arange(len(values))[:, None]
    if count < values.shape[1]:
        lead = np.argpartition(-values, count - 1, axis=1)[:, :count]
        order = lead[rows, np.argsort(-values[rows, lead], axis=1, kind="stable")]
    else:
        order = np.argsort(-values, axis=1, kind="stable")
    return values[rows, order], order


def _pick(values: np.ndarray, which: list[int]) -> np.ndarray:
    """The given rows of an array, which are in order; without a copy if these are all."""
    return values if len(which) == len(values) else values[which]
