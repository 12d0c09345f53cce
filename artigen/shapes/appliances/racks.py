"""Wire racks, baskets and sheet pans of ovens, dishwashers and refrigerators."""

import numpy as np

from artigen.shapes.fittings.hardware import Space
from artigen.shapes.primitives import Primitive, box, cylinder

SLENDER = 55.0
"""Largest ratio of a rod's length to its thickness; engines mishandle longer ones."""


def wire_gauge(length: float, least: float = 0.006) -> float:
    """Thickness (m) of a wire of length ``length``."""
    return max(least, length / SLENDER)


def build_rack(space: Space, finish: str, *, bars: int, lip: float = 0.0) -> tuple[Primitive, ...]:
    """A flat wire rack at the bottom of a space: a frame, bars from front to back, a raised rear stop.

    The frame fills the space sideways and in depth; ``lip`` is the height of the rear stop (m).
    """
    (x0, x1), (y0, y1), z = space.x, space.y, space.z[0]
    gauge = wire_gauge(max(space.width, space.depth))
    r = gauge / 2
    frame = (
        box((x0, y0, z), (x1, y0 + gauge, z + gauge), finish),
        box((x0, y1 - gauge, z), (x1, y1, z + gauge), finish),
        cylinder((x0 + r, y0 + r, z + r), (x0 + r, y1 - r, z + r), r, finish),
        cylinder((x1 - r, y0 + r, z + r), (x1 - r, y1 - r, z + r), r, finish),
    )
    stations = np.linspace(y0 + r, y1 - r, bars + 2)[1:-1]
    wires = tuple(cylinder((x0 + r, float(y), z + r), (x1 - r, float(y), z + r), r, finish) for y in stations)
    if not lip:
        return frame + wires
    stop = cylinder((x1 - r, y0 + r, z + lip), (x1 - r, y1 - r, z + lip), r, finish)
    posts = tuple(cylinder((x1 - r, y, z + r), (x1 - r, y, z + lip), r, finish) for y in (y0 + r, y1 - r))
    return (*frame, *wires, stop, *posts)


def build_basket(space: Space, finish: str, *, bars: int, posts: int, tines: int) -> tuple[Primitive, ...]:
    """A wire basket that fills a space: floor, rim, vertical wires between, a row of tines for plates."""
    (x0, x1), (y0, y1), (z0, z1) = space.x, space.y, space.z
    gauge = wire_gauge(max(space.width, space.depth))
    r = gauge / 2
    pieces = [
        cylinder((x0 + r, float(y), z0 + r), (x1 - r, float(y), z0 + r), r, finish)
        for y in np.linspace(y0 + r, y1 - r, bars)
    ]
    pieces += [
        cylinder((float(x), y0 + r, z0 + r), (float(x), y1 - r, z0 + r), r, finish)
        for x in np.linspace(x0 + r, x1 - r, 3)
    ]
    rim = z1 - r
    pieces += [box((x0, y, z1 - gauge), (x1, y + gauge, z1), finish) for y in (y0, y1 - gauge)]
    pieces += [cylinder((x, y0 + r, rim), (x, y1 - r, rim), r, finish) for x in (x0 + r, x1 - r)]
    for x in np.linspace(x0 + r, x1 - r, posts):
        for y in (y0 + r, y1 - r):
            pieces.append(cylinder((float(x), y, z0 + r), (float(x), y, rim), r, finish))
    row = float(np.linspace(x0 + r, x1 - r, 3)[1])
    height = z0 + r + 0.6 * (space.height - gauge)
    for y in np.linspace(y0 + r, y1 - r, tines + 2)[1:-1]:
        pieces.append(cylinder((row, float(y), z0 + r), (row, float(y), height), r, finish))
    return tuple(pieces)
