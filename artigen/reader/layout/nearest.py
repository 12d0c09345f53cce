"""`draw_nearest`: of many draws of a kind, the one that is most like what was read.

The inverse of a grammar by search: every kind can be drawn after a photograph, without knowing of any."""

from collections import Counter
from dataclasses import replace

import numpy as np
from jaxtyping import Float
from scipy.optimize import linear_sum_assignment

from artigen.reader.boxes import overlap_boxes
from artigen.reader.layout.frontal import read_shape
from artigen.reader.layout.fronts import Lengths
from artigen.reader.reading import Reading, ReadPart
from artigen.shapes.draw import ShapeError, Wish, draw_shape
from artigen.shapes.shape import Shape

DRAWS = 32
"""Objects that are compared."""
HINGE, PANE, FIELD, PULLS, SIZE = 0.4, 0.2, 0.4, 0.1, 2.0
"""Cost of a wrong hinge, a wrong pane, a wrong field, a handle too many or too few, and of a length that is
wrong by a factor of e, against a front that is missing."""
MOST_PULLS = 3
"""Handles too many or too few that count: they are read worse than fronts."""


def draw_nearest(reading: Reading, kind: str, seed: int, wish: Wish, size: Lengths) -> tuple[Shape, float]:
    """The object of a kind whose fronts look most like those of a reading, seen as in the photograph.

    A quarter of the draws each has the size that was read, its width, its height, and any size, since a kind
    has forms of other sizes than those that are usual for what was read.

    Args:
        reading: Fronts, handles and view.
        kind: What to draw.
        seed: The same arguments give the same object.
        wish: What all draws must meet.
        size: Width, depth and height (m) as read.

    Returns:
        The object, and its difference: fronts that are missing or superfluous, each 1, and fractions for
        those that are elsewhere.

    Raises:
        ShapeError: If no object of the kind meets the wish.
    """
    width, depth, height = size
    sizes = (
        (width, depth, height), (width, None, None), (None, None, height), (None, None, None),
    )  # fmt: skip
    best: tuple[float, Shape] | None = None
    refused: ShapeError | None = None
    for draw in range(DRAWS):
        wide, deep, high = sizes[draw % len(sizes)]
        asked = replace(wish, width=wish.width or wide, depth=wish.depth or deep, height=wish.height or high)
        try:
            shape = draw_shape(kind, int(np.random.SeedSequence([seed, draw]).generate_state(1)[0]), asked)
        except ShapeError as error:
            refused = error
            continue
        cost = rate_difference(reading, read_shape(shape, view=reading.view), size)
        if best is None or cost < best[0]:
            best = cost, shape
    if best is None:
        assert refused is not None
        raise refused
    return replace(best[1], seed=seed), best[0]


def rate_difference(seen: Reading, built: Reading, size: Lengths) -> float:
    """Cost of the differences of two readings from one view; 0 for equal ones.

    Args:
        seen: What was read.
        built: What an object looks like.
        size: Width, depth and height (m) of what was seen, as far as they are known.
    """
    cost = 0.0
    for label in ("door", "drawer"):
        own, other = ([part for part in one.fronts if part.label == label] for one in (seen, built))
        cost += abs(len(own) - len(other))
        if own and other:
            costs = _compare(own, other, seen.box)
            cost += float(costs[linear_sum_assignment(costs)].sum())
    pulls = [Counter(part.label for part in one.parts)["handle"] for one in (seen, built)]
    cost += PULLS * min(MOST_PULLS, abs(pulls[0] - pulls[1]))
    lengths = zip(size, built.size, strict=True)
    return cost + SIZE * sum(abs(np.log(own / other)) for own, other in lengths if own is not None)


def _compare(
    seen: list[ReadPart], built: list[ReadPart], frame: Float[np.ndarray, "4"]
) -> Float[np.ndarray, "N M"]:
    """Cost of every pair: how little the boxes overlap, within those of the objects, and what else
    differs."""
    low, extent = frame[:2], np.maximum(frame[2:] - frame[:2], 1e-6)
    first = (np.stack([part.box for part in seen]) - np.tile(low, 2)) / np.tile(extent, 2)
    last = np.stack([part.box for part in built])
    costs = 1.0 - overlap_boxes(first, last)
    for row, own in enumerate(seen):
        for column, other in enumerate(built):
            costs[row, column] += HINGE * (own.hinge is not None and own.hinge != other.hinge)
            costs[row, column] += PANE * (own.pane != other.pane)
            known = own.field is not None and other.field is not None
            costs[row, column] += FIELD * (known and own.field != other.field)
    return costs
