"""Hollow housings: boards around a cavity that is open to the front, with a lining."""

from collections.abc import Sequence

from artigen.shapes.fittings.hardware import Range, Space, narrow
from artigen.shapes.primitives import Primitive, Vector, block, box, cylinder, line

SIDES: dict[str, Vector] = {
    "left": (0.0, -1.0, 0.0),
    "right": (0.0, 1.0, 0.0),
    "top": (0.0, 0.0, -1.0),
    "bottom": (0.0, 0.0, 1.0),
    "back": (-1.0, 0.0, 0.0),
    "front": (1.0, 0.0, 0.0),
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
    (x0, x1), (y0, y1), (z0, z1) = outer.x, outer.y, outer.z
    (hx1, (hy0, hy1), (hz0, hz1)) = inner.x[1], inner.y, inner.z
    walls = (
        ("left", block((x0, x1), (hy1, y1), (z0, z1), finish, bevel)),
        ("right", block((x0, x1), (y0, hy0), (z0, z1), finish, bevel)),
        ("top", box((x0, hy0, hz1), (x1, hy1, z1), top)),
        ("bottom", box((x0, hy0, z0), (x1, hy1, hz0), bottom)),
        ("back", box((hx1, hy0, hz0), (x1, hy1, hz1), finish)),
    )
    return tuple(line(wall, lining, SIDES[side]) for side, wall in walls)


def build_frame(x: Range, outer: tuple[Range, Range], inner: tuple[Range, Range], finish: str):
    """Four boards around a rectangular hole in the y-z plane: bezels, gaskets, door frames.

    Args:
        x: Front and rear face.
        outer: Ranges (y, z) of the outline.
        inner: Ranges (y, z) of the hole.
        finish: Role of the finish.
    """
    (y0, y1), (z0, z1) = outer
    (hy0, hy1), (hz0, hz1) = inner
    return (
        block(x, (y0, hy0), (z0, z1), finish),
        block(x, (hy1, y1), (z0, z1), finish),
        block(x, (hy0, hy1), (z0, hz0), finish),
        block(x, (hy0, hy1), (hz1, z1), finish),
    )


def build_tub(space: Space, wall: float, finish: str) -> tuple[Primitive, ...]:
    """An open box that fills a space: drawers, crispers, bins."""
    (x0, x1), (y0, y1), (z0, z1) = space.x, space.y, space.z
    return (
        box((x0, y0, z0), (x1, y1, z0 + wall), finish),
        box((x0, y0, z0 + wall), (x1, y0 + wall, z1), finish),
        box((x0, y1 - wall, z0 + wall), (x1, y1, z1), finish),
        box((x0, y0 + wall, z0 + wall), (x0 + wall, y1 - wall, z1), finish),
        box((x1 - wall, y0 + wall, z0 + wall), (x1, y1 - wall, z1), finish),
    )


def build_feet(
    x: Range, y: Range, height: float, finish: str, *, radius: float = 0.022, inset: float = 0.05
) -> tuple[Primitive, ...]:
    """Four round feet under a rectangle, from the floor to ``height``."""
    places = [(a, b) for a in narrow(x, inset) for b in narrow(y, inset)]
    return tuple(cylinder((a, b, 0.0), (a, b, height), radius, finish) for a, b in places)


def divide_range(span: Range, count: int, gap: float) -> list[Range]:
    """Divides a range into equal intervals with ``gap`` between them."""
    size = (span[1] - span[0] - gap * (count - 1)) / count
    return [(span[0] + k * (size + gap), span[0] + k * (size + gap) + size) for k in range(count)]


def share_range(span: Range, shares: Sequence[float], gap: float) -> list[Range]:
    """Divides a range into intervals proportional to ``shares`` with ``gap`` between them."""
    free = span[1] - span[0] - gap * (len(shares) - 1)
    out: list[Range] = []
    start = span[0]
    for share in shares:
        end = start + free * share / sum(shares)
        out.append((start, end))
        start = end + gap
    return out
