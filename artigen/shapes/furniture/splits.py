"""A split grammar for the fronts of furniture: how a front is divided, and what each cell holds.

A `Node` is a `Cell`, or a `Split` of a rectangle into rows (top to bottom) or columns (left to right, seen
from the front) with proportions. `draw_node` derives one from a `Taste` by rules whose weights depend on the
space, `mirror` reflects it, and `lay_out` gives every cell its opening and front.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from artigen.shapes.choices import choose, choose_one, pick
from artigen.shapes.fittings.hardware import Edge
from artigen.shapes.ranges import Range, share_down

Fill = Literal["open", "drawer", "door", "double", "drop", "lift", "fold", "slide", "blank"]
Inside = Literal["empty", "shelves", "trays", "rod"]
Axis = Literal["rows", "columns"]

FRONT_GAP = 0.003
"""Gap (m) between two fronts."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """The closure of an opening and the contents behind it."""

    fill: Fill
    edge: Edge = "left"
    """Hinged edge of a single door, fixed edge of a folding pair."""
    inside: Inside = "empty"
    count: int = 0
    """Number of shelves or trays."""
    handles: int | None = None
    """Number of handles on each front; None for the usual."""
    pane: bool | None = None
    """Whether its doors are glazed; None for what the design says."""


@dataclass(frozen=True, kw_only=True)
class Split:
    """A rectangle divided into rows or columns; ``board`` says whether boards separate them."""

    along: Axis
    shares: tuple[float, ...]
    children: tuple["Node", ...]
    board: bool = True


Node = Cell | Split


@dataclass(frozen=True, kw_only=True)
class Taste:
    """Preferences of a kind of furniture: relative weights, lengths in metres."""

    module: Range = (0.36, 0.75)
    """Width of a column."""
    drawer: Range = (0.11, 0.32)
    """Height of a drawer front."""
    rules: tuple[tuple[str, float], ...] = (("columns", 1.0), ("stack", 1.0), ("closed", 2.0), ("open", 0.4))
    fills: tuple[tuple[Fill, float], ...] = (("door", 3.0), ("double", 2.0))
    """Closures of closed cells."""
    symmetry: float = 0.8
    """Probability that columns of mirrored widths are mirror images."""
    shelf_pitch: Range = (0.24, 0.38)
    rod: float = 0.0
    """Probability of a hanging rod where there is space for clothes."""
    trays: float = 0.15
    """Probability of trays behind a door."""
    levels: int = 3
    """Maximum depth of nested splits."""


@dataclass(frozen=True, kw_only=True)
class Room:
    """The rectangle of a node (m), and its derivation."""

    width: float
    height: float
    bottom: float
    """Height of its lower edge above the floor."""
    level: int = 0
    within: str = ""
    """The rule that made it; no rule follows itself."""


@dataclass(frozen=True, kw_only=True)
class Placed:
    """A cell with its opening between boards, its front, and the edges next to other fronts."""

    cell: Cell
    y: Range
    z: Range
    front_y: Range
    front_z: Range
    room_y: Range
    """The free space behind the opening, larger than the opening if a face frame narrows that."""
    shared: frozenset[Edge] = field(default_factory=frozenset)


def draw_node(rng: np.random.Generator, room: Room, taste: Taste) -> Node:
    """Derives the node of a room by one of the applicable rules, chosen by weight."""
    weights = {
        name: weight * _RULES[name][0](room, taste)
        for name, weight in taste.rules
        if name != room.within and not (name in ("columns", "rows") and room.level >= taste.levels)
    }
    weights = {name: weight for name, weight in weights.items() if weight > 0}
    if not weights:
        return _draw_open(rng, room, taste)
    return _RULES[pick(rng, weights)][1](rng, room, taste)


def mirror(node: Node) -> Node:
    """The node with left and right exchanged."""
    if isinstance(node, Cell):
        flipped: dict[Edge, Edge] = {"left": "right", "right": "left"}
        return replace(node, edge=flipped.get(node.edge, node.edge))
    children = tuple(mirror(child) for child in node.children)
    if node.along == "columns":
        return replace(node, shares=node.shares[::-1], children=children[::-1])
    return replace(node, children=children)


def turn_doors(node: Node, edge: Edge) -> Node:
    """The node with all its single doors hinged on one side."""
    if isinstance(node, Cell):
        return replace(node, edge=edge)
    return replace(node, children=tuple(turn_doors(child, edge) for child in node.children))


def lay_out(
    node: Node,
    y: Range,
    z: Range,
    *,
    board: float,
    reach: dict[Edge, float],
    inset: bool,
    overlay: float | None = None,
) -> tuple[tuple[Placed, ...], tuple[tuple[Range, Range], ...]]:
    """Openings and fronts of all cells, and the boards between them as (y, z) rectangles.

    Args:
        node: The layout.
        y: Right and left edge of the opening (m).
        z: Lower and upper edge.
        board: Thickness of inner boards.
        reach: Extent of fronts beyond the opening at each edge; negative for a front within it.
        inset: Whether fronts stay within openings at inner boards, too.
        overlay: Overlap (m) of fronts with inner boards; default: as far as possible.
    """
    if isinstance(node, Cell):
        front_y = (y[0] - reach["right"], y[1] + reach["left"])
        front_z = (z[0] - reach["bottom"], z[1] + reach["top"])
        return (Placed(cell=node, y=y, z=z, front_y=front_y, front_z=front_z, room_y=y),), ()
    rows = node.along == "rows"
    thick = board if node.board else 0.0
    most = (board - FRONT_GAP) / 2
    over = most if overlay is None else min(overlay, most)
    inner = -FRONT_GAP / 2 if not node.board else -FRONT_GAP if inset else over
    first: Edge = "top" if rows else "left"
    last: Edge = "bottom" if rows else "right"
    cells: list[Placed] = []
    boards: list[tuple[Range, Range]] = []
    spans = share_down(z if rows else y, node.shares, thick)
    for index, (span, child) in enumerate(zip(spans, node.children, strict=True)):
        own = dict(reach)
        own |= {first: inner} if index > 0 else {}
        own |= {last: inner} if index < len(spans) - 1 else {}
        at_y, at_z = (y, span) if rows else (span, z)
        below, more = lay_out(child, at_y, at_z, board=board, reach=own, inset=inset, overlay=overlay)
        shared: set[Edge] = set()
        shared |= {first} if index > 0 else set()
        shared |= {last} if index < len(spans) - 1 else set()
        cells += [replace(cell, shared=cell.shared | shared) for cell in below]
        boards += more
    if node.board:
        for upper, lower in pairwise(spans):
            gap = (lower[1], upper[0])
            boards.append((y, gap) if rows else (gap, z))
    return tuple(cells), tuple(boards)


COLUMNS = {
    2: ((1, 1), (1, 1), (1, 1.618), (1.618, 1), (1, 2), (2, 1)),
    3: ((1, 1, 1), (1, 1, 1), (1, 1.618, 1), (1, 2, 1), (1.3, 1, 1.3), (1, 1, 2)),
    4: ((1, 1, 1, 1), (1, 1, 1, 1), (1, 1.4, 1.4, 1), (1.4, 1, 1, 1.4)),
    5: ((1, 1, 1, 1, 1), (1, 1.3, 1.3, 1.3, 1)),
}


def _columns_fit(room: Room, taste: Taste) -> float:
    """Weight: high if a single front would be too wide, 0 if columns would be too narrow."""
    if room.width < 2 * taste.module[0]:
        return 0.0
    return 1.0 + 8.0 * max(0.0, room.width / taste.module[1] - 1.2)


def _draw_columns(rng: np.random.Generator, room: Room, taste: Taste) -> Node:
    low, high = taste.module
    counts = [n for n in COLUMNS if low <= room.width / n <= high] or [
        n for n in COLUMNS if room.width / n >= low
    ][-1:]
    count = int(rng.choice(counts))
    options = [s for s in COLUMNS[count] if min(s) / sum(s) * room.width >= 0.8 * low]
    shares = choose_one(rng, options) if options else (1.0,) * count
    children: list[Node] = []
    same = rng.random() < 0.35  # repeat the first column
    for index, share in enumerate(shares):
        inner = replace(room, width=room.width * share / sum(shares), level=room.level + 1, within="columns")
        twin = len(shares) - 1 - index
        if index > twin and shares[twin] == share and rng.random() < taste.symmetry:
            children.append(mirror(children[twin]))
        elif same and index and shares[0] == share and index <= twin:
            children.append(children[0])
        else:
            children.append(draw_node(rng, inner, taste))
    if rng.random() < 0.92:  # doors open away from the middle
        half = (len(children) - 1) / 2
        children = [
            turn_doors(child, "left" if index < half else "right") if index != half else child
            for index, child in enumerate(children)
        ]
    return Split(along="columns", shares=tuple(float(s) for s in shares), children=tuple(children))


def _stack_fits(room: Room, taste: Taste) -> float:
    if not (0.2 <= room.width <= 1.25 and taste.drawer[0] * 1.6 <= room.height):
        return 0.0
    if room.bottom + room.height > 1.45:  # drawers above eye level are useless
        return 0.0
    return 1.0 if room.height > 0.3 else 0.4


def _draw_stack(rng: np.random.Generator, room: Room, taste: Taste) -> Node:
    """Stacked drawers: equal, growing downwards, or with shallow ones on top."""
    low, high = taste.drawer
    few, many = max(1, int(np.ceil(room.height / high))), max(1, int(room.height / low))
    count = int(rng.integers(few, min(many, few + 2) + 1)) if many > few else few
    kind = rng.choice(3, p=(0.45, 0.3, 0.25))
    shares = np.ones(count)
    if kind == 1:
        shares = np.linspace(1.0, choose(rng, 1.3, 1.9), count)
    elif kind == 2 and count > 1:
        shares[0] = choose(rng, 0.5, 0.7)
    return stack_drawers(tuple(float(share) for share in shares))


def join_cells(along: Axis, shares: Sequence[float], children: Sequence[Node]) -> Node:
    """Cells in rows or columns; a single one as it is."""
    if len(children) == 1:
        return children[0]
    return Split(along=along, shares=tuple(shares), children=tuple(children))


def draw_order(
    rng: np.random.Generator, swapped: float, along: Axis, shares: Sequence[float], children: Sequence[Node]
) -> Node:
    """Cells in the given order, or with probability ``swapped`` in the reverse one."""
    step = -1 if swapped and rng.random() < swapped else 1
    return join_cells(along, shares[::step], children[::step])


def stack_drawers(shares: tuple[float, ...]) -> Node:
    """Drawers of the given heights from top to bottom, without boards between them."""
    drawer = Cell(fill="drawer")
    if len(shares) == 1:
        return drawer
    return Split(along="rows", shares=shares, children=(drawer,) * len(shares), board=False)


def _draw_drawer_row(rng: np.random.Generator, room: Room, taste: Taste) -> Node:
    """A row of drawers above the rest, sometimes below it."""
    high = choose(rng, taste.drawer[0], min(taste.drawer[1], 0.2))
    count = int(np.clip(round(room.width / rng.uniform(0.4, 0.9)), 1, 4))
    drawers = join_cells("columns", (1.0,) * count, (Cell(fill="drawer"),) * count)
    rest = replace(room, height=room.height - high, level=room.level + 1, within="drawer_row")
    below = draw_node(rng, rest, taste)
    return draw_order(rng, 0.15, "rows", (high, room.height - high), (drawers, below))


def _draw_rows(rng: np.random.Generator, room: Room, taste: Taste) -> Node:
    """A tall space in two: lockers above, drawers below, or two parts in a typical proportion."""
    kind = rng.choice(3, p=(0.25, 0.4, 0.35))
    if kind == 0:
        top = choose(rng, 0.3, 0.42)
    elif kind == 1:
        top = room.height - choose(rng, 0.35, 0.7)
    else:
        top = room.height * float(rng.choice((0.382, 0.5, 0.618)))
    rooms = [
        replace(
            room, height=top, bottom=room.bottom + room.height - top, level=room.level + 1, within="rows"
        ),
        replace(room, height=room.height - top, level=room.level + 1, within="rows"),
    ]
    upper = draw_node(rng, rooms[0], taste)
    stacked = kind == 1 and dict(taste.rules).get("stack", 0) > 0 and _stack_fits(rooms[1], taste) > 0
    lower = _draw_stack(rng, rooms[1], taste) if stacked else draw_node(rng, rooms[1], taste)
    return Split(along="rows", shares=(top, room.height - top), children=(upper, lower))


def _draw_open_row(rng: np.random.Generator, room: Room, taste: Taste) -> Node:
    """An open compartment above or below the rest."""
    high = choose(rng, 0.16, min(0.36, 0.45 * room.height))
    rest = replace(room, height=room.height - high, level=room.level + 1, within="open_row")
    pair = (Cell(fill="open"), draw_node(rng, rest, taste))
    return draw_order(rng, 0.4, "rows", (high, room.height - high), pair)


def _blank_fits(room: Room, taste: Taste) -> bool:
    wide = room.width > 0.75 and room.level == 0
    return wide or (0.55 <= room.height <= 1.0 and room.width > 0.35)


def _draw_blank(rng: np.random.Generator, room: Room, taste: Taste) -> Node:
    """A fixed board: beside a door in a corner, or in place of a drawer below a basin."""
    along: Axis = "columns" if room.width > 0.75 and rng.random() < 0.5 else "rows"
    if room.height < 0.55:
        along = "columns"
    whole = room.width if along == "columns" else room.height
    size = choose(rng, 0.27, 0.42) * whole if along == "columns" else choose(rng, 0.13, 0.19)
    rest = replace(room, level=room.level + 1, within="blank")
    rest = replace(rest, width=whole - size) if along == "columns" else replace(rest, height=whole - size)
    pair = (Cell(fill="blank"), _draw_closed(rng, rest, taste))
    return draw_order(rng, 0.5 if along == "columns" else 0.0, along, (size, whole - size), pair)


def _draw_open(rng: np.random.Generator, room: Room, taste: Taste) -> Node:
    shelves = int(room.height / rng.uniform(*taste.shelf_pitch) - 0.4)
    if room.width > 1.3:
        shelves = 0
    return Cell(fill="open", inside="shelves" if shelves > 0 else "empty", count=max(shelves, 0))


FILL_ROOM: dict[Fill, tuple[Range, Range]] = {
    "door": ((0.2, 0.72), (0.24, 2.3)),
    "double": ((0.46, 1.25), (0.26, 2.3)),
    "drop": ((0.32, 1.1), (0.21, 0.5)),
    "lift": ((0.35, 1.1), (0.23, 0.5)),
    "fold": ((0.52, 1.1), (0.4, 2.2)),
    "slide": ((0.75, 2.4), (0.3, 2.2)),
    "drawer": ((0.2, 1.2), (0.09, 0.42)),
}
"""Usual ranges of width and height of each kind of front (m)."""


def _draw_closed(rng: np.random.Generator, room: Room, taste: Taste) -> Node:
    """A front that suits the size of the space, and the contents behind it."""
    weights: dict[Fill, float] = {fill: weight for fill, weight in taste.fills if _fits(fill, room)}
    if not weights:
        return _draw_open(rng, room, taste)
    fill = pick(rng, weights)
    if fill == "drawer":
        return Cell(fill="drawer")
    edge: Edge = "left" if rng.random() < 0.5 else "right"
    if room.height > 0.9 and rng.random() < taste.rod:
        return Cell(fill=fill, edge=edge, inside="rod", count=1)
    if fill in ("door", "double") and 0.3 < room.height < 1.1 and rng.random() < taste.trays:
        return Cell(fill=fill, edge=edge, inside="trays", count=int(rng.integers(1, 4)))
    shelves = int(room.height / rng.uniform(*taste.shelf_pitch) - 0.3) if rng.random() < 0.65 else 0
    return Cell(fill=fill, edge=edge, inside="shelves" if shelves > 0 else "empty", count=max(shelves, 0))


def _fits(fill: Fill, room: Room) -> bool:
    (narrow, wide), (low, high) = FILL_ROOM[fill]
    return narrow <= room.width <= wide and low <= room.height <= high


Rule = tuple[Callable[[Room, Taste], float], Callable[[np.random.Generator, Room, Taste], Node]]
_RULES: dict[str, Rule] = {
    "columns": (_columns_fit, _draw_columns),
    "rows": (lambda room, taste: room.height > 1.15, _draw_rows),
    "stack": (_stack_fits, _draw_stack),
    "drawer_row": (
        lambda room, taste: 0.42 <= room.height <= 1.3 and room.bottom + room.height <= 1.45,
        _draw_drawer_row,
    ),
    "open_row": (lambda room, taste: room.height > 0.5, _draw_open_row),
    "blank": (_blank_fits, _draw_blank),
    "closed": (
        lambda room, taste: any(weight > 0 and _fits(fill, room) for fill, weight in taste.fills),
        _draw_closed,
    ),
    "open": (lambda room, taste: True, _draw_open),
}
