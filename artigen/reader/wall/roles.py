"""`find_roles`: what each column of fronts along a kitchen's wall is, and how long a metre is there.

Kitchens are built to few heights, and these tell the scale, the floor, and what each column is."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.kind import Place, kinds
from artigen.reader.labels import KINDS
from artigen.reader.wall.columns import Column

TOE, TOP, HANGS = 0.1, 0.04, 1.45
"""Heights (m) of the lowest fronts above the floor, of what is above the uppermost ones of an object, and of
the undersides of wall cabinets above the floor."""
HUNG = "wall cabinet"
ROLES = ("base cabinet", "larder", "fridge", "range", "dishwasher", "washing machine", HUNG)
LOOSE = 0.1
"""Standard deviation (m) of the heights of fronts' upper edges."""
HUNG_LOOSE = 0.2
"""The same of the ends of what hangs."""
LIFTED = 0.3
"""The same of the lower edges of what stands: the lowest front of a column is often not read."""
KIND_WEIGHT, STRANGE = 2.0, 12.0
"""Weight of the kinds that are read against heights, and cost from which a column is none of these."""
SCALES = np.geomspace(0.4, 4.0, 35)
"""Heights (m) of all fronts together that are tried."""


@dataclass(frozen=True, kw_only=True)
class Metre:
    """Lengths of the plane in metres."""

    across: float
    along: float
    """Metres per unit of x and of y."""
    floor: float
    """y of the floor."""

    def height(self, y: float) -> float:
        """Height (m) above the floor."""
        return (self.floor - y) * self.along


def find_place(role: str) -> tuple[str, Place]:
    """The first kind that fills a role, and its sizes there."""
    return next((name, place) for name in KINDS for place in kinds()[name].places if place.role == role)


def _usual_height(role: str) -> float:
    _, place = find_place(role)
    return place.draws[0][2] if place.draws else (place.low[2] + place.high[2]) / 2


def find_roles(
    stacks: Sequence[Sequence[Sequence[Column]]], aspect: float
) -> tuple[Metre, list[Column], list[str | None]]:
    """The scale at which all columns have the heights of a kitchen, the columns from left to right, and what
    each of them is."""
    bounds = np.stack([column.bounds for stack in stacks for column in stack[0]])
    whole = float(bounds[:, 3].max() - bounds[:, 1].min())
    along = SCALES / whole
    floor = bounds[:, 3].max() + TOE / along
    costs = {
        id(column): _cost_columns(column, along, floor) for stack in stacks for way in stack for column in way
    }
    rated = [
        np.stack(
            [sum(_weigh(one) * costs[id(one)].min(axis=1).clip(max=STRANGE) for one in way) for way in stack]
        )
        for stack in stacks
    ]
    best = int(np.sum([ways.min(axis=0) for ways in rated], axis=0).argmin())
    chosen = [
        one for stack, ways in zip(stacks, rated, strict=True) for one in stack[int(ways[:, best].argmin())]
    ]
    chosen.sort(key=lambda one: float(one.bounds[0]))
    rows = [costs[id(one)][best] for one in chosen]
    scale = float(along[best])
    return (
        Metre(across=scale * aspect, along=scale, floor=float(floor[best])),
        chosen,
        [ROLES[int(row.argmin())] if row.min() < STRANGE else None for row in rows],
    )


def _cost_columns(
    column: Column, along: Float[np.ndarray, "G"], floor: Float[np.ndarray, "G"]
) -> Float[np.ndarray, "G R"]:
    """Cost of every role at every scale."""
    low, high = ((floor - float(y)) * along for y in (column.bounds[3], column.bounds[1]))
    return np.stack([_cost_kind(column, role) + _cost_height(role, low, high) for role in ROLES], axis=1)


def _weigh(column: Column) -> float:
    """Area of a column."""
    return float((column.bounds[2:] - column.bounds[:2]).prod())


def _cost_kind(column: Column, role: str) -> float:
    """Cost of what a column looks like: appliances by their kind, furniture by that of none of these."""
    appliances = {find_place(name)[0] for name in ROLES} - {find_place(HUNG)[0]}
    own = find_place(role)[0]
    share = column.shares[own] if own in appliances else 1.0 - sum(column.shares[name] for name in appliances)
    return -KIND_WEIGHT * float(np.log(max(share, np.finfo(np.float16).eps)))


def _cost_height(
    role: str, low: Float[np.ndarray, "G"], high: Float[np.ndarray, "G"]
) -> Float[np.ndarray, "G"]:
    """Squared differences of the ends of a column from usual heights (m), in standard deviations."""
    if role == HUNG:
        top = HANGS + _usual_height(role)
        return ((low - HANGS) / HUNG_LOOSE) ** 2 + ((high - top) / HUNG_LOOSE) ** 2
    return ((low - TOE) / LIFTED) ** 2 + ((high - _usual_height(role) + TOP) / LOOSE) ** 2
