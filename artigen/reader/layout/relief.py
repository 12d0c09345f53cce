"""`find_field`: what a front looks like from ahead, by how deep each place of it lies."""

import numpy as np
from jaxtyping import Float, Int

from artigen.reader.reading import Field
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import ShapePart

GRID = 60
"""Cells along each edge of a front that is looked at."""
RING = 0.015
"""Distance (m) from the edge of a front that is on its frame, whose narrowest is 0.02 wide."""
STEP = 0.002
"""Difference of depths (m) that is seen as an edge."""
SLATS = 8
"""Number of edges in a line across a front from which it has slats: a frame has four."""
PLANKS = 3
"""Number of upright boards that are planks."""
MIDDLE = slice(round(0.3 * GRID), round(0.7 * GRID))
"""Cells of what a frame surrounds."""


def find_field(part: ShapePart) -> Field | None:
    """The field of a front; None where most of its middle is glass."""
    depth, nearest = measure_depths(part)
    seen = nearest[MIDDLE, MIDDLE]
    if np.mean([part.primitives[at].finish == "glass" for at in seen[seen >= 0]] or [False]) > 0.5:
        return None
    across, along = (
        np.count_nonzero(np.abs(np.diff(line[np.isfinite(line)])) > STEP)
        for line in (depth[GRID // 2], depth[:, GRID // 2])
    )
    if max(across, along) >= SLATS:
        return "planks" if across > along else "slats"
    solids = [solid for solid in part.primitives if solid.finish == "front"]
    tall = sum(solid.size[2] > 0.75 * np.ptp(part.bounds()[:, 2]) for solid in solids)
    if tall >= PLANKS and tall == len(solids):
        return "planks"
    columns, rows = (
        min(int(RING / length * GRID), GRID // 4) for length in np.ptp(part.bounds(), axis=0)[1:]
    )
    ring = np.concatenate(
        [depth[rows, MIDDLE], depth[-1 - rows, MIDDLE], depth[MIDDLE, columns], depth[MIDDLE, -1 - columns]]
    )
    field = depth[MIDDLE, MIDDLE]
    if not (np.isfinite(ring).any() and np.isfinite(field).any()):
        return "flat"
    lifted = np.median(ring[np.isfinite(ring)]) - np.median(field[np.isfinite(field)])
    return "framed" if abs(lifted) > STEP else "flat"


def measure_depths(part: ShapePart) -> tuple[Float[np.ndarray, "G G"], Int[np.ndarray, "G G"]]:
    """The foremost solid of every cell of a part's box from ahead, rows upward: where it begins (m), and its
    number; infinite and -1 where there is none."""
    low, high = part.bounds()
    depth, nearest = np.full((GRID, GRID), np.inf), np.full((GRID, GRID), -1)
    y, z = (low[axis] + (np.arange(GRID) + 0.5) / GRID * (high - low)[axis] for axis in (1, 2))
    for number, solid in enumerate(part.primitives):
        corners = place_vertices(solid)
        first, last = corners.min(axis=0), corners.max(axis=0)
        inside = ((z >= first[2]) & (z <= last[2]))[:, None] & ((y >= first[1]) & (y <= last[1]))
        ahead = inside & (first[0] < depth)
        depth[ahead], nearest[ahead] = first[0], number
    return depth, nearest
