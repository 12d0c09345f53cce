"""Cutting rectangles into rows and columns, recursively: the nearest tree of cuts."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.shapes.furniture.splits import Axis

SLACK = 0.06
"""Overlap of two neighbours, as a share of the smaller one, that costs nothing: boxes fit to a few per
cent."""
TIE = 0.1
"""Difference in cost below which rows and columns are equally good."""
UNCUT = 10.0
"""Additional cost of a cut through more than the whole of a rectangle."""
RAGGED = 0.1
"""Cost of edges out of line by the whole extent, against overlap by the whole of a rectangle."""


@dataclass(frozen=True, kw_only=True)
class Branch:
    """Rectangles cut into rows or columns, in order; a leaf is the index of a rectangle."""

    along: Axis
    children: tuple["Tree", ...]


Tree = int | Branch
Crossing = tuple[int, int, float]


@dataclass(frozen=True, kw_only=True)
class Cutting:
    """A tree of cuts, and what was wrong with it."""

    tree: Tree
    cost: float
    """About the sum of overlaps at the cuts, each as a share of the smaller neighbour."""
    crossed: tuple[Crossing, ...] = ()
    """Neighbours that overlap at a cut beyond `SLACK`, and by which share of the smaller one."""


def cut_rectangles(rectangles: Float[np.ndarray, "N 4"], alike: Sequence[bool]) -> Cutting:
    """The tree of cuts through the gaps between rectangles with the least overlap at its cuts.

    Args:
        rectangles: Left, top, right and bottom, y down; at least one.
        alike: Whether a rectangle is a drawer; where rows and columns are equally good, drawers alone are cut
            into
            columns of stacks, and others into rows.
    """
    bounds = [tuple(float(value) for value in rectangle) for rectangle in rectangles]
    known: dict[frozenset[int], Cutting] = {}

    def solve(held: frozenset[int]) -> Cutting:
        if held not in known:
            known[held] = _solve(held)
        return known[held]

    def _solve(held: frozenset[int]) -> Cutting:
        if len(held) == 1:
            return Cutting(tree=next(iter(held)), cost=0.0)
        rows, columns = _split("rows", held), _split("columns", held)
        if abs(rows.cost - columns.cost) < TIE:
            return columns if all(alike[index] for index in held) else rows
        return min(rows, columns, key=lambda cutting: cutting.cost)

    def _split(along: Axis, held: frozenset[int]) -> Cutting:
        """The best cut along an axis, joined with further ones along the same."""
        low, high = (1, 3) if along == "rows" else (0, 2)
        order = sorted(held, key=lambda index: (bounds[index][low] + bounds[index][high], index))
        best: Cutting | None = None
        for cost, at, crossing in sorted(_list_cuts(order, low, high)):  # the cleanest first
            if best is not None and cost >= best.cost:
                break
            first, second = order[:at], order[at:]
            parts = [solve(frozenset(side)) for side in (first, second)]
            whole = cost + RAGGED * _measure_rags(first, second, 1 - low) + parts[0].cost + parts[1].cost
            if best is None or whole < best.cost:
                crossed = (crossing,) if crossing[2] > SLACK else ()
                children = tuple(child for part in parts for child in _unwrap(part.tree, along))
                best = Cutting(
                    tree=Branch(along=along, children=children),
                    cost=whole,
                    crossed=(*crossed, *parts[0].crossed, *parts[1].crossed),
                )
        assert best is not None
        return best

    def _list_cuts(order: Sequence[int], low: int, high: int) -> Iterator[tuple[float, int, Crossing]]:
        """Cost of every cut of rectangles in order, its place, and what overlaps most there."""
        for at in range(1, len(order)):
            upper = max(order[:at], key=lambda index: bounds[index][high])
            lower = min(order[at:], key=lambda index: bounds[index][low])
            small = min(bounds[index][high] - bounds[index][low] for index in (upper, lower))
            over = max(0.0, bounds[upper][high] - bounds[lower][low]) / max(small, 1e-9)
            yield max(0.0, over - SLACK) + (UNCUT if over > 1.0 else 0.0), at, (upper, lower, over)

    def _measure_rags(first: Sequence[int], second: Sequence[int], low: int) -> float:
        """Distance between the ends of two neighbours across a cut, as a share of their extent."""
        ends = [
            (min(bounds[index][low] for index in side), max(bounds[index][low + 2] for index in side))
            for side in (first, second)
        ]
        whole = max(end[1] for end in ends) - min(end[0] for end in ends)
        return sum(abs(ends[0][end] - ends[1][end]) for end in (0, 1)) / max(whole, 1e-9)

    return solve(frozenset(range(len(bounds))))


def _unwrap(tree: Tree, along: Axis) -> tuple[Tree, ...]:
    return tree.children if isinstance(tree, Branch) and tree.along == along else (tree,)


def list_leaves(tree: Tree) -> list[int]:
    """The rectangles of a tree, in order."""
    return (
        [tree] if isinstance(tree, int) else [leaf for child in tree.children for leaf in list_leaves(child)]
    )
