"""`correct_reading`: what people say of an object overrules what was read of it, and nothing else changes."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.errors import ArtigenError, name_options
from artigen.kind import kinds
from artigen.reader.reading import Reading, ReadPart

Side = Literal["left", "right", "top", "bottom"]
FRONTS: tuple[Literal["door", "drawer"], ...] = ("door", "drawer")
MOST = 40
"""Fronts of one label that can be asked for."""
WHOLE = 0.85
"""Share of the box around two fronts that they cover, from which one of them can take the place of both."""


def correct_reading(
    reading: Reading,
    *,
    kind: str | None = None,
    counts: Mapping[str, int] | None = None,
    hinge: Side | None = None,
    pane: bool | None = None,
    stand: Literal["flat", "legs", "wheels"] | None = None,
) -> Reading:
    """The reading with corrections; the fronts keep their places as far as the counts allow.

    Args:
        reading: What was read.
        kind: Kind of the object.
        counts: Number of doors, drawers and handles; without one of them, it stays as read. Handles can only
            be none.
        hinge: Side of the hinges of all doors.
        pane: Whether all doors are glazed.
        stand: What it stands on.

    Raises:
        ArtigenError: If the kind is unknown, or a number of fronts is out of bounds.
    """
    if kind is not None:
        if kind not in kinds():
            raise ArtigenError(f"kind {kind!r}: expected {name_options(kind, kinds())}")
        reading = replace(reading, kind=kind, kinds=((kind, 1.0),))
    fronts = list(reading.fronts)
    wanted = {label: counts[label] for label in FRONTS if counts and label in counts}
    for label, count in wanted.items():
        if not 0 <= count <= MOST:
            raise ArtigenError(f"{count} parts called {label}: expected 0 to {MOST}")
    fronts = _count_fronts(fronts, wanted, reading.box)
    doors = {} if hinge is None else {"hinge": hinge}
    doors |= {} if pane is None else {"pane": pane}
    fronts = [replace(front, **doors) if front.label == "door" else front for front in fronts]
    bare = counts is not None and counts.get("handle") == 0
    others = [
        part for part in reading.parts if part.label not in FRONTS and not (bare and part.label == "handle")
    ]
    return replace(reading, parts=(*fronts, *others), stand=stand or reading.stand, bare=bare or reading.bare)


def _count_fronts(
    fronts: list[ReadPart], wanted: Mapping[str, int], box: Float[np.ndarray, "4"]
) -> list[ReadPart]:
    """Fronts with the wanted numbers of doors and drawers.

    Those of the other label that are one too many, or of which nothing is said where a label is missing, take
    the label, the flattest as drawers and the tallest as doors; then the least sure ones go, and the largest
    are divided."""
    if wanted and not fronts and sum(wanted.values()):
        label = max(wanted, key=lambda name: wanted[name])
        fronts = [ReadPart(label=label, score=0.0, box=np.asarray(box))]  # type: ignore[arg-type]
    for label, count in wanted.items():
        other = FRONTS[1 - FRONTS.index(label)]
        spare = [front for front in fronts if front.label == other]
        spare.sort(key=_flatness, reverse=label == "drawer")
        held = sum(front.label == label for front in fronts)
        free = len(spare) - wanted[other] if other in wanted else len(spare) * (held == 0)
        taken = spare[: max(0, min(free, count - held))]
        fronts = [_relabel(front, label) if _is_among(front, taken) else front for front in fronts]
    for label, count in wanted.items():
        while sum(front.label == label for front in fronts) > count:
            fronts = _remove(fronts, min(_list(fronts, label), key=lambda front: front.score))
        while sum(front.label == label for front in fronts) < count:
            own = _list(fronts, label) or fronts
            largest = max(own, key=_area)
            at = next(index for index, front in enumerate(fronts) if front is largest)
            fronts[at : at + 1] = divide_front(
                _relabel(largest, label), "columns" if label == "door" else "rows"
            )
    return fronts


def _list(fronts: Sequence[ReadPart], label: str) -> list[ReadPart]:
    return [front for front in fronts if front.label == label]


def _is_among(front: ReadPart, others: Sequence[ReadPart]) -> bool:
    return any(front is other for other in others)


def _flatness(front: ReadPart) -> float:
    wide, high = front.box[2:] - front.box[:2]
    return float(wide / max(high, 1e-9))


def _area(front: ReadPart) -> float:
    return float((front.box[2:] - front.box[:2]).prod())


def _relabel(front: ReadPart, label: str) -> ReadPart:
    return front if front.label == label else replace(front, label=label, hinge=None)  # type: ignore[arg-type]


def _remove(fronts: Sequence[ReadPart], gone: ReadPart) -> list[ReadPart]:
    """The other fronts; one of the same label beside the removed one takes its place."""
    rest = [front for front in fronts if front is not gone]
    covers = [
        ((_area(front) + _area(gone)) / max(float((hull[2:] - hull[:2]).prod()), 1e-9), index)
        for index, front in enumerate(rest)
        if front.label == gone.label
        for hull in [
            np.concatenate([np.minimum(front.box[:2], gone.box[:2]), np.maximum(front.box[2:], gone.box[2:])])
        ]
    ]
    cover, at = max(covers, default=(0.0, 0))
    if cover >= WHOLE:
        rest[at] = _join(rest[at], gone)
    return rest


def _join(front: ReadPart, other: ReadPart) -> ReadPart:
    """A front in the place of two neighbours."""
    box = np.concatenate([np.minimum(front.box[:2], other.box[:2]), np.maximum(front.box[2:], other.box[2:])])
    if front.corners is None or other.corners is None:
        return replace(front, box=box, corners=None)
    aside = abs(float(front.box[0] - other.box[0])) > abs(float(front.box[1] - other.box[1]))
    first, last = sorted((front, other), key=lambda part: float(part.box[0 if aside else 1]))
    taken = (0, 3) if aside else (0, 1)
    corners = np.stack([(first if corner in taken else last).corners[corner] for corner in range(4)])  # type: ignore[index]
    return replace(front, box=box, corners=corners)


def divide_front(front: ReadPart, along: Literal["rows", "columns"]) -> tuple[ReadPart, ReadPart]:
    """Two equal fronts in the place of one; two doors open apart."""
    low = 0 if along == "columns" else 1
    middle = (front.box[low] + front.box[low + 2]) / 2
    first, second = front.box.copy(), front.box.copy()
    first[low + 2] = second[low] = middle
    corners: tuple[Float[np.ndarray, "4 2"] | None, Float[np.ndarray, "4 2"] | None] = (None, None)
    if front.corners is not None:
        a, b, c, d = np.asarray(front.corners, dtype=np.float64)
        ends = ((a + b) / 2, (d + c) / 2) if along == "columns" else ((a + d) / 2, (b + c) / 2)
        corners = (
            (np.stack([a, ends[0], ends[1], d]), np.stack([ends[0], b, c, ends[1]]))
            if along == "columns"
            else (np.stack([a, b, ends[1], ends[0]]), np.stack([ends[0], ends[1], c, d]))
        )
    hinges = ("left", "right") if along == "columns" and front.label == "door" else (front.hinge, front.hinge)
    return (
        replace(front, box=first, corners=corners[0], hinge=hinges[0]),  # type: ignore[arg-type]
        replace(front, box=second, corners=corners[1], hinge=hinges[1]),  # type: ignore[arg-type]
    )
