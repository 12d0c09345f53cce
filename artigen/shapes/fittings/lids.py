"""Lids and flaps that are hinged at their lower rear edge and open upwards, and the vessels below them.

A lid that turns about its lower rear edge by up to 180 degrees does not collide with the vessel: every point
that starts above the hinge stays above or behind it. A plug, which reaches down within the walls, needs space
before it (`sweep_gap`); an apron, which reaches down outside of them, needs none.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from artigen.shapes.fittings.hardware import Edge, Space, rotate, slide
from artigen.shapes.primitives import BACK, DOWN, FRONT, LEFT, RIGHT, UP, Primitive, block, line, polytope
from artigen.shapes.ranges import Range, margins, narrow
from artigen.shapes.shape import Need, ShapePart, require
from artigen.types import Joint

Rectangle = tuple[Range, Range]
"""Ranges of x and y (m)."""


def hinge_lid(x: Range, y: Range, z: float, upper: float, edge: Edge | None = None) -> Joint:
    """A hinge along one lower edge of a lid or flap that lies from ``z`` upwards over the rectangle x by y.

    Args:
        x: Front and rear edge (m).
        y: Right and left edge (m).
        z: Height of its underside (m).
        upper: Opening angle (rad), at most pi.
        edge: Hinged edge: "left", "right", "bottom" for the front; None for the rear.
    """
    middle = ((x[0] + x[1]) / 2, (y[0] + y[1]) / 2, z)
    axis, origin = {
        None: (LEFT, (x[1], middle[1], z)),
        "bottom": (RIGHT, (x[0], middle[1], z)),
        "left": (FRONT, (middle[0], y[1], z)),
        "right": (BACK, (middle[0], y[0], z)),
    }[edge]
    return rotate(axis, origin, upper)


def make_lid(
    pieces: Sequence[Primitive],
    x: Range,
    y: Range,
    z: float,
    upper: float,
    *,
    name: str = "lid",
    needs: tuple[Need, ...] = (),
    stays: bool = False,
) -> ShapePart:
    """A lid that turns about its lower rear edge by ``upper`` radians (`hinge_lid`).

    With ``stays``, its hinges hold it wherever it is left.
    """
    hinge = replace(hinge_lid(x, y, z, upper), stays=stays)
    return ShapePart(name, "door", pieces, hinge, needs=needs)


def build_vessel(
    bottom: Rectangle, top: Rectangle, z: Range, wall: float, finish: str, *, lining: str | None = None
) -> tuple[Primitive, ...]:
    """A vessel that is open at the top: a floor and four walls, which may lean outwards.

    Args:
        bottom: Outline at the lower end of ``z``.
        top: Outline at its upper end.
        z: From the underside of the floor to the rim (m).
        wall: Thickness (m).
        finish: Role of the finish.
        lining: Role of the finish of the inside; None for that of the outside.
    """
    (bx, by), (tx, ty) = bottom, top
    half = wall / 2  # into the sides: unions of leaning faces that only touch are unclean
    inner = narrow(by, half), narrow(ty, half)
    share = wall / (z[1] - z[0])
    floor_x, floor_y = (
        (low[0] + share * (high[0] - low[0]) + half, low[1] + share * (high[1] - low[1]) - half)
        for low, high in ((bx, tx), (by, ty))
    )
    flanks = zip((LEFT, RIGHT), margins(by, wall), margins(ty, wall), strict=True)
    pieces = [(side, loft((bx, low), (tx, high), z, finish)) for side, low, high in flanks]
    ends = zip((BACK, FRONT), margins(bx, wall), margins(tx, wall), strict=True)
    pieces += [(side, loft((low, inner[0]), (high, inner[1]), z, finish)) for side, low, high in ends]
    pieces.append((UP, block(floor_x, floor_y, (z[0], z[0] + wall), finish)))
    return tuple(solid if lining is None else line(solid, lining, side) for side, solid in pieces)


def make_lift_out(outline: Rectangle, z: Range, wall: float, finish: str) -> ShapePart:
    """An open tray that fills a rectangle and lifts by nearly its height once the lid is open."""
    solids = build_vessel(outline, outline, z, wall, finish)
    lift = slide(0.85 * (z[1] - z[0]), UP)
    return ShapePart("tray", "tray", solids, lift, needs=require("lid"))


def loft(low: Rectangle, high: Rectangle, z: Range, finish: str) -> Primitive:
    """The solid between a rectangle at the lower end of ``z`` and one at its upper end."""
    corners = [(x, y, at) for (xs, ys), at in ((low, z[0]), (high, z[1])) for x in xs for y in ys]
    return polytope(np.array(corners), finish)


def shrink(outline: Rectangle, by: float) -> Rectangle:
    """A rectangle inset by a distance (m) on every side."""
    (x0, x1), (y0, y1) = outline
    return (x0 + by, x1 - by), (y0 + by, y1 - by)


def build_collar(outer: Rectangle, inner: Rectangle, z: Range, finish: str) -> tuple[Primitive, ...]:
    """Boards between two rectangles, on the sides on which they differ; those along x run through."""
    (x, y), (hole_x, hole_y) = outer, inner
    sides = (
        (x, (y[0], hole_y[0])),
        (x, (hole_y[1], y[1])),
        ((x[0], hole_x[0]), hole_y),
        ((hole_x[1], x[1]), hole_y),
    )
    return tuple(block(a, b, z, finish) for a, b in sides if a[0] < a[1] and b[0] < b[1])


def trace_arch(x: Range, z: float, rise: float) -> Float[np.ndarray, "N 2"]:
    """Half an ellipse over a range of x, from front to rear, as seven points (x, z)."""
    turns = np.linspace(0.0, np.pi, 7)
    middle, half = (x[0] + x[1]) / 2, (x[1] - x[0]) / 2
    return np.column_stack([middle - half * np.cos(turns), z + rise * np.sin(turns)])


def build_roof(
    outline: Float[np.ndarray, "N 2"], wall: float, y: Range, finish: str, *, ends: bool = True
) -> tuple[Primitive, ...]:
    """A lid of convex cross-section: plates along its outline, and a board at each end.

    Args:
        outline: Points (x, z) from the front lower edge over the top to the rear one, both at one height.
        wall: Thickness (m), measured about the middle of the lower edges.
        y: Right and left end (m).
        finish: Role of the finish.
        ends: Whether to close the ends.
    """
    foot = np.array([(outline[0, 0] + outline[-1, 0]) / 2, outline[0, 1]])
    reach = np.array([outline[-1, 0] - foot[0], outline[:, 1].max() - foot[1]])
    inner = foot + (outline - foot) * (1.0 - wall / reach)
    out = [*join_outlines(outline, inner, y, finish)]
    for span in margins(y, wall) if ends else ():
        out.append(polytope(np.array([(a, b, c) for b in span for a, c in outline]), finish))
    return tuple(out)


def join_outlines(
    outer: Float[np.ndarray, "N 2"], inner: Float[np.ndarray, "N 2"], y: Range, finish: str
) -> tuple[Primitive, ...]:
    """Plates between two outlines (x, z), one for each of their edges."""
    pairs = pairwise(zip(outer, inner, strict=True))
    return tuple(
        polytope(np.array([(a, b, c) for b in y for a, c in (start, end, under, beyond)]), finish)
        for (start, under), (end, beyond) in pairs
    )


def build_half_shell(space: Space, wall: float, finish: str, lining: str) -> tuple[Primitive, ...]:
    """Four walls and a top that fill a space; it is open below."""
    inner_x, inner_y = narrow(space.x, wall), narrow(space.y, wall)
    (front, rear), (right, left) = margins(space.x, wall), margins(space.y, wall)
    plates = (
        (BACK, block(front, space.y, space.z, finish)),
        (FRONT, block(rear, space.y, space.z, finish)),
        (LEFT, block(inner_x, right, space.z, finish)),
        (RIGHT, block(inner_x, left, space.z, finish)),
        (DOWN, block(inner_x, inner_y, (space.z[1] - wall, space.z[1]), finish)),
    )
    return tuple(line(plate, lining, side) for side, plate in plates)
