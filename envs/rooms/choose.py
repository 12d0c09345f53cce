"""Chooses and orders the units of a run of cabinets by exact optimisation of soft preferences.

The choice is a small integer programme (HiGHS through scipy), the order an assignment of units to places.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import linear_sum_assignment, milp

from .catalogue import Entry
from .pieces import GAP
from .recipes import Share, pull_along

TALL = 1.27
"""Height (m) above which a unit is not placed in a corner: sinks with their taps are below it."""

EMPTY = 2.5
"""Cost per metre of wall without a unit."""
MISSING = 0.9
"""Cost per unit of deviation from the desired number of a role."""
DEPTH = 3.0
"""Cost per metre of difference from the run's usual depth."""
HEIGHT = 2.5
"""Cost per metre of difference from the run's usual height, for units below 1 m."""
CROWDED = 1.5
"""Cost of a tall unit on a wall that meets other runs at both ends."""
REPEAT = 0.05
"""Cost of every further copy of a package."""
TASTE = 0.25
"""Scale of random costs."""
COPIES = 4
"""Largest number of copies of one package in a run."""


@dataclass(frozen=True, kw_only=True)
class Offer:
    """A package that can fill a share of a run."""

    share: int
    entry: Entry


@dataclass(frozen=True, kw_only=True)
class Wall:
    """Usable length (m) of a wall; ``enclosed`` if other runs meet it at both ends."""

    length: float
    enclosed: bool = False


@dataclass(frozen=True, kw_only=True)
class _Programme:
    """Sizes of the blocks of variables: counts (offer by wall), deviations, repeats, empty walls."""

    offers: int
    walls: int
    shares: int

    @property
    def counts(self) -> int:
        return self.offers * self.walls

    @property
    def total(self) -> int:
        return self.counts + self.shares + self.offers + self.walls


def choose_units(
    offers: Sequence[Offer],
    shares: Sequence[Share],
    walls: Sequence[Wall],
    rng: np.random.Generator,
    most: float = np.inf,
) -> list[list[Offer]] | None:
    """Units for every wall, or None if the smallest numbers of the shares do not fit.

    Args:
        shares: Number of each role over all walls.
        walls: Usable length of each wall, and whether other runs meet it at both ends.
        rng: Breaks ties.
        most: Largest number of units.
    """
    if not offers:
        return None if any(share.least for share in shares) else [[] for _ in walls]
    shape = _Programme(offers=len(offers), walls=len(walls), shares=len(shares))
    costs = np.zeros(shape.total)
    misfits = np.repeat(_misfits(offers, rng)[:, None], shape.walls, axis=1)
    tall = np.array([offer.entry.size[2] > TALL for offer in offers])
    misfits += CROWDED * np.outer(tall, [wall.enclosed for wall in walls])
    costs[: shape.counts] = misfits.ravel()
    costs[shape.counts : shape.counts + shape.shares] = [MISSING * share.weight for share in shares]
    costs[shape.counts + shape.shares : shape.total - shape.walls] = REPEAT
    costs[shape.total - shape.walls :] = EMPTY
    high = np.full(shape.total, np.inf)
    high[: shape.counts] = COPIES
    integrality = np.zeros(shape.total)
    integrality[: shape.counts] = 1
    solved = milp(
        costs,
        constraints=_constraints(shape, offers, shares, [wall.length for wall in walls], most),
        bounds=(np.zeros(shape.total), high),
        integrality=integrality,
        options={"mip_rel_gap": 0.1, "node_limit": 200},
    )
    if solved.x is None:
        return None
    counts = np.round(solved.x[: shape.counts]).astype(int).reshape(shape.offers, shape.walls)
    return [
        [offer for offer, count in zip(offers, counts[:, wall], strict=True) for _ in range(count)]
        for wall in range(shape.walls)
    ]


def _misfits(offers: Sequence[Offer], rng: np.random.Generator) -> Float[np.ndarray, "O"]:
    """Cost of each offer: its difference from the others, and a random cost."""
    sizes = np.array([offer.entry.size for offer in offers])
    low = sizes[:, 2] <= 1.0
    usual = np.median(sizes[low], axis=0) if low.any() else np.median(sizes, axis=0)
    lead = sizes[low][int(rng.integers(low.sum()))] if low.any() else usual
    target = (usual + lead) / 2.0
    misfit = DEPTH * np.abs(sizes[:, 0] - target[0])
    misfit += np.where(low, HEIGHT * np.abs(sizes[:, 2] - target[2]), 0.0)
    return misfit + TASTE * rng.random(len(offers))


def _constraints(
    shape: _Programme,
    offers: Sequence[Offer],
    shares: Sequence[Share],
    lengths: Sequence[float],
    most: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Constraint rows over the variables, with lower and upper bounds of their sums."""
    widths = np.array([offer.entry.size[1] + GAP for offer in offers])
    rows, lower, upper = [], [], []

    def add(row: np.ndarray, low: float, high: float) -> None:
        rows.append(row)
        lower.append(low)
        upper.append(high)

    counts = np.arange(shape.counts).reshape(shape.offers, shape.walls)
    every = np.zeros(shape.total)
    every[counts.ravel()] = 1.0
    add(every, 0.0, most)
    for wall, length in enumerate(lengths):
        row = np.zeros(shape.total)
        row[counts[:, wall]] = widths
        add(row, 0.0, length)
        row = row.copy()
        row[shape.total - shape.walls + wall] = 1.0  # filled and empty length add up to the wall
        add(row, length, np.inf)
    for place, share in enumerate(shares):
        row = np.zeros(shape.total)
        row[counts[[offer.share == place for offer in offers]].ravel()] = 1.0
        add(row, share.least, share.most)
        for sign in (1.0, -1.0):
            off = sign * row
            off[shape.counts + place] = 1.0
            add(off, sign * share.wanted, np.inf)
    for place in range(shape.offers):
        row = np.zeros(shape.total)
        row[counts[place]] = -1.0
        row[shape.counts + shape.shares + place] = 1.0
        add(row, -1.0, np.inf)
    return np.array(rows), np.array(lower), np.array(upper)


def order_units(units: Sequence[Offer], rng: np.random.Generator, corners: Sequence[int]) -> list[Offer]:
    """Units from one end of a run to the other: tall ones away from corners, the stove away from both ends.

    Args:
        rng: Breaks ties.
        corners: Ends (0 first, 1 last) at which another run meets this one.
    """
    if len(units) < 2:
        return list(units)
    places = np.linspace(0.0, 1.0, len(units))
    free = [end for end in (0, 1) if end not in corners] or [0, 1]
    tall_end = float(free[int(rng.integers(len(free)))])
    costs = np.zeros((len(units), len(units)))
    for row, unit in enumerate(units):
        category, height = unit.entry.category, unit.entry.size[2]
        if height > TALL:
            away = 2.0 if height > 1.3 else 0.5
            costs[row] += away * np.abs(places - (0.5 if len(corners) == 2 else tall_end))
        if height > TALL and corners:
            costs[row, [index for index, place in enumerate(places) if place in corners]] += 4.0
        weight, at = pull_along(category)
        costs[row] += weight * np.abs(places - at)
    costs += 0.4 * rng.random(costs.shape)
    row, column = linear_sum_assignment(costs)
    order = np.empty(len(units), dtype=int)
    order[column] = row
    return [units[index] for index in order]
