"""What was read from a photograph as a request: its kind, and its doors and drawers."""

from collections.abc import Mapping
from dataclasses import replace

from artigen.reader.reading import Reading
from artigen.sketch.part_counts import PartCounts
from artigen.sketch.request import SketchRequest
from artigen.sketch.rows import COUNTED
from artigen.types import PartLabel

FRONTS: tuple[PartLabel, ...] = ("door", "drawer")


def follow_reading(
    request: SketchRequest, reading: Reading, known: PartCounts
) -> tuple[SketchRequest, tuple[str, ...]]:
    """The request with what was read and not requested, and notes that say what was read.

    Args:
        request: What was requested by words and options; it overrules the reading.
        known: Part counts that occur together; others cannot be drawn. Empty if all can.
    """
    shares = ", ".join(f"{kind} {share:.0%}" for kind, share in reading.kinds[:3])
    counts: dict[PartLabel, int] = {label: reading.counts[label] for label in FRONTS}
    said = " and ".join(f"{count} {label}{'s' * (count != 1)}" for label, count in counts.items())
    notes = [f"the photograph was read as {shares}; {said} in view"]
    category = request.category or reading.kind
    requested: dict[PartLabel, int] = dict(request.counts)
    wanted: dict[PartLabel, int] = {label: requested.get(label, count) for label, count in counts.items()}
    if _can_be_drawn(category, wanted, known):
        request = replace(request, counts=tuple(sorted({**requested, **wanted}.items())))
    else:
        notes.append(f"no {category} with {said} can be drawn; the number of parts is chosen by the network")
    return replace(request, category=category), tuple(notes)


def _can_be_drawn(category: str, wanted: Mapping[PartLabel, int], known: PartCounts) -> bool:
    places = {label: COUNTED.index(label) for label in wanted}
    return not known or any(
        name == category and all(counts[places[label]] == count for label, count in wanted.items())
        for name, counts in known
    )
