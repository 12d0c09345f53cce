"""Hollow housings: boards around a cavity that is open to the front, with a lining."""

from artigen.shapes.fittings.hardware import Space
from artigen.shapes.primitives import (
    BACK,
    DOWN,
    FRONT,
    LEFT,
    RIGHT,
    UP,
    Primitive,
    Vector,
    block,
    cylinder,
    line,
)
from artigen.shapes.ranges import Range, margins, narrow

SIDES: dict[str, Vector] = {
    "left": RIGHT,
    "right": LEFT,
    "top": DOWN,
    "bottom": UP,
    "back": FRONT,
    "front": BACK,
}
"""Direction of the inner face of each wall of a housing."""


def build_shell(
    outer: Space,
    inner: Space,
    finish: str,
    lining: str,
    *,
    ends: tuple[str, str] | None = None,
    bevel: float = 0.0,
) -> tuple[Primitive, ...]:
    """Five walls (left, right, top, bottom, back) between two boxes that share their front plane.

    Args:
        outer: Outer box.
        inner: Cavity, which begins at the front of ``outer``.
        finish: Role of the finish of the outside.
        lining: Role of the finish of the cavity.
        ends: Finishes of top and bottom if they differ.
        bevel: Chamfer of the outer edges of the two sides (m).
    """
    top, bottom = ends or (finish, finish)
    x, (y0, y1), (z0, z1) = outer.x, inner.y, inner.z
    walls = (
        ("left", block(x, (y1, outer.y[1]), outer.z, finish, bevel)),
        ("right", block(x, (outer.y[0], y0), outer.z, finish, bevel)),
        ("top", block(x, inner.y, (z1, outer.z[1]), top)),
        ("bottom", block(x, inner.y, (outer.z[0], z0), bottom)),
        ("back", block((inner.x[1], x[1]), inner.y, inner.z, finish)),
    )
    return tuple(line(wall, lining, SIDES[side]) for side, wall in walls)


def build_walls(x: Range, y: Range, z: Range, wall: float, lining: str) -> tuple[Primitive, ...]:
    """Right, left and rear wall of a housing that is ``wall`` metres thick, lined inside."""
    right, left = margins(y, wall)
    walls = (
        ("right", block(x, right, z, "body")),
        ("left", block(x, left, z, "body")),
        ("back", block((x[1] - wall, x[1]), narrow(y, wall), z, "body")),
    )
    return tuple(line(board, lining, SIDES[side]) for side, board in walls)


def build_frame(x: Range, outer: tuple[Range, Range], inner: tuple[Range, Range], finish: str):
    """Four boards around a rectangular hole in the y-z plane: bezels, gaskets, door frames.

    Args:
        x: Front and rear face.
        outer: Ranges (y, z) of the outline.
        inner: Ranges (y, z) of the hole.
        finish: Role of the finish.
    """
    (y, z), (inner_y, inner_z) = outer, inner
    return (
        block(x, (y[0], inner_y[0]), z, finish),
        block(x, (inner_y[1], y[1]), z, finish),
        block(x, inner_y, (z[0], inner_z[0]), finish),
        block(x, inner_y, (inner_z[1], z[1]), finish),
    )


def build_rim(
    x: Range, y: Range, z: Range, wall: float, finish: str, *, sides: bool = False
) -> tuple[Primitive, ...]:
    """Four boards around a rectangle; those in front and behind run through, or with ``sides`` the others."""
    (x0, x1), (y0, y1) = narrow(x, wall), narrow(y, wall)
    across, along = (x, (y0, y1)) if sides else ((x0, x1), y)
    ends = block((x[0], x0), along, z, finish), block((x1, x[1]), along, z, finish)
    flanks = block(across, (y[0], y0), z, finish), block(across, (y1, y[1]), z, finish)
    return (*flanks, *ends) if sides else (*ends, *flanks)


def build_tub(space: Space, wall: float, finish: str, *, sides: bool = True) -> tuple[Primitive, ...]:
    """An open box that fills a space: drawers, crispers, bins; its rim is that of `build_rim`."""
    floor = space.z[0] + wall
    rim = build_rim(space.x, space.y, (floor, space.z[1]), wall, finish, sides=sides)
    return block(space.x, space.y, (space.z[0], floor), finish), *rim


def build_feet(
    x: Range, y: Range, height: float, finish: str, *, radius: float = 0.022, inset: float = 0.05
) -> tuple[Primitive, ...]:
    """Four round feet under a rectangle, from the floor to ``height``."""
    places = [(a, b) for a in narrow(x, inset) for b in narrow(y, inset)]
    return tuple(cylinder((a, b, 0.0), (a, b, height), radius, finish) for a, b in places)
