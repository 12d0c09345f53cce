"""What is in the cells of a layout that was read, and simpler layouts where engines hold no more."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from artigen.kind import name_kind
from artigen.reader.layout.fronts import View
from artigen.shapes.furniture.layouts import Layout
from artigen.shapes.furniture.splits import Cell, Node

PITCH = (0.26, 0.4)
"""Usual distances (m) of shelves behind a door."""
TALL = 1.1
"""Height (m) from which a wardrobe's cell may have a clothes rail."""
RAIL = 0.7
"""Probability of one."""
SHELVED = 0.65
"""Probability of shelves behind doors."""
SPAN = 1.3
"""Width (m) from which loose shelves would bend."""
CLOSED = 0.6
"""Share of a place without a front that has the colour of the nearest front, from which it is a board: false
open cells of the photographs have 0.67 to 0.98, niches and the room for knees under desks 0.44 at most."""


def furnish_node(
    rng: np.random.Generator,
    node: Node,
    size: tuple[float, float],
    view: View,
    kind: str,
    at: tuple[float, float] = (0.0, 0.0),
) -> Node:
    """A layout with contents: shelves of open cells as they were seen, boards where those are closed, what
    doors hide drawn.

    Args:
        rng: Stream of what is not seen.
        node: The layout.
        size: Its width and height (m).
        view: Where shelves and closed surface were seen.
        kind: Kind of the object.
        at: Its upper left corner (m).
    """
    if isinstance(node, Cell):
        return _furnish_cell(rng, node, size, view, kind, at)
    along = 1 if node.along == "rows" else 0
    start, whole = list(at), sum(node.shares)
    children: list[Node] = []
    for child, share in zip(node.children, node.shares, strict=True):
        own = list(size)
        own[along] *= share / whole
        children.append(furnish_node(rng, child, (own[0], own[1]), view, kind, (start[0], start[1])))
        start[along] += own[along]
    return replace(node, children=tuple(children))


def _furnish_cell(
    rng: np.random.Generator,
    cell: Cell,
    size: tuple[float, float],
    view: View,
    kind: str,
    at: tuple[float, float],
) -> Cell:
    width, height = size
    pitch, shelved, railed = rng.uniform(*PITCH), rng.random() < SHELVED, rng.random() < RAIL
    if cell.fill == "open":
        seen = int(_is_within(view.shelves, at, size).sum())
        if seen:
            return replace(cell, inside="shelves", count=seen)
        own = view.closed[_is_within(view.looked, at, size)]
        shut = own.size > 0 and own.mean() >= CLOSED
        return replace(cell, fill="blank") if shut else cell
    if cell.fill in ("drawer", "blank", "slide"):
        return cell
    if kind == name_kind("wardrobe") and height > TALL and railed:
        return replace(cell, inside="rod", count=1)
    count = int(height / pitch - 0.3)
    if not shelved or count < 1 or width > SPAN:
        return cell
    return replace(cell, inside="shelves", count=count)


def _is_within(
    points: Float[np.ndarray, "N 2"], at: tuple[float, float], size: tuple[float, float]
) -> Bool[np.ndarray, "N"]:
    return np.asarray(((points >= at) & (points <= np.add(at, size))).all(axis=1))


def simplify(layout: Layout, size: tuple[float, float, float]) -> Layout | None:
    """The nearest layout with fewer solids; None if there is none.

    Shelves go first, then boards between stacked drawers, then the face frame; after that the smallest two
    alike neighbours become one."""
    bare = replace(layout, node=_empty(layout.node))
    for simpler in (
        bare,
        replace(bare, node=_unboard(bare.node)),
        replace(bare, node=_unboard(bare.node), gap=0.0),
    ):
        if simpler != layout and (layout.gap != 0.0 or simpler.node != layout.node):
            return simpler
    width, _, height = size
    found = sorted(_list_pairs(layout.node, width, height, ()), key=lambda pair: pair[0])
    return replace(layout, node=_merge_at(layout.node, found[0][1])) if found else None


def _empty(node: Node) -> Node:
    if isinstance(node, Cell):
        return replace(node, inside="empty", count=0)
    return replace(node, children=tuple(_empty(child) for child in node.children))


def _unboard(node: Node) -> Node:
    """Without the boards between stacked drawers."""
    if isinstance(node, Cell):
        return node
    drawers = all(isinstance(child, Cell) and child.fill == "drawer" for child in node.children)
    board = node.board and not (drawers and node.along == "rows")
    return replace(node, board=board, children=tuple(_unboard(child) for child in node.children))


def _list_pairs(
    node: Node, width: float, height: float, path: tuple[int, ...]
) -> Iterator[tuple[float, tuple[int, ...]]]:
    """Areas of alike neighbours, and the way to the first of each."""
    if isinstance(node, Cell):
        return
    whole = sum(node.shares)
    for index, (child, share) in enumerate(zip(node.children, node.shares, strict=True)):
        wide, high = (
            (width, height * share / whole) if node.along == "rows" else (width * share / whole, height)
        )
        yield from _list_pairs(child, wide, high, (*path, index))
        following = node.children[index + 1 : index + 2]
        if isinstance(child, Cell) and any(
            isinstance(other, Cell) and other.fill == child.fill for other in following
        ):
            yield width * height * (share + node.shares[index + 1]) / whole, (*path, index)


def _merge_at(node: Node, path: tuple[int, ...]) -> Node:
    if isinstance(node, Cell):
        return node
    at, *rest = path
    if rest:
        children = (*node.children[:at], _merge_at(node.children[at], tuple(rest)), *node.children[at + 1 :])
        return replace(node, children=children)
    shares = (*node.shares[:at], node.shares[at] + node.shares[at + 1], *node.shares[at + 2 :])
    children = (*node.children[: at + 1], *node.children[at + 2 :])
    return children[0] if len(children) == 1 else replace(node, shares=shares, children=children)
