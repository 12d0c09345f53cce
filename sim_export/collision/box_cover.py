"""Boxes that cover the axis-aligned surface of a link, as large as its free space lets them be.

A box may hold wall and enclosed space, and ends where free space, or the way of another link, begins. So
the wall of an oven is one box from the outer sheet to the inner one, whatever is drawn between them.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from sim_export.collision.cuboids import box_sums, compress, count_filled, grow_boxes
from sim_export.collision.free_space import FreeSpace
from sim_export.collision.hulls import box_hull
from sim_export.geometry.exposure import triangle_normals
from sim_export.geometry.sampling import sample_triangles, triangle_areas
from sim_export.package import Hull

ALIGNED = 0.99
"""Cosine to an axis from which a triangle is aligned with it."""
LEAST = 48
"""Cells of surface that a box must newly cover."""
LEAST_SHARE = 0.002
"""The same as a share of all surface to be covered."""
MOST = 64
"""Boxes of a link, at most."""
SEEDS = 32
"""Uncovered cells from which boxes are grown, for every box."""
DENSITY = 3.0
"""Samples per cell of surface."""
MOST_SAMPLES = 200_000
SHEET = 0.002
"""Thickness (m) of a box that stands for a single sheet."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Aligned:
    """Points on the axis-aligned surface of a link: where, in which cell, and along which axis they face."""

    points: Float[np.ndarray, "N 3"]
    cells: Int[np.ndarray, "N 3"]
    axes: Int[np.ndarray, "N"]


def cover_with_boxes(triangles: Float[np.ndarray, "F 3 3"], space: FreeSpace) -> tuple[Hull, ...]:
    """Boxes over most of the axis-aligned surface of a link, the largest first.

    Args:
        triangles: Its surface, as far as it must be covered (m).
        space: Where its hulls may be.
    """
    surface = _find_aligned(triangles, space)
    if len(surface.points) < LEAST:
        return ()
    allowed = space.depth <= 0.0
    wanted = np.zeros(allowed.shape, dtype=bool)
    wanted[tuple(surface.cells.T)] = True
    wanted &= allowed
    out = []
    for low, high in _choose(allowed, wanted):
        out.append(_fit(low, high, surface, space))
    return tuple(out)


def _find_aligned(triangles: Float[np.ndarray, "F 3 3"], space: FreeSpace) -> Aligned:
    normals = np.abs(triangle_normals(triangles))
    flat = triangles[normals.max(axis=1) >= ALIGNED]
    axes = normals[normals.max(axis=1) >= ALIGNED].argmax(axis=1)
    count = int(min(DENSITY * triangle_areas(flat).sum() / space.grid.cell**2, MOST_SAMPLES))
    points, owner = sample_triangles(flat, count)
    cells = space.grid.cells_of(points)
    within = ((cells >= 0) & (cells < space.grid.shape)).all(axis=1)
    return Aligned(points=points[within], cells=cells[within], axes=axes[owner[within]])


def _choose(allowed: Bool[np.ndarray, "X Y Z"], wanted: Bool[np.ndarray, "X Y Z"]) -> list[np.ndarray]:
    """Maximal boxes of allowed cells, lowest cell and one past the highest, each worth its wanted cells."""
    both, edges = compress(allowed.astype(np.int8) + wanted)
    sizes = [np.diff(edge) for edge in edges]
    weights = sizes[0][:, None, None] * sizes[1][:, None] * sizes[2]
    filled, left = count_filled(both >= 1), both == 2
    least = max(LEAST, LEAST_SHARE * float((left * weights).sum()))
    candidates = np.zeros((0, 2, 3), dtype=np.int64)
    out: list[np.ndarray] = []
    while len(out) < MOST and left.any():
        cells = np.argwhere(left)
        cells = cells[:: max(1, len(cells) // SEEDS)]
        candidates = np.unique(np.concatenate([candidates, grow_boxes(filled, cells)]), axis=0)
        gains = box_sums(count_filled(left * weights), candidates)
        candidates, gains = candidates[gains >= least], gains[gains >= least]
        if not len(candidates):
            break
        best = candidates[gains.argmax()]
        left[tuple(slice(low, high) for low, high in best.T)] = False
        out.append(np.array([[edges[axis][best[end, axis]] for axis in range(3)] for end in range(2)]))
    return out


def _fit(low: np.ndarray, high: np.ndarray, surface: Aligned, space: FreeSpace) -> Hull:
    """A box of cells with its faces moved to the surface that its outermost cells hold."""
    grid = space.grid
    held = ((surface.cells >= low) & (surface.cells < high)).all(axis=1)
    points, cells, axes = surface.points[held], surface.cells[held], surface.axes[held]
    ends = np.stack([grid.low + low * grid.cell, grid.low + high * grid.cell])
    for axis in range(3):
        own = axes == axis
        for end, layer in enumerate((low[axis], high[axis] - 1)):
            at = points[own & (cells[:, axis] == layer), axis]
            if len(at):
                ends[end, axis] = at.min() if end == 0 else at.max()
            elif high[axis] - low[axis] > 2:  # what is there faces elsewhere
                ends[end, axis] += (0.5 - end) * grid.cell
        if ends[1, axis] - ends[0, axis] < SHEET:
            middle = ends[:, axis].mean()
            ends[:, axis] = middle - SHEET / 2, middle + SHEET / 2
    return box_hull(ends[0], ends[1])
