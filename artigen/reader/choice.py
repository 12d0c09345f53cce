"""Which fronts to believe: the likeliest set, given how often objects of a kind have so many doors and
drawers."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

Counts = tuple[int, int]
"""Number of doors and of drawers."""
CountShares = Mapping[str, Mapping[Counts, float]]
"""Share of the objects of a kind that show so many fronts; kinds that have any number of fronts are
missing."""
MOST = 24
"""Largest number of doors, and of drawers, that is considered."""
FLAT = 1.0 / (MOST + 1) ** 2
"""Share of any counts of a kind that is missing, and least share of others, times `UNUSUAL`."""
UNUSUAL = 0.3
"""Share of the objects of a kind that may have any counts."""


def choose_fronts(
    scores: Float[np.ndarray, "N"],
    doors: Float[np.ndarray, "N"],
    kinds: Sequence[tuple[str, float]],
    shares: CountShares,
    *,
    middle: float,
    strength: float,
) -> tuple[list[int], list[bool]]:
    """Indices of the fronts to believe, and whether each is a door.

    The likelihood of a set is the product over its members of the probability that they are there, times that
    of their label relative to the likelier label, and over the others that they are not there. It is
    multiplied with the share of objects with so many doors and drawers, averaged over kinds, to the power of
    ``strength``. The best set is found exactly.

    Args:
        scores: Scores of fronts from 0 to 1.
        doors: Probability that each is a door and not a drawer.
        kinds: Kinds with their probabilities.
        shares: How often objects of a kind have so many doors and drawers.
        middle: Score of a front that is as likely there as not.
        strength: Weight of the shares; with 0, every front above ``middle`` is believed.
    """
    count = len(scores)
    there = _logit(scores) - float(_logit(np.array([middle]))[0])
    gain = -np.logaddexp(0, -there) + np.logaddexp(0, there)  # log p - log (1 - p)
    likelier = np.maximum(doors, 1.0 - doors)
    as_door = gain + np.log(np.clip(doors / likelier, 1e-4, 1.0))
    as_drawer = gain + np.log(np.clip((1.0 - doors) / likelier, 1e-4, 1.0))
    limit = min(count, MOST)
    best = np.full((count + 1, limit + 1, limit + 1), -np.inf)
    best[0, 0, 0] = 0.0
    for index in range(count):
        step = best[index].copy()
        step[1:] = np.maximum(step[1:], best[index, :-1] + as_door[index])
        step[:, 1:] = np.maximum(step[:, 1:], best[index, :, :-1] + as_drawer[index])
        best[index + 1] = step
    prior = np.array([[_share(kinds, shares, (d, w)) for w in range(limit + 1)] for d in range(limit + 1)])
    total = best[count] + strength * np.log(prior)
    d, w = (int(value) for value in np.unravel_index(int(np.argmax(total)), total.shape))
    return _trace(best, as_door, d, w)


def _trace(
    best: Float[np.ndarray, "M D W"],
    as_door: Float[np.ndarray, "N"],
    d: int,
    w: int,
) -> tuple[list[int], list[bool]]:
    """The members of the best set with ``d`` doors and ``w`` drawers."""
    chosen, labels = [], []
    for index in range(len(as_door) - 1, -1, -1):
        value = best[index + 1, d, w]
        if value == best[index, d, w]:
            continue
        is_door = d > 0 and value == best[index, d - 1, w] + as_door[index]
        d, w = (d - 1, w) if is_door else (d, w - 1)
        chosen.append(index)
        labels.append(is_door)
    return chosen[::-1], labels[::-1]


def _share(kinds: Sequence[tuple[str, float]], shares: CountShares, counts: Counts) -> float:
    total = 0.0
    for kind, probability in kinds:
        known = shares.get(kind)
        usual = FLAT if known is None else (1 - UNUSUAL) * known.get(counts, 0.0) + UNUSUAL * FLAT
        total += probability * usual
    return max(total, 1e-9)


def _logit(values: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N"]:
    values = np.clip(values, 1e-4, 1 - 1e-4)
    return np.log(values) - np.log1p(-values)
