"""The side of a door's hinges: what the network says, where its pull is, and what stands beside it."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from artigen.reader.labels import HINGES

PULL_WEIGHT, PAIR_WEIGHT = 4.0, 1.0
"""Weights, in logits, of a pull at a door's edge and of a door of its size at one side only: pulls are
opposite to hinges, and doors of a pair open away from each other."""
ALIKE, NEAR, LEVEL = 0.4, 0.25, 0.7
"""Doors are a pair if their widths differ by less than the first share, their gap is less than the second
one of the width, and they overlap in height by more than the third."""
LEFT, RIGHT = HINGES.index("left"), HINGES.index("right")


def weigh_hinges(
    logits: Float[np.ndarray, "N 4"],
    doors: Float[np.ndarray, "N 4"],
    pulls: Float[np.ndarray, "P 4"],
    scores: Float[np.ndarray, "P"],
) -> Float[np.ndarray, "N 4"]:
    """Logits of `HINGES` for each door.

    Args:
        logits: What the network says.
        doors: Boxes of doors (left, top, right, bottom).
        pulls: Boxes of pulls.
        scores: Scores of pulls from 0 to 1.
    """
    out = logits.astype(np.float64).copy()
    for row, door in zip(out, doors, strict=True):
        lean = PULL_WEIGHT * _pull_side(door, pulls, scores) + PAIR_WEIGHT * _pair_side(door, doors)
        row[LEFT] += lean
        row[RIGHT] -= lean
    return out


def _pull_side(
    door: Float[np.ndarray, "4"], pulls: Float[np.ndarray, "P 4"], scores: Float[np.ndarray, "P"]
) -> float:
    """From -1, a certain pull at the left edge, to 1, one at the right; 0 without one."""
    middle = (pulls[:, :2] + pulls[:, 2:]) / 2
    inside = np.flatnonzero(((middle > door[:2]) & (middle < door[2:])).all(axis=1))
    if not len(inside):
        return 0.0
    best = inside[int(np.argmax(scores[inside]))]
    place = (middle[best, 0] - door[0]) / (door[2] - door[0])
    return float((2.0 * place - 1.0) * scores[best])


def _pair_side(door: Sequence[float] | Float[np.ndarray, "4"], doors: Float[np.ndarray, "N 4"]) -> float:
    """1 if a door like this one is at its right only, -1 if at its left only, else 0."""
    x0, y0, x1, y1 = door
    wide, high = x1 - x0, y1 - y0
    level = np.minimum(doors[:, 3], y1) - np.maximum(doors[:, 1], y0)
    like = (level > LEVEL * np.maximum(doors[:, 3] - doors[:, 1], high)) & (
        np.abs(doors[:, 2] - doors[:, 0] - wide) < ALIKE * wide
    )
    at_right = like & (np.abs(doors[:, 0] - x1) < NEAR * wide)
    at_left = like & (np.abs(doors[:, 2] - x0) < NEAR * wide)
    return float(at_right.any()) - float(at_left.any())
