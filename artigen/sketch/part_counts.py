"""Part counts that occur together: headers not read from a picture have those of training objects.

The network predicts the counts of a header one after the other. Each is plausible; together some are not,
such as nine drawers with eight handles.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from jaxtyping import Int

from artigen.sketch.rows import COUNTED, column
from artigen.sketch.words import CATEGORIES

PartCounts = frozenset[tuple[str, tuple[int, ...]]]
"""Categories, each with a number of parts of every label of `COUNTED`."""
CATEGORY = column("object", "category")
COUNTS = [column("object", label) for label in COUNTED]
"""Columns of a header that hold the number of parts of each label."""


def read_part_counts(header: Sequence[int] | Int[np.ndarray, "W"]) -> tuple[str, tuple[int, ...]]:
    """Category and counts of a header row."""
    return CATEGORIES[header[CATEGORY]], tuple(int(header[at]) for at in COUNTS)


def collect_part_counts(tables: Iterable[Int[np.ndarray, "T W"]]) -> PartCounts:
    """The counts of all tables; each begins with its header."""
    return frozenset(read_part_counts(table[0]) for table in tables)


def describe_part_counts(known: PartCounts) -> dict[str, list[str]]:
    """Counts as text by category, such as "drawer 9, handle 9", for a model's description."""
    found: dict[str, list[str]] = {}
    for category, counts in sorted(known):
        words = ", ".join(f"{label} {count}" for label, count in zip(COUNTED, counts, strict=True) if count)
        found.setdefault(category, []).append(words)
    return found


def parse_part_counts(described: Mapping[str, Sequence[str]]) -> PartCounts:
    """Inverts `describe_part_counts`.

    Raises:
        ValueError: If a text is not of its form.
    """
    known = set[tuple[str, tuple[int, ...]]]()
    for category, texts in described.items():
        for text in texts:
            pairs = [word.split() for word in text.split(", ") if word]
            counts = {label: int(count) for label, count in pairs}
            if not counts.keys() <= set(COUNTED):
                raise ValueError(f"{text!r}: expected labels of {', '.join(COUNTED)}, each with its count")
            known.add((category, tuple(counts.get(label, 0) for label in COUNTED)))
    return frozenset(known)
