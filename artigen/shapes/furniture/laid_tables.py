"""Tables whose fronts are laid out: pedestals, drawers hung under the top, and room for knees."""

from dataclasses import dataclass, replace

from artigen.shapes.assembly import Assembly
from artigen.shapes.fittings.hardware import Space
from artigen.shapes.fittings.legs import LegKind, make_legs, place_legs
from artigen.shapes.furniture.cabinet import MAX_DRAWERS_ON_RUNNERS, count_fronts, make_cabinet
from artigen.shapes.furniture.looks import Looks
from artigen.shapes.furniture.splits import Cell, Node, Split, join_cells
from artigen.shapes.ranges import Range, share_down

MODESTY = 0.3
"""Height (m) of the board behind the room for knees."""
KNEES = 0.35
"""Width (m) of a room for knees from which there is one."""
SETBACK = 0.03
"""Distance (m) of the legs of a pedestal from its front."""


@dataclass(frozen=True, kw_only=True)
class Underside:
    """What is below a table's top (m)."""

    x: Range
    y: Range
    height: float
    """Height of the top's underside."""
    looks: Looks
    leg: LegKind
    width: float
    """Thickness of legs."""
    lifted: float
    """Height of the legs of pedestals; 0 for pedestals on the floor."""


def build_under_top(node: Node, under: Underside) -> Assembly:
    """Builds the columns of a layout under a top.

    An open column is room for knees, and a column that ends with an open row hangs from the top; where the
    outermost column is one of these, legs stand at its end. All others are pedestals."""
    split = isinstance(node, Split) and node.along == "columns"
    columns, shares = (node.children, node.shares) if isinstance(node, Split) and split else ((node,), (1.0,))
    left, right = _is_free(columns[0]), _is_free(columns[-1])
    inner = (under.y[0] + (under.width if right else 0.0), under.y[1] - (under.width if left else 0.0))
    if count_fronts(node)["drawer"] > MAX_DRAWERS_ON_RUNNERS:
        under = replace(under, looks=replace(under.looks, runners=False))
    built = Assembly()
    for index, (column, span) in enumerate(zip(columns, share_down(under.y, shares), strict=True)):
        held = (max(span[0], inner[0]), min(span[1], inner[1]))
        built += _build_column(column, held, under, "abcdefgh"[index % 8] * (1 + index // 8))
    legs = place_legs(
        (under.x[0] + 0.02, under.x[1]),
        under.y,
        under.height,
        kind=under.leg,
        width=under.width,
        finish="leg",
    )
    standing = (*(legs[1::2] if left else ()), *(legs[::2] if right else ()))
    return built + Assembly(tuple(piece for leg in standing for piece in leg))


def _is_free(column: Node) -> bool:
    """Whether a column does not reach the floor."""
    last = column.children[-1] if isinstance(column, Split) and column.along == "rows" else column
    return isinstance(last, Cell) and last.fill == "open"


def _build_column(column: Node, y: Range, under: Underside, prefix: str) -> Assembly:
    high = under.height
    if isinstance(column, Cell) and column.fill == "open":
        board = Space(
            x=(under.x[1] - 0.06, under.x[1] - 0.042), y=y, z=(high - min(MODESTY, 0.6 * high), high)
        )
        return Assembly((board.fill("body"),)) if y[1] - y[0] > KNEES else Assembly()
    if isinstance(column, Split) and _is_free(column):
        hung = join_cells("rows", column.shares[:-1], column.children[:-1])
        if isinstance(hung, Split):
            hung = replace(
                hung, board=not all(isinstance(c, Cell) and c.fill == "drawer" for c in hung.children)
            )
        deep = high * sum(column.shares[:-1]) / sum(column.shares)
        return make_cabinet(hung, Space(x=under.x, y=y, z=(high - deep, high)), under.looks, prefix=prefix)
    looks = replace(under.looks, carcass=replace(under.looks.carcass, lid=under.lifted > 0))
    built = make_cabinet(column, Space(x=under.x, y=y, z=(under.lifted, high)), looks, prefix=prefix)
    if not under.lifted:
        return built
    x = (under.x[0] + SETBACK, under.x[1])
    return built + Assembly(make_legs(x, y, under.lifted, kind=under.leg, width=under.width, finish="leg"))
