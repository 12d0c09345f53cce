"""From a tree of cuts to the cells of a cabinet: fronts where they are, and open cells where nothing
covers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.reader.layout.cutting import Tree, list_leaves
from artigen.reader.reading import ReadPart
from artigen.shapes.furniture.splits import Axis, Cell, Fill, Node, Split

OPEN = 0.12
"""Width or height (m) from which what no front covers is an open cell; below it is a frame, rail or
worktop."""
OPEN_SHARE = np.array([0.2, 0.1])
"""The same as a share of the width and height of the object's front, so that errors of boxes at a large one
open nothing; boxes of views from the side err more in width."""
BOARD = 0.016
"""Difference (m) between the front of a cell and its opening between boards."""
LEAST = 0.05
"""Least width and height (m) of a cell."""
EVEN = 0.15
"""Difference of the widths of two leaves, as a share of the wider one, up to which they are a pair."""
WIDEST_PAIR = 1.3
"""Width (m) up to which two leaves close one opening."""
WIDEST_LEAF = 0.75
"""Width (m) from which a leaf is too wide for hinges."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Seen:
    """A front on the plane of fronts."""

    part: ReadPart
    bounds: Float[np.ndarray, "4"]
    """Left, top, right, bottom (m), y down."""
    handles: int
    """Number of handles on it."""
    hinge: str | None
    """Side of its hinges, as read or opposite to its handle."""

    @property
    def width(self) -> float:
        return float(self.bounds[2] - self.bounds[0])


def make_cells(
    tree: Tree,
    fronts: Sequence[Seen],
    region: Float[np.ndarray, "4"],
    *,
    framed: bool = False,
    aside: bool = True,
) -> Node:
    """The layout of a cabinet whose front is a region, with fronts where they were seen.

    Args:
        tree: Cuts of the fronts.
        fronts: What the leaves of the tree are.
        region: Left, top, right and bottom (m), y down; it holds all fronts.
        framed: Whether a face frame shows between all fronts, stacked drawers included.
        aside: Whether what no front covers at the left or right end is open, such as the room for knees under
            a desk; else it is a board, since a front was missed there.
    """
    whole = region[2:] - region[:2]
    least = np.maximum(OPEN, OPEN_SHARE * whole)
    hull = np.concatenate(
        [
            np.min([front.bounds[:2] for front in fronts], 0),
            np.max([front.bounds[2:] for front in fronts], 0),
        ]
    )
    wide = (hull - region) * (1, 1, -1, -1) >= np.tile(least, 2)
    beside = Cell(fill="open" if aside else "blank")
    inner = np.where(wide & np.array([False, True] * 2), region, hull)
    node = _fill(tree, fronts, inner, least)  # the carcass is what remains
    ends: list[tuple[Node, float]] = [(node, inner[2] - inner[0])]
    ends[:0] = [(beside, hull[0] - region[0])] if wide[0] else []
    ends += [(beside, region[2] - hull[2])] if wide[2] else []
    node = join_nodes("columns", ends)
    return _board_all(node) if framed else node


def _board_all(node: Node) -> Node:
    if isinstance(node, Cell):
        return node
    return replace(node, board=True, children=tuple(_board_all(child) for child in node.children))


def _fill(
    tree: Tree,
    fronts: Sequence[Seen],
    region: Float[np.ndarray, "4"],
    least: Float[np.ndarray, "2"],
) -> Node:
    """The node of a tree in its region, with open cells or boards around it where there is room."""
    held = [fronts[leaf] for leaf in list_leaves(tree)]
    hull = np.concatenate(
        [np.min([front.bounds[:2] for front in held], 0), np.max([front.bounds[2:] for front in held], 0)]
    )
    inner = region.copy()
    wide = (hull - region) * (1, 1, -1, -1) >= np.tile(least, 2)
    inner[wide] = hull[wide]
    node = _place(tree, fronts, inner, least)
    axes: tuple[tuple[Axis, int], ...] = (("columns", 0), ("rows", 1))
    for along, low in axes:
        before, after = inner[low] - region[low], region[low + 2] - inner[low + 2]
        sides: list[tuple[Node, float]] = [(Cell(fill="open"), before)] if wide[low] else []
        sides.append((node, inner[low + 2] - inner[low]))
        sides += [(Cell(fill="open"), after)] if wide[low + 2] else []
        node = join_nodes(along, sides)
    return node


def _place(
    tree: Tree, fronts: Sequence[Seen], region: Float[np.ndarray, "4"], least: Float[np.ndarray, "2"]
) -> Node:
    """The node of a tree whose fronts cover its region, but for gaps."""
    if isinstance(tree, int):
        return _close(fronts[tree])
    low = 1 if tree.along == "rows" else 0
    spans = [
        (
            min(float(fronts[leaf].bounds[low]) for leaf in list_leaves(child)),
            max(float(fronts[leaf].bounds[low + 2]) for leaf in list_leaves(child)),
        )
        for child in tree.children
    ]
    done: list[tuple[Node, float]] = []
    start = float(region[low])
    pair: tuple[Seen, Seen] | None = None
    for index, child in enumerate(tree.children):
        last = index == len(spans) - 1
        after = 0.0 if last else spans[index + 1][0] - spans[index][1]
        gap = after if after >= least[low] else 0.0
        end = float(region[low + 2]) if last else spans[index][1] + (0.0 if gap else after / 2)
        own = region.copy()
        own[low], own[low + 2] = start, max(end, start + LEAST)
        following = None if last else tree.children[index + 1]
        if pair is not None:
            _, extent = done.pop()
            done.append((_pair_up(*pair), extent + end - start))
            pair = None
        else:
            done.append((_fill(child, fronts, own, least), end - start))
            if tree.along == "columns" and isinstance(child, int) and isinstance(following, int) and not gap:
                pair = (fronts[child], fronts[following])
                pair = pair if is_pair(*pair) else None
        if gap:
            done.append((Cell(fill="open"), gap))
        start = end + gap
    return join_nodes(tree.along, done)


def is_pair(left: Seen, right: Seen) -> bool:
    """Whether two neighbouring doors close one opening: hinged on both sides alike, or sliding."""
    if left.part.label != "door" or right.part.label != "door" or left.part.pane != right.part.pane:
        return False
    wide = max(left.width, right.width)
    even = abs(left.width - right.width) <= EVEN * wide
    if left.hinge == "left" and right.hinge == "right":
        return even and left.width + right.width <= WIDEST_PAIR and left.handles == right.handles
    return even and left.hinge is None and right.hinge is None and min(left.width, right.width) >= WIDEST_LEAF


def _pair_up(left: Seen, right: Seen) -> Cell:
    fill: Fill = "double" if left.hinge else "slide"
    return Cell(fill=fill, handles=max(left.handles, right.handles), pane=left.part.pane)


def _close(front: Seen) -> Cell:
    """The cell behind one front; a door of unknown hinges has its edge set later."""
    if front.part.label == "drawer":
        return Cell(fill="drawer", handles=front.handles)
    cell = Cell(fill="door", handles=front.handles, pane=front.part.pane)
    if front.hinge == "bottom":
        return replace(cell, fill="drop")
    if front.hinge == "top":
        return replace(cell, fill="lift")
    return replace(cell, edge="right" if front.hinge == "right" else "left")


def join_nodes(along: Axis, sides: Sequence[tuple[Node, float]]) -> Node:
    """Nodes of given extents (m) in rows or columns; one as it is, and those along the same axis side by
    side."""
    if len(sides) == 1:
        return sides[0][0]
    flat: list[tuple[Node, float]] = []
    for node, extent in sides:
        if isinstance(node, Split) and node.along == along:
            scale = extent / sum(node.shares)
            flat += [(child, share * scale) for child, share in zip(node.children, node.shares, strict=True)]
        else:
            flat.append((node, extent))
    drawers = all(isinstance(node, Cell) and node.fill == "drawer" for node, _ in flat)
    board = not (along == "rows" and drawers)
    shares = tuple(max(LEAST, float(extent)) - (BOARD if board else 0.0) for _, extent in flat)
    return Split(along=along, shares=shares, children=tuple(node for node, _ in flat), board=board)
