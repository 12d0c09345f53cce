"""The body of a cabinet: sides, bottom, top, back and the boards between its cells."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from artigen.shapes.fittings.hardware import Range, Space, fill_space
from artigen.shapes.primitives import Primitive, Vector, line
from artigen.shapes.shape import ShapePart

HULL_RATIO = 64.0
"""Longest over shortest edge of a hull that engines take."""
MAX_HULLS_ON_LINK = 32
MAX_HULLS = 256


@dataclass(frozen=True, kw_only=True)
class CarcassDesign:
    """Boards of a body, metres."""

    board: float = 0.018
    """Sides, bottom, top."""
    inner: float = 0.018
    """Boards between cells."""
    back: float = 0.008
    """0 for a body without a back."""
    finish: str = "body"
    lining: str | None = "inside"
    """Finish of what faces the inside; None where boards are alike on both sides."""
    lid: bool = True
    """Whether there is a top board between the sides; without one something else covers them."""


def make_carcass(
    outer: Space, design: CarcassDesign, boards: Iterable[tuple[Range, Range]]
) -> tuple[Primitive, ...]:
    """Boards around the opening of ``outer``, and the inner boards given as (y, z) rectangles.

    Sides run from floor to top, bottom and top between them; the back covers all from behind.
    """
    t = design.board
    x = (outer.x[0], outer.x[1] - design.back)
    y, z = open_carcass(outer, design)
    pieces = [
        _line(
            fill_space(Space(x=x, y=(outer.y[0], y[0]), z=outer.z), design.finish), design, (0.0, 1.0, 0.0)
        ),
        _line(
            fill_space(Space(x=x, y=(y[1], outer.y[1]), z=outer.z), design.finish), design, (0.0, -1.0, 0.0)
        ),
        _line(fill_space(Space(x=x, y=y, z=(outer.z[0], z[0])), design.finish), design, (0.0, 0.0, 1.0)),
    ]
    if design.lid:
        lid = fill_space(Space(x=x, y=y, z=(outer.z[1] - t, outer.z[1])), design.finish)
        pieces.append(_line(lid, design, (0.0, 0.0, -1.0)))
    if design.back:
        back = fill_space(Space(x=(x[1], outer.x[1]), y=outer.y, z=outer.z), design.finish)
        pieces.append(_line(back, design, (-1.0, 0.0, 0.0)))
    inner = design.lining or design.finish
    for span_y, span_z in boards:
        board = fill_space(Space(x=x, y=span_y, z=span_z), inner)
        pieces.append(board if inner == design.finish else line(board, design.finish, (-1.0, 0.0, 0.0)))
    return tuple(pieces)


def open_carcass(outer: Space, design: CarcassDesign) -> tuple[Range, Range]:
    """The opening of a carcass as (y, z)."""
    t = design.board
    top = outer.z[1] - (t if design.lid else 0.0)
    return (outer.y[0] + t, outer.y[1] - t), (outer.z[0] + t, top)


def _line(board: Primitive, design: CarcassDesign, side: Vector) -> Primitive:
    return board if design.lining is None else line(board, design.lining, side)


def count_hulls(primitives: Iterable[Primitive]) -> int:
    """Hulls that engines take for these solids: oblong ones are cut along their longer edges."""
    return sum(
        int(np.prod(np.ceil(primitive.size / (HULL_RATIO * primitive.size.min()) - 1e-9)))
        for primitive in primitives
    )


def fits_engines(parts: Sequence[ShapePart], max_links: int = 60) -> bool:
    """Whether an object stays within what engines hold: links, hulls on a link, hulls in all."""
    owner: dict[str, str] = {}
    hulls: dict[str, int] = {}
    for part in parts:  # parents come first
        fixed = part.motion is None and part.parent is not None
        owner[part.name] = owner[str(part.parent)] if fixed else part.name
        hulls[owner[part.name]] = hulls.get(owner[part.name], 0) + count_hulls(part.primitives)
    counts = list(hulls.values())
    return max(counts) <= MAX_HULLS_ON_LINK and sum(counts) <= MAX_HULLS and len(counts) <= max_links
