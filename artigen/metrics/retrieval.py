"""The retrieval baseline: the training object nearest to a condition, as in SINGAPO-like systems."""

from collections.abc import Sequence

import numpy as np

from artigen.metrics.subjects import Subject
from artigen.models.conditions import StructureCondition
from artigen.types import PART_LABELS


def condition_distance(asked: StructureCondition, subject: Subject) -> float:
    """How far an object is from what is asked; fields left open count for nothing.

    One for each part too many or too few, the logarithm of the ratio of each extent, a thousand times the
    mean squared difference of the pictures, and infinity for another category.
    """
    example = subject.example
    if asked.category is not None and asked.category != example.category:
        return np.inf
    total = 0.0
    for label, count in asked.counts:
        total += abs(int(example.counts[PART_LABELS.index(label)]) - count)
    if asked.size is not None:
        total += float(np.abs(np.log(example.size / np.asarray(asked.size))).sum())
    if asked.image is not None:
        if example.image is None:
            return np.inf
        seen = example.image.transpose(2, 0, 1) / 255.0
        total += 1000.0 * float(((seen - asked.image) ** 2).mean())
    return total


def retrieve(asked: StructureCondition, library: Sequence[Subject]) -> Subject:
    """The nearest object of a library; the first of equally near ones.

    Raises:
        ValueError: If no object of the library is of the category asked for.
    """
    distances = [condition_distance(asked, subject) for subject in library]
    if not distances or not np.isfinite(min(distances)):
        raise ValueError(f"none of {len(library)} objects can answer: category {asked.category!r}")
    return library[int(np.argmin(distances))]
