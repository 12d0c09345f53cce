"""Accuracy of reading pictures: category, part counts, proportions."""

from collections.abc import Sequence

import numpy as np

from artigen.kind import find_kind
from artigen.metrics.subjects import Subject, describe_subject
from artigen.sketch.model import draw_header, encode_picture
from artigen.sketch.network import SketchNetwork
from artigen.sketch.request import SketchRequest
from artigen.types import PART_LABELS, PartLabel

HIDDEN: tuple[PartLabel, ...] = ("shelf", "tray")
"""Labels of parts that are mostly behind doors."""


def score_reading(network: SketchNetwork, subjects: Sequence[Subject]) -> dict[str, float]:
    """Scores the likeliest header that the network reads from the picture of each object; shares in [0, 1].

    ``category`` is the share of pictures with the right category, ``counts`` with the right counts of all
    labels, ``counts in view`` of all but shelves and trays, ``counts of <label>`` of one label. ``hidden,
    given the rest`` is the share with the right shelves and trays when the category and all other counts are
    requested: what ``counts`` would be if everything in view were read correctly. ``extents`` is the mean
    absolute error of the logarithms of the extents, each relative to the longest. Categories are compared by
    `is_same_category`.
    """
    kinds, rights, hidden, errors = [], [], [], []
    for subject in subjects:
        image = describe_subject(subject, ("image",)).image
        assert image is not None
        encoded = encode_picture(network, image)
        header = draw_header(network, SketchRequest(), 0, encoded=encoded)
        kinds.append(is_same_category(header.category, subject.example.category))
        rights.append(_compare_counts(header, subject))
        given = draw_header(network, _request_in_view(subject), 0, encoded=encoded)
        hidden.append(all(_compare_counts(given, subject)))
        extents = np.array([header.depth, header.width, header.height], dtype=float)
        off = np.log(extents / extents.max()) - np.log(subject.example.size / subject.example.size.max())
        errors.append(np.abs(off).mean())
    right = np.array(rights)
    shown = [label not in HIDDEN for label in PART_LABELS]
    return {
        "category": float(np.mean(kinds)),
        "counts": float(right.all(axis=1).mean()),
        "counts in view": float(right[:, shown].all(axis=1).mean()),
        "hidden, given the rest": float(np.mean(hidden)),
        **{
            f"counts of {label}": float(share)
            for label, share in zip(PART_LABELS, right.mean(axis=0), strict=True)
        },
        "extents": float(np.mean(errors)),
    }


def is_same_category(one: str | None, other: str | None) -> bool:
    """Whether both are the same category in PartNet-Mobility."""
    return _name_in_source(one) == _name_in_source(other)


def _name_in_source(category: str | None) -> str | None:
    kind = None if category is None else find_kind(category)
    return category if kind is None else kind.partnet or category


def _compare_counts(header: SketchRequest, subject: Subject) -> list[bool]:
    """Whether a header has the right number of parts of each label."""
    held = {"base": 1, **dict(header.counts)}
    return [held[label] == count for label, count in zip(PART_LABELS, subject.example.counts, strict=True)]


def _request_in_view(subject: Subject) -> SketchRequest:
    """The category of an object and its counts but those of `HIDDEN`."""
    counts = zip(PART_LABELS[1:], subject.example.counts[1:].tolist(), strict=True)
    return SketchRequest(
        category=subject.example.category,
        counts=tuple((label, count) for label, count in counts if label not in HIDDEN),
    )
