"""Components of tables besides legs: tops with round corners or ends, aprons, stretchers, closed sides."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Literal, get_args

import numpy as np

from artigen.shapes.fittings.hardware import Space
from artigen.shapes.fittings.mouldings import UPPER, build_moulding
from artigen.shapes.fittings.outlines import trace_corners
from artigen.shapes.primitives import (
    Primitive,
    Vector,
    block,
    cylinder,
    place_vertices,
    polytope,
    prism,
)
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart

TopKind = Literal["plain", "rounded", "oval", "ellipse"]
"""A rectangle, a rectangle with round corners, one with semicircular ends, or an ellipse."""
StretcherKind = Literal["h", "ring", "rear"]
"""Stretchers at both sides, joined by one in the middle, by one in front and one behind, or by one behind."""
STRETCHER_KINDS: tuple[StretcherKind, ...] = get_args(StretcherKind)
Side = Literal["front", "back", "right", "left"]
SIDES: tuple[Side, ...] = get_args(Side)
MOULDED = 0.45
"""How far the lower edge of a moulded top is set back, relative to its thickness."""
ROUND_PIECES = 8
"""Straight pieces of a quarter of an elliptic top."""
INNER = float(np.cos(np.pi / (4 * ROUND_PIECES)))
"""Ratio of the inner to the outer extent of such a polygon."""
WALL = 0.02
"""Thickness (m) of aprons."""
PANEL = 0.015
"""Thickness (m) of the boards that close a side."""
ARCH = ((0.0, 1.0), (0.09, 0.62), (0.24, 0.2), (0.38, 0.0))
"""Lower edge of an arched apron: shares of its length and of the rise."""


def make_top(
    width: float, depth: float, z: Range, kind: TopKind, radius: float, *, moulded: bool = False
) -> tuple[Primitive, ...]:
    """A board centred on the object, with round corners of ``radius`` (m); rectangles and ellipses may be
    ``moulded``."""
    x, y = depth / 2, width / 2
    if kind == "plain":
        whole = around(0.0, x), around(0.0, y)
        inset = MOULDED * (z[1] - z[0])
        if moulded:
            return build_moulding(*whole, z, inset, "top", back=True)
        return (block(*whole, z, "top", 0.003),)
    if kind == "ellipse":
        middle = z[1] - UPPER * (z[1] - z[0])
        courses = (
            (((middle, z[1]), 0.0), ((z[0], middle), MOULDED * (z[1] - z[0]))) if moulded else ((z, 0.0),)
        )
        return tuple(cut_ellipse(x - less, y - less, span) for span, less in courses)
    radius = x if kind == "oval" else radius
    inner_x, inner_y = x - radius, y - radius
    boards = [block(around(0.0, x), around(0.0, inner_y), z, "top")]
    if kind == "rounded":
        ends = (-y, -inner_y), (inner_y, y)
        boards += [block(around(0.0, inner_x), (low, high), z, "top") for low, high in ends]
    across = around(0.0, inner_x) if kind == "rounded" else (0.0,)
    corners = [(at_x, at_y) for at_x in across for at_y in (-inner_y, inner_y)]
    return (*boards, *(cylinder((*at, z[0]), (*at, z[1]), radius, "top") for at in corners))


def cut_ellipse(x: float, y: float, z: Range) -> Primitive:
    """A board with the outline of an ellipse of these half axes (m)."""
    flat = trace_corners(around(0.0, x), around(0.0, y), ((x, y),) * 4, ROUND_PIECES)
    return polytope(
        np.concatenate([np.column_stack([flat, np.full(len(flat), level)]) for level in z]), "top"
    )


def inset_of_ellipse(width: float, depth: float, ahead: float) -> float:
    """Distance (m) of legs from the ends of an elliptic top that covers them, ``ahead`` from its edges."""
    share = 1.0 - 2.0 * ahead / depth
    return width / 2 * (1.0 - float(np.sqrt(INNER**2 - share**2)))


def most_radius(ahead: float, aside: float) -> float:
    """Largest corner radius (m) that still covers a leg at the given distance from both edges."""
    return ahead + aside + float(np.sqrt(2 * ahead * aside))


def inset_of_oval(depth: float, ahead: float) -> float:
    """Distance (m) of legs from the ends of an oval top that covers them, ``ahead`` from its long edges."""
    half = depth / 2
    return half - float(np.sqrt(half**2 - (half - ahead) ** 2))


def make_apron(
    x: Range, y: Range, z: Range, leg: float, *, sides: Sequence[Side] = SIDES, arch: float = 0.0
) -> tuple[Primitive, ...]:
    """Apron boards between legs in the rectangle x by y, set back from the legs' outer faces.

    Args:
        x: Outer faces of the legs (m).
        y: Outer faces of the legs (m).
        z: Lower and upper edge of the boards.
        leg: Width of a leg (m).
        sides: Sides that have boards.
        arch: Rise (m) of the arch of the front and rear boards; 0 for straight ones.
    """
    setback = 0.25 * leg
    spans: dict[Side, tuple[Range, Range]] = {
        "front": ((x[0] + setback, x[0] + setback + WALL), narrow(y, leg)),
        "back": ((x[1] - setback - WALL, x[1] - setback), narrow(y, leg)),
        "right": (narrow(x, leg), (y[0] + setback, y[0] + setback + WALL)),
        "left": (narrow(x, leg), (y[1] - setback - WALL, y[1] - setback)),
    }
    made: list[Primitive] = []
    for side in sides:
        span_x, span_y = spans[side]
        if arch and side in ("front", "back"):
            made += make_arch(span_x, span_y, z, arch)
        else:
            made.append(block(span_x, span_y, z, "leg"))
    return tuple(made)


def make_arch(x: Range, y: Range, z: Range, rise: float) -> tuple[Primitive, ...]:
    """An arched board of straight pieces, lower by ``rise`` (m) at both ends."""
    length = y[1] - y[0]
    made: list[Primitive] = []
    for sign, end in ((1.0, y[0]), (-1.0, y[1])):
        edge = [(end + sign * share * length, z[0] - hang * rise) for share, hang in ARCH]
        for near, far in pairwise(edge):
            profile = np.array([near, far, (far[0], z[1]), (near[0], z[1])])
            middle, level = profile.mean(axis=0).tolist()
            start: Vector = (x[0], middle, level)
            made.append(prism(profile - (middle, level), start, (x[1], middle, level), "leg"))
    reach = ARCH[-1][0] * length
    made.append(block(x, narrow(y, reach), z, "leg"))
    return tuple(made)


def make_stretchers(
    legs: Sequence[Primitive], z: float, width: float, kind: StretcherKind
) -> tuple[Primitive, ...]:
    """Bars from leg to leg with lower edges at ``z``; they end at the axes of the legs."""
    x, y = _span_axes(legs)
    up, half = (z, z + 1.3 * width), width / 2
    bars = [Space(x=x, y=around(at, half), z=up) for at in y]
    rows = {"h": (sum(x) / 2,), "ring": x, "rear": (x[1],)}[kind]
    inner = narrow(y, half) if kind == "h" else y
    bars += [Space(x=around(at, half), y=inner, z=up) for at in rows]
    return tuple(bar.fill("leg") for bar in bars)


def make_panels(legs: Sequence[Primitive], z: Range) -> tuple[Primitive, ...]:
    """Boards that close the sides and the back between the legs, at the axes of the legs."""
    x, y = _span_axes(legs)
    half = PANEL / 2
    boards = [Space(x=x, y=around(at, half), z=z) for at in y]
    boards.append(Space(x=around(x[1], half), y=narrow(y, half), z=z))
    return tuple(board.fill("body") for board in boards)


def _span_axes(legs: Sequence[Primitive]) -> tuple[Range, Range]:
    """Axes (x, y) of the outermost legs."""
    low, high = (pick([leg.center for leg in legs], axis=0) for pick in (np.min, np.max))
    return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))


def make_shelf(legs: Sequence[Primitive], z: float) -> ShapePart:
    """A board between the outermost legs, with its upper face at a height."""
    top = z + 0.02
    edges = []
    for piece in legs:
        points = place_vertices(piece)
        middle = piece.center[2]
        low, high = points[points[:, 2] < middle], points[points[:, 2] > middle]
        span = float(low[0, 2]), float(high[0, 2])
        if span[0] < top <= span[1] and piece.center[1] > 0.0:
            share = (top - span[0]) / (span[1] - span[0])
            edges.append((1 - share) * low[:, 1].min() + share * high[:, 1].min())
    x, _ = _span_axes(legs)
    shelf = block((x[0] - 0.004, x[1] + 0.004), around(0.0, float(min(edges))), (z, top), "top")
    return ShapePart("shelf", "shelf", (shelf,))
