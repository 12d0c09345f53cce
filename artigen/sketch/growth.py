"""Extends an incomplete object by a part, in several candidates, until one has no fault."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from artigen.sketch.contact import Bodies, find_overlaps, gather_bodies, list_bodies
from artigen.sketch.decoder import Decoder
from artigen.sketch.draft import Draft
from artigen.sketch.draw import DrawConfig, continue_draft
from artigen.sketch.faults import MAX_OVERLAP, search_faults
from artigen.sketch.piece import PIECE_KINDS
from artigen.sketch.rows import read_row_piece, rows_to_sketch
from artigen.sketch.rules import Writer
from artigen.sketch.sketch import SketchError, build_primitives, read_sketch

UNREADABLE = "unreadable"
"""Id for tables that do not describe an object."""
DEFERRED = frozenset(("tipping", "extent"))
"""Faults that only a complete object can have."""


@dataclass(kw_only=True, eq=False)
class Grower:
    """Extends drafts by parts and counts the rejected ones by their first fault."""

    decoder: Decoder
    rng: np.random.Generator
    draw: DrawConfig
    candidates: int
    """Continuations per batch."""
    coolest: float = np.inf
    """Temperature of the first continuation of a batch, at most that of ``draw``; those of the others rise
    evenly to it."""
    seen: Counter[str] = field(default_factory=Counter)
    batches: int = 0

    def grow(self, draft: Draft) -> tuple[Draft | None, int]:
        """First continuation by one part without a fault, or None.

        A continuation ends at its first piece that overlaps a finished part. The second value is the earlier
        part that most of the faults involve, or the last part if they involve none.
        """
        before = len(draft.writer.moving)
        blamed: Counter[int] = Counter()
        finished = _list_finished(draft)

        def fits(writer: Writer) -> bool:
            if finished is None or writer.kind not in PIECE_KINDS:
                return True
            try:
                piece = gather_bodies(build_primitives(read_row_piece(writer.row)))
            except ValueError:
                self.seen[UNREADABLE] += 1
                return False
            hit = find_overlaps(finished, piece, MAX_OVERLAP)
            if len(hit):
                self.seen["overlap"] += 1
                blamed.update(np.unique(finished.parts[hit]).tolist())
            return not len(hit)

        for one in self._batch(draft, fits):
            fault = next(_search_lasting(one), None)
            if fault is None:
                return one, before
            self.seen[fault.id] += 1
            blamed.update(part for part in fault.parts if part < before)
        return None, max(blamed, key=lambda part: (blamed[part], part), default=before - 1)

    def finish(self, draft: Draft) -> Draft:
        """Adds the missing parts, choosing the continuation with the fewest faults in every batch.

        Raises:
            SketchError: If no continuation describes an object.
        """
        while not draft.writer.delivered:
            drawn = [
                (one, {fault.id for fault in _search_lasting(one)})
                for one in self._batch(draft, lambda _: True)
            ]
            batch = [(one, faults) for one, faults in drawn if UNREADABLE not in faults]
            if not batch:
                raise SketchError(
                    f"none of {self.candidates} continuations of an object could be read; the last had "
                    f"{len(draft.writer.moving)} parts"
                )
            draft = min(batch, key=lambda drawn: len(drawn[1]))[0]
        return draft

    def _batch(self, draft: Draft, fits: Callable[[Writer], bool]) -> Iterator[Draft]:
        """Yields continuations by one part, except those that grew too long."""
        self.batches += 1
        parts = len(draft.writer.moving)
        rngs = self.rng.spawn(self.candidates)
        warmest = self.draw.temperature
        temperatures = np.linspace(min(self.coolest, warmest), warmest, self.candidates).tolist()
        # The first one is usually valid, and the others are then not drawn.
        for some in (slice(1), slice(1, None)) if self.candidates > 1 else (slice(1),):
            drawn = continue_draft(
                self.decoder,
                draft,
                lambda writer: len(writer.moving) > parts,
                rngs[some],
                self.draw,
                temperatures=temperatures[some],
                fits=fits,
            )
            yield from (one for one in drawn if one is not None)


@dataclass(frozen=True, kw_only=True)
class _Found:
    """A fault's id and the indices of the parts that it involves."""

    id: str
    parts: tuple[int, ...] = ()


def _search_lasting(draft: Draft) -> Iterator[_Found]:
    """Faults of an incomplete object that further parts cannot remove."""
    try:
        shape = read_sketch(rows_to_sketch(draft.writer.table))
    except SketchError:
        yield _Found(id=UNREADABLE)
        return
    numbers = {part.name: number for number, part in enumerate(shape.parts)}
    for fault in search_faults(shape):
        if fault.id not in DEFERRED:
            yield _Found(
                id=fault.id,
                parts=tuple(numbers[name] for name in (fault.part, fault.other) if name in numbers),
            )


def _list_finished(draft: Draft) -> Bodies | None:
    """Primitives of the finished parts, whose numbers are those of the table; None before the first."""
    count = len(draft.writer.moving)
    if not count:
        return None
    return list_bodies(read_sketch(rows_to_sketch(draft.writer.table)), np.arange(count))
