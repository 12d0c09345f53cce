"""The body of a cabinet: sides, bottom, top, back, boards between its cells, and an optional face frame.

A face frame is glued before the boards. Its stiles and rails narrow the openings that fronts close; the space
behind is as wide as the carcass.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from artigen.shapes.appliances.cavity import build_frame
from artigen.shapes.assembly import Assembly
from artigen.shapes.draw import CrowdedError
from artigen.shapes.fittings.hardware import Space
from artigen.shapes.primitives import DOWN, FRONT, LEFT, RIGHT, UP, Primitive, Vector, block, line
from artigen.shapes.ranges import Range, margins, narrow
from artigen.shapes.shape import ShapePart

HULL_RATIO = 59.0
"""Largest ratio of a hull's longest to shortest edge for engines, with a margin for rounding in sketches."""
MAX_HULLS_ON_LINK = 32
MAX_HULLS = 256
MAX_LINKS = 60
LAID_LAYOUTS = 4
"""Designs to try for a given layout, which is mostly what exceeds the limits."""
FRAME_DEPTH = 0.019
"""Thickness (m) of a face frame."""
RAIL = 0.08
"""Width (m) of the rails of an open top and of a hanging rail."""
_SAME = 1e-9
Boards = tuple[tuple[Range, Range], ...]
"""Rectangles (y, z) of the boards between cells."""


@dataclass(frozen=True, kw_only=True)
class CarcassDesign:
    """Boards of a body (m)."""

    board: float = 0.018
    """Thickness of sides, bottom and top."""
    inner: float = 0.018
    """Thickness of boards between cells."""
    back: float = 0.008
    """Thickness of the back; 0 for none."""
    lining: str | None = "inside"
    """Role of the finish of inner faces; None for that of the outside, "body"."""
    lid: bool = True
    """Whether there is a top between the sides; otherwise another part covers them."""
    rails: bool = False
    """Whether the top is two rails, front and back, for a worktop over several cabinets."""
    frame: float = 0.0
    """Width of the stiles and rails of a face frame; 0 for none."""
    recess: float = 0.0
    """Inset of the back between the sides; a hanging rail is then behind it."""


def make_carcass(outer: Space, design: CarcassDesign, boards: Boards) -> tuple[Primitive, ...]:
    """Boards around the opening of ``outer``, and inner boards given as (y, z) rectangles.

    Sides run from floor to top, with bottom and top between them; the back covers all or is inset.
    """
    framed = _make_frame(outer, design, boards) if design.frame else ()
    front = outer.x[0] + (FRAME_DEPTH if design.frame else 0.0)
    x = (front, outer.x[1] - design.back - design.recess)
    deep = (front, outer.x[1] if design.recess else x[1])
    y, z = _inside(outer, design)
    pieces = [*framed]
    for span, side in zip(margins(outer.y, design.board), (LEFT, RIGHT), strict=True):
        pieces.append(_line(block(deep, span, outer.z, "body"), design, side))
    bottom = block(x, y, (outer.z[0], z[0]), "body")
    pieces.append(_line(bottom, design, UP))
    top = (outer.z[1] - design.board, outer.z[1])
    if design.lid and design.rails:
        pieces += [block(span, y, top, "body") for span in margins(x, RAIL)]
    elif design.lid:
        pieces.append(_line(block(x, y, top, "body"), design, DOWN))
    if design.back:
        behind = Space(x=(x[1], x[1] + design.back), y=y if design.recess else outer.y, z=outer.z)
        pieces.append(_line(behind.fill("body"), design, FRONT))
    if design.recess:
        hanging = Space(x=(x[1] + design.back, outer.x[1]), y=y, z=(outer.z[1] - RAIL, outer.z[1]))
        pieces.append(hanging.fill("body"))
    inner = design.lining or "body"
    for rectangle in boards:
        span_y, span_z = _thin_board(rectangle, outer, design, boards) if design.frame else rectangle
        board = block(x, span_y, span_z, inner)
        pieces.append(board if inner == "body" else line(board, "body", FRONT))
    return tuple(pieces)


def open_carcass(outer: Space, design: CarcassDesign) -> tuple[Range, Range]:
    """The opening (y, z) that fronts close: within the face frame, if any."""
    if not design.frame:
        return _inside(outer, design)
    f = design.frame
    return narrow(outer.y, f), narrow(outer.z, f)


def widen(y: Range, z: Range, outer: Space, design: CarcassDesign, boards: Boards) -> tuple[Range, Range]:
    """The free space (y, z) behind an opening: up to sides, bottom, top and boards, which a frame covers."""
    if not design.frame:
        return y, z
    opening, inside = open_carcass(outer, design), _inside(outer, design)
    spare = (design.frame - design.inner) / 2
    spans: list[Range] = []
    for axis, span in enumerate((y, z)):
        ends = []
        for end, sign in ((0, -1.0), (1, 1.0)):
            met = any(abs(board[axis][1 - end] - span[end]) < _SAME for board in boards)
            at_edge = abs(span[end] - opening[axis][end]) < _SAME
            ends.append(inside[axis][end] if at_edge else span[end] + (sign * spare if met else 0.0))
        spans.append((ends[0], ends[1]))
    return spans[0], spans[1]


def _inside(outer: Space, design: CarcassDesign) -> tuple[Range, Range]:
    """The space (y, z) between sides, bottom and top."""
    t = design.board
    top = outer.z[1] - (t if design.lid else 0.0)
    return narrow(outer.y, t), (outer.z[0] + t, top)


def _make_frame(outer: Space, design: CarcassDesign, boards: Boards) -> tuple[Primitive, ...]:
    """A face frame: two stiles, the rails between them, and one member before every board."""
    x = (outer.x[0], outer.x[0] + FRAME_DEPTH)
    frame = build_frame(x, (outer.y, outer.z), open_carcass(outer, design), "body")
    return (*frame, *(block(x, span_y, span_z, "body") for span_y, span_z in boards))


def _thin_board(
    rectangle: tuple[Range, Range], outer: Space, design: CarcassDesign, boards: Boards
) -> tuple[Range, Range]:
    """The board behind a member of a face frame, thinner and longer than the member."""
    (y, z), spare = rectangle, (design.frame - design.inner) / 2
    long_y, long_z = widen(y, z, outer, design, boards)
    if z[1] - z[0] < y[1] - y[0]:
        return long_y, narrow(z, spare)
    return narrow(y, spare), long_z


def _line(board: Primitive, design: CarcassDesign, side: Vector) -> Primitive:
    return board if design.lining is None else line(board, design.lining, side)


def count_hulls(primitives: Iterable[Primitive]) -> int:
    """Number of hulls for these solids in engines; oblong ones are split along their longer edges."""
    return sum(
        int(np.prod(np.ceil(primitive.size / (HULL_RATIO * primitive.size.min()) - 1e-9)))
        for primitive in primitives
    )


def fits_engines(parts: Sequence[ShapePart]) -> bool:
    """Whether an object respects the limits of engines: links, hulls per link, hulls in total."""
    owner: dict[str, str] = {}
    hulls: dict[str, int] = {}
    for part in parts:  # parents come first
        fixed = part.joint is None and part.parent is not None
        owner[part.name] = owner[str(part.parent)] if fixed else part.name
        hulls[owner[part.name]] = hulls.get(owner[part.name], 0) + count_hulls(part.primitives)
    counts = list(hulls.values())
    return max(counts) <= MAX_HULLS_ON_LINK and sum(counts) <= MAX_HULLS and len(counts) <= MAX_LINKS


def draw_fitting(
    category: str,
    size: Sequence[float],
    layouts: int,
    draw: Callable[[int], Assembly],
    suits: Callable[[Sequence[ShapePart]], object] = bool,
) -> tuple[ShapePart, ...]:
    """The parts of the first of several layouts that respects the limits of engines and suits.

    Args:
        category: What is drawn, for the message.
        size: Width, depth and height (m), for the message.
        layouts: Number of layouts to try.
        draw: Draws the object with the layout of this number.
        suits: What else is demanded of the parts.

    Raises:
        CrowdedError: If no layout does.
    """
    for attempt in range(layouts):
        parts = draw(attempt).close()
        if suits(parts) and fits_engines(parts):
            return parts
    lengths = " x ".join(f"{length:.3g}" for length in size)
    raise CrowdedError(
        f"{category}: none of {layouts} layouts of {lengths} m (width, depth, height) respects the limits of "
        "engines; request a smaller one"
    )
