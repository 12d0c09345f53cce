"""Hobs: burners under grates, coils or glass zones, in two rows."""

from typing import Literal

import numpy as np

from artigen.shapes.choices import choose
from artigen.shapes.primitives import Primitive, block, cylinder
from artigen.shapes.ranges import Range, around, divide_range, narrow

CooktopKind = Literal["gas", "glass", "coil"]


def place_burners(x: Range, y: Range, count: int) -> list[tuple[float, float, float]]:
    """Centres (x, y) and free radius of burners in two rows; an odd one is alone in the middle column."""
    columns = divide_range(y, (count + 1) // 2, 0.0)
    rows = [sum(row) / 2 for row in divide_range(x, 2, 0.0)]
    radius = min(columns[0][1] - columns[0][0], (x[1] - x[0]) / 2) / 2
    places = []
    for k, column in enumerate(columns):
        alone = count % 2 and k == len(columns) // 2
        places += [(row, sum(column) / 2, radius) for row in ([sum(x) / 2] if alone else rows)]
    return places


def build_burners(
    rng: np.random.Generator, kind: CooktopKind, area: tuple[Range, Range], z: float, *, count: int
) -> tuple[Primitive, ...]:
    """Burners on a worktop at height ``z`` within ranges of x and y, with their grates."""
    x, y = area
    pieces: list[Primitive] = []
    for cx, cy, room in place_burners(x, y, count):
        size = choose(rng, 0.72, 0.92) * room
        if kind == "glass":
            pieces.append(cylinder((cx, cy, z), (cx, cy, z + max(0.004, size / 27)), size, "rubber"))
        elif kind == "coil":
            pieces.append(cylinder((cx, cy, z), (cx, cy, z + 0.009), size, "rubber"))
            pieces.append(cylinder((cx, cy, z), (cx, cy, z + 0.014), 0.3 * size, "steel"))
        else:
            pieces.append(cylinder((cx, cy, z), (cx, cy, z + 0.012), 0.42 * size, "rubber"))
    if kind == "gas":
        columns = divide_range(y, (count + 1) // 2, 0.006)
        for column in columns:
            pieces += build_grate(x, column, z, cheeks=2 if len(columns) < 3 else 1)
    return tuple(pieces)


def build_grate(x: Range, y: Range, z: float, *, cheeks: int) -> tuple[Primitive, ...]:
    """A cast-iron grate over a column of burners: cheeks or one spine on the hob, and two cross bars."""
    bar = max(0.009, (x[1] - x[0]) / 50)
    top = z + 0.025
    low, high = narrow(y, 0.012)
    middle = (low + high - bar) / 2
    sides = [
        block(x, (side, side + bar), (z, top), "rubber")
        for side in ((low, high - bar) if cheeks == 2 else (middle,))
    ]
    quarter = (x[1] - x[0]) / 4
    centers = [x[0] + k * quarter for k in (1, 3)]
    bars = [block(around(c, bar / 2), (low, high), (top - 0.01, top), "rubber") for c in centers]
    return (*sides, *bars)
