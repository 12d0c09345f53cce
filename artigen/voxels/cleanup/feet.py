"""Adds feet to objects that would fall over because feet are missing or too short.

Only what stands badly is changed. It gets a post under each corner of its body, as thick as a short foot,
from the underside down to the floor.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import ConvexHull

from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import DEFAULT_LAYOUT, FieldLayout, name_rows

THICK = 2
"""Edge of a foot in cells."""
REACH = 10
"""Cells that a foot is long, at most."""
LAYERS = 3
"""Lowest layers of cells that an object stands on; the exporter levels what is missing in them."""
MARGIN = 2.5
"""Cells between the middle of an object and the edge of what it stands on, at least."""


def extend_feet(
    owners: Owners,
    rows: Float[np.ndarray, "N C"],
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which the body stands, and a note of how many feet it was given.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    bodies = np.flatnonzero(np.array(name_rows(rows, layout)) == "base")
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
    """Cells from the mean of all cells to the edge of the hull of the lowest, below 0 outside of it.

    Args:
        coords: Cells (x, y, z), at least one.
    """
    lowest = coords[coords[:, 2] < coords[:, 2].min() + LAYERS, :2]
    corners = (lowest[:, None] + np.array([[0, 0], [0, 1], [1, 0], [1, 1]])).reshape(-1, 2)
    sides = ConvexHull(corners).equations
    middle = coords[:, :2].mean(axis=0) + 0.5
    return float(-(sides[:, :2] @ middle + sides[:, 2]).max())


def _add_foot(owners: Owners, body: int, floor: int, corner: tuple[int, int]) -> int:
    """Puts a foot under a corner of a body, in place, and says how long it is: 0 if there is none to add."""
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
