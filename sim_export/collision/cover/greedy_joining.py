"""Greedy joining of neighbours, cheapest pair first."""

import heapq
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import TypeVar

import numpy as np

Item = TypeVar("Item")
"""Anything with ``bounds``: lowest and highest corner."""


def join_neighbours(
    items: Sequence[Item], reach: float, join: Callable[[Item, Item], tuple[float, Item] | None]
) -> list[Item]:
    """Joins pairs of items until none can be joined, those first that cost least.

    Args:
        reach: Items whose bounds are farther apart than this along an axis are not neighbours.
        join: The cost of joining two neighbours and the result, or None where they must stay apart.

    Returns:
        What is left.
    """
    alive, bounds_of = dict(enumerate(items)), attrgetter("bounds")
    bounds = np.full((2 * len(items), 2, 3), np.nan)  # of no item, and of none that was joined
    queue: list[tuple[float, int, int, Item]] = []
    count = len(items)

    def offer(new: int, item: Item) -> None:
        low, high = bounds_of(item)
        near = (bounds[:, 0] <= high + reach) & (low <= bounds[:, 1] + reach)
        for other in np.flatnonzero(near.all(axis=1)).tolist():
            found = join(item, alive[other])
            if found is not None:
                heapq.heappush(queue, (found[0], new, other, found[1]))
        bounds[new] = low, high

    for index, item in alive.items():
        offer(index, item)
    while queue:
        _, first, second, both = heapq.heappop(queue)
        if first not in alive or second not in alive:
            continue
        del alive[first], alive[second]
        bounds[[first, second]] = np.nan
        alive[count] = both
        offer(count, both)
        count += 1
    return list(alive.values())
