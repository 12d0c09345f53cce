"""Accuracy of reading pictures: category, part counts, proportions."""

from collections.abc import Sequence

import numpy as np

from artigen.metrics.subjects import Subject, describe_subject
from artigen.sketch.model import LIKELIEST, draw_header, look_at
from artigen.sketch.network import SketchNetwork
from artigen.sketch.request import SketchRequest
from artigen.types import PART_LABELS, PartLabel

HIDDEN: tuple[PartLabel, ...] = ("shelf", "tray")
"""Labels of parts that are mostly behind doors."""


def score_reading(network: SketchNetwork, subjects: Sequence[Subject]) -> dict[str, float]:
    """Reads the pictures of objects by the likeliest header of each; shares in [0, 1].

    ``category`` and ``counts`` are the shares of pictures read right, the latter of every label at once,
    ``counts in view`` without shelves and trays; ``counts of <label>`` those of one label; ``extents`` is the
    mean error of the logarithms of the extents as shares of the longest.
    """
    kinds, rights, errors = [], [], []
    for subject in subjects:
        image = describe_subject(subject, ("image",)).image
        assert image is not None
        said = draw_header(network, SketchRequest(), 0, LIKELIEST, look_at(network, image)[1])
        held = {"base": 1, **dict(said.counts)}
        kinds.append(said.category == subject.example.category)
        rights.append(
            [held[label] == count for label, count in zip(PART_LABELS, subject.example.counts, strict=True)]
        )
        extents = np.array([said.depth, said.width, said.height], dtype=float)
        off = np.log(extents / extents.max()) - np.log(subject.example.size / subject.example.size.max())
        errors.append(np.abs(off).mean())
    right = np.array(rights)
    shown = [label not in HIDDEN for label in PART_LABELS]
    return {
        "category": float(np.mean(kinds)),
        "counts": float(right.all(axis=1).mean()),
        "counts in view": float(right[:, shown].all(axis=1).mean()),
        **{
            f"counts of {label}": float(share)
            for label, share in zip(PART_LABELS, right.mean(axis=0), strict=True)
        },
        "extents": float(np.mean(errors)),
    }
