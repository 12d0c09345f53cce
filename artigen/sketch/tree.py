"""Rigid bodies of a shape and their tree."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from artigen.shapes.shape import Shape


@dataclass(frozen=True, kw_only=True, eq=False)
class Tree:
    """Parts by index. A rigid body is identified by its leading part: one that moves, or the root.

    Attributes:
        leaders: For every part the leading part of its rigid body.
        ancestors: For every part the leaders of the bodies that carry its own, nearest first.
    """

    leaders: Int[np.ndarray, "P"]
    ancestors: tuple[tuple[int, ...], ...]

    def carried(self, index: int) -> list[int]:
        """Leaders of all bodies that move with the body of a part, its own included."""
        return [
            leader
            for leader in np.unique(self.leaders).tolist()
            if leader == index or index in self.ancestors[leader]
        ]


def read_tree(shape: Shape) -> Tree:
    """Merges fixed parts with their parents, as an exporter does."""
    rows = {part.name: row for row, part in enumerate(shape.parts)}
    parents = [None if part.parent is None else rows[part.parent] for part in shape.parts]
    leaders = [_lead(shape, parents, row) for row in range(len(parents))]
    ancestors = []
    for leader in leaders:
        chain, at = [], parents[leader]
        while at is not None:
            chain.append(leaders[at])
            at = parents[leaders[at]]
        ancestors.append(tuple(chain))
    return Tree(leaders=np.array(leaders), ancestors=tuple(ancestors))


def _lead(shape: Shape, parents: list[int | None], row: int) -> int:
    at = row
    parent = parents[at]
    while shape.parts[at].joint is None and parent is not None:
        at = parent
        parent = parents[at]
    return at
