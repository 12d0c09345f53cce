"""The side of a door's hinges: what the network says, where its pull is, what stands beside, above and below
it, and on which side doors of its kind usually have them."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from artigen.reader.labels import HINGES

PULL_WEIGHT, PAIR_WEIGHT = 4.0, 1.0
"""Weights, in logits, of a pull at a door's edge and of a door of its size at one side only: pulls are
opposite to hinges, and doors of a pair open away from each other."""
ALIKE, NEAR, LEVEL = 0.4, 0.25, 0.7
"""Doors are a pair if their widths differ by less than the first share, their gap is less than the second
one of the width, and they overlap in height by more than the third."""
STACKED, APART = 0.85, 0.25
"""Doors are stacked if they share more than the first share of their widths, and their gap in height is less
than the second one of the width. All 120 such pairs of the marked photographs have hinges on one side."""
LEFT, RIGHT = HINGES.index("left"), HINGES.index("right")


def weigh_hinges(
    logits: Float[np.ndarray, "N 4"],
    doors: Float[np.ndarray, "N 4"],
    pulls: Float[np.ndarray, "P 4"],
    scores: Float[np.ndarray, "P"],
    left_share: float = 0.5,
) -> Float[np.ndarray, "N 4"]:
    """Logits of `HINGES` for each door.

    Args:
        logits: What the network says.
        doors: Boxes of doors (left, top, right, bottom).
        pulls: Boxes of pulls.
        scores: Scores of pulls from 0 to 1.
        left_share: Share of the doors of this kind with hinges at the left, where no door is beside them.
    """
    out = logits.astype(np.float64).copy()
    usual = np.log(left_share / (1.0 - left_share)) / 2.0
    for row, door in zip(out, doors, strict=True):
        beside = _pair_side(door, doors)
        lean = PULL_WEIGHT * _pull_side(door, pulls, scores) + (PAIR_WEIGHT * beside if beside else usual)
        row[LEFT] += lean
        row[RIGHT] -= lean
    leans = (out[:, LEFT] - out[:, RIGHT]) / 2.0
    for number, one in enumerate(doors):
        others = [k for k, other in enumerate(doors) if k != number and _is_stacked(one, other)]
        out[number, LEFT] += leans[others].sum()
        out[number, RIGHT] -= leans[others].sum()
    return out


def average_shares(kinds: Sequence[tuple[str, float]], shares: Mapping[str, float]) -> float:
    """Share of doors with hinges at the left, over kinds with their probabilities; half where unknown."""
    return sum(probability * shares.get(kind, 0.5) for kind, probability in kinds)


def _is_stacked(one: Float[np.ndarray, "4"], other: Float[np.ndarray, "4"]) -> bool:
    wide = max(one[2] - one[0], other[2] - other[0])
    shared = min(one[2], other[2]) - max(one[0], other[0])
    gap = max(one[1], other[1]) - min(one[3], other[3])
    return bool(shared > STACKED * wide and abs(gap) < APART * wide)


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
