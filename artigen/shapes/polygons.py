"""Convex polygons in space, cut along the planes between cells (lengths in cells)."""

import numpy as np
from jaxtyping import Bool, Float, Int

TINY = 1e-6
"""Smallest length (cells) that is kept, and tolerance for lying on a plane."""
WIDTHS = (6, 16)
"""Groups of polygons by number of corners that are cut together, to limit the cost of padding."""
Cut = tuple[Int[np.ndarray, "P"], Float[np.ndarray, "P W 3"], Int[np.ndarray, "P"]]
"""Index of the source polygon of each piece, its corners (padded as given), and their number."""


def cut_polygons(corners: Float[np.ndarray, "N M 3"], counts: Int[np.ndarray, "N"]) -> list[Cut]:
    """Cuts polygons until each piece lies in one cell; pieces are grouped by width.

    Args:
        corners: Corners in order, padded with the last corner of each polygon.
        counts: Number of corners of each polygon.
    """
    groups = _sort_by_width((np.arange(len(corners)), corners, counts))
    for axis in range(3):
        groups = [narrow for group in groups for narrow in _sort_by_width(_cut_along(group, axis))]
    return groups


def repeat_rows(counts: Int[np.ndarray, "N"]) -> tuple[Int[np.ndarray, "M"], Int[np.ndarray, "M"]]:
    """Every row ``counts`` times, and the numbers 0 to ``counts - 1`` within each row."""
    rows = np.repeat(np.arange(len(counts)), counts)
    return rows, np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)


def _sort_by_width(cut: Cut) -> list[Cut]:
    rows, corners, counts = cut
    width = np.searchsorted(WIDTHS, counts)
    out = []
    for kind in np.unique(width):
        own = width == kind
        out.append((rows[own], corners[own, : counts[own].max()], counts[own]))
    return out


def _cut_along(cut: Cut, axis: int) -> Cut:
    """Cuts at every plane between cells that is perpendicular to an axis."""
    rows, corners, counts = cut
    height = corners[:, :, axis]
    first = np.floor(height.min(axis=1) + TINY).astype(np.int64)
    last = np.maximum(np.ceil(height.max(axis=1) - TINY).astype(np.int64), first + 1)
    spans = last - first
    if (spans == 1).all():
        return cut
    piece, number = repeat_rows(spans)
    plane = first[piece] + number
    rows, corners, counts = rows[piece], corners[piece], counts[piece]
    above, below = plane > first[piece], plane + 1 < last[piece]
    corners, counts = _cut_off(corners, counts, above, axis, (plane, 1))
    corners, counts = _cut_off(corners, counts, below, axis, (plane + 1, -1))
    proper = counts > 2
    return rows[proper], corners[proper], counts[proper]


def polygon_areas(corners: Float[np.ndarray, "N M 3"]) -> Float[np.ndarray, "N 3"]:
    """Area vectors: their length is the area, their direction the normal for counterclockwise corners."""
    spokes = corners[:, 1:] - corners[:, :1]
    return np.cross(spokes[:, :-1], spokes[:, 1:]).sum(axis=1) / 2


def polygon_middles(
    corners: Float[np.ndarray, "N M 3"], counts: Int[np.ndarray, "N"]
) -> Float[np.ndarray, "N 3"]:
    """Means of the corners, which lie inside."""
    padding = corners.shape[1] - counts
    return (corners.sum(axis=1) - padding[:, None] * corners[:, -1]) / counts[:, None]


def _cut_off(
    corners: Float[np.ndarray, "N M 3"],
    counts: Int[np.ndarray, "N"],
    chosen: Bool[np.ndarray, "N"],
    axis: int,
    at: tuple[Int[np.ndarray, "N"], int],
) -> tuple[Float[np.ndarray, "N W 3"], Int[np.ndarray, "N"]]:
    """Clips the chosen polygons at their planes; ``at`` gives positions and side."""
    if not chosen.any():
        return corners, counts
    planes, side = at
    cut, number = _keep_side(corners[chosen], side * (corners[chosen, :, axis] - planes[chosen, None]))
    width = max(cut.shape[1], int(counts[~chosen].max(initial=0)))
    out = np.empty((len(corners), width, 3))
    out[~chosen] = _pad(corners[~chosen], width)
    out[chosen] = _pad(cut, width)
    counts = counts.copy()
    counts[chosen] = number
    return out, counts


def _keep_side(
    corners: Float[np.ndarray, "N M 3"], height: Float[np.ndarray, "N M"]
) -> tuple[Float[np.ndarray, "N W 3"], Int[np.ndarray, "N"]]:
    """Clips polygons to non-negative height; returns the corners and their number."""
    after, next_height = np.roll(corners, -1, axis=1), np.roll(height, -1, axis=1)
    inside = height >= 0
    crosses = inside != (next_height >= 0)
    way = np.divide(height, height - next_height, out=np.zeros_like(height), where=crosses)
    found = np.stack([corners, corners + way[..., None] * (after - corners)], axis=2)
    kept = np.stack([inside, crosses], axis=2).reshape(len(corners), -1)
    counts = kept.sum(axis=1)
    width = max(int(counts.max()), 1)
    order = np.argsort(~kept, axis=1, kind="stable")
    column = np.minimum(np.arange(width), np.maximum(counts - 1, 0)[:, None])
    order = np.take_along_axis(order, column, axis=1)
    return found.reshape(len(corners), -1, 3)[np.arange(len(corners))[:, None], order], counts


def _pad(corners: Float[np.ndarray, "N M 3"], width: int) -> Float[np.ndarray, "N W 3"]:
    """Pads the corners to ``width`` columns with the last one, or removes such padding."""
    column = np.minimum(np.arange(width), corners.shape[1] - 1)
    return corners[:, column]
