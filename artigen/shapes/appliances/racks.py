"""Wire racks, baskets and sheet pans of ovens, dishwashers and refrigerators."""

from functools import partial

import numpy as np

from artigen.shapes.fittings.hardware import Space
from artigen.shapes.primitives import Primitive, block, cylinder
from artigen.shapes.ranges import margins, narrow

SLENDER = 55.0
"""Largest ratio of a rod's length to its thickness; engines mishandle longer ones."""


def choose_thickness(space: Space, least: float) -> float:
    """Thickness (m) of the wires or walls of what fills a space: the least one that engines can handle."""
    return max(least, max(space.width, space.depth) / SLENDER)


def build_rack(space: Space, *, bars: int, lip: float) -> tuple[Primitive, ...]:
    """A flat wire rack at the bottom of a space: a frame, bars from front to back, a raised rear stop.

    The frame fills the space sideways and in depth; ``lip`` is the height of the rear stop (m).
    """
    gauge, low = choose_thickness(space, 0.006), space.z[0]
    wire = partial(cylinder, radius=gauge / 2, finish="steel")
    (x0, x1), (y0, y1) = narrow(space.x, gauge / 2), narrow(space.y, gauge / 2)
    level, top = low + gauge / 2, low + lip
    return (
        *(block(space.x, side, (low, low + gauge), "steel") for side in margins(space.y, gauge)),
        *(wire((x, y0, level), (x, y1, level)) for x in (x0, x1)),
        *(wire((x0, y, level), (x1, y, level)) for y in np.linspace(y0, y1, bars + 2)[1:-1].tolist()),
        wire((x1, y0, top), (x1, y1, top)),
        *(wire((x1, y, level), (x1, y, top)) for y in (y0, y1)),
    )


def build_basket(space: Space, *, bars: int, posts: int, tines: int) -> tuple[Primitive, ...]:
    """A wire basket that fills a space: floor, rim, vertical wires between, a row of tines for plates."""
    gauge, (bottom, top) = choose_thickness(space, 0.006), space.z
    wire = partial(cylinder, radius=gauge / 2, finish="steel")
    (x0, x1), (y0, y1) = narrow(space.x, gauge / 2), narrow(space.y, gauge / 2)
    low, rim = bottom + gauge / 2, top - gauge / 2
    columns = np.linspace(x0, x1, 3).tolist()
    end = low + 0.6 * (space.height - gauge)
    return (
        *(wire((x0, y, low), (x1, y, low)) for y in np.linspace(y0, y1, bars).tolist()),
        *(wire((x, y0, low), (x, y1, low)) for x in columns),
        *(
            block(space.x, (y, y + gauge), (top - gauge, top), "steel")
            for y in (space.y[0], space.y[1] - gauge)
        ),
        *(wire((x, y0, rim), (x, y1, rim)) for x in (x0, x1)),
        *(wire((x, y, low), (x, y, rim)) for x in np.linspace(x0, x1, posts).tolist() for y in (y0, y1)),
        *(
            wire((columns[1], y, low), (columns[1], y, end))
            for y in np.linspace(y0, y1, tines + 2)[1:-1].tolist()
        ),
    )
