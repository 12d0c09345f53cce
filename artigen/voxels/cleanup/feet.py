"""Adds feet to objects that would fall over because feet are missing or too short.

Objects that stand safely are left alone. Others get a post under each corner of their body, as thick as a
short foot, from the underside down to the floor.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import ConvexHull

from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import name_rows

THICK = 2
"""Edge of a foot in cells."""
REACH = 10
"""Length of the longest foot in cells."""
LAYERS = 3
"""Lowest layers of cells that count as support; the exporter levels differences within them."""
MARGIN = 2.5
"""Least distance in cells from the middle of an object to the edge of its support."""


def extend_feet(owners: Owners, rows: Float[np.ndarray, "N C"]) -> tuple[Owners, tuple[str, ...]]:
    """Adds or extends feet of a body that stands badly; returns owners and a note.

    Args:
        owners: Row of the outline per cell, -1 where empty.
        rows: The outline: channels after occupancy, one row per part.
    """
    bodies = np.flatnonzero(np.array(name_rows(rows)) == "base")
    cells = np.argwhere(owners >= 0)
    if not len(bodies) or not len(cells) or measure_stand(cells) >= MARGIN:
        return owners, ()
    owners, floor = owners.copy(), int(cells[:, 2].min())
    lengths = [
        length
        for corner in ((0, 0), (0, 1), (1, 0), (1, 1))
        if (length := _add_foot(owners, int(bodies[0]), floor, corner))
    ]
    if not lengths:
        return owners, ()
    return owners, (f"{len(lengths)} feet were added or made longer, by {max(lengths)} cells at most",)


def measure_stand(coords: Int[np.ndarray, "N 3"]) -> float:
    """Distance in cells from the mean of all cells to the edge of the lowest ones' hull; negative outside.

    Args:
        coords: Cells (x, y, z), at least one.
    """
    lowest = coords[coords[:, 2] < coords[:, 2].min() + LAYERS, :2]
    corners = (lowest[:, None] + np.array([[0, 0], [0, 1], [1, 0], [1, 1]])).reshape(-1, 2)
    sides = ConvexHull(corners).equations
    middle = coords[:, :2].mean(axis=0) + 0.5
    return float(-(sides[:, :2] @ middle + sides[:, 2]).max())


def _add_foot(owners: Owners, body: int, floor: int, corner: tuple[int, int]) -> int:
    """Adds a foot under a corner of a body, in place; returns its length in cells, 0 if none fits."""
    mine = owners == body
    under = _find_undersides(mine)
    x, y = np.nonzero((under >= 0) & (under <= floor + REACH))
    if not len(x):
        return 0
    outer = [
        edge.max() if end else edge.min()
        for edge, end in zip(np.nonzero(mine.any(axis=2)), corner, strict=True)
    ]
    nearest = int(np.argmin(np.abs(x - outer[0]) + np.abs(y - outer[1])))
    place = tuple(
        slice(max(int(at) - THICK + 1, 0) if end else int(at), int(at) + (1 if end else THICK))
        for at, end in zip((x[nearest], y[nearest]), corner, strict=True)
    )
    top = int(under[x[nearest], y[nearest]])
    post = owners[place[0], place[1], floor:top]  # a view
    post[post < 0] = body
    return top - floor


def _find_undersides(mine: Bool[np.ndarray, "X Y Z"]) -> Int[np.ndarray, "X Y"]:
    """Lowest cell of a part in every column, -1 where it has none."""
    return np.where(mine.any(axis=2), mine.argmax(axis=2), -1)
