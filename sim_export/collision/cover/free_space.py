"""Free space around a link, and the largest boxes between it.

A surface of separate, open or intersecting triangles encloses no exact volume. Cells of a grid do: those
that the surface crosses are wall, those that can be reached from outside without crossing wall are free,
and the rest is enclosed, where hulls may be. A box may hold wall and enclosed space, and ends where free
space, or the way of another link, begins: the wall of an oven is one box from the outer sheet to the
inner one, whatever is drawn between them.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from sim_export.collision.cover.cuboids import box_sums, compress, count_filled, empty_box, grow_boxes
from sim_export.geometry.grid import Grid, label_cells, make_grid, mark_surface
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.rows import number_rows
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import bounds_of, triangle_areas, triangle_normals
from sim_export.package import Hull

CELLS = 128
"""Cells along the longest edge of a link, as many as the check of cavities counts."""
ASIDE = np.array([-0.31, 0.22])
"""Cells by which the grid reaches beyond the surface, so that its outermost faces, and those half-way between
them, lie within cells: between two, rounding would decide."""
FINEST = 0.0025
"""Least edge of a cell, over the object's diagonal."""
LODGED = 0.1
"""Share of an enclosed space that others pass through, above which the space is free."""
BLOCK = 6
"""Edge of the blocks of cells in which that share is counted."""
TAKEN_DEPTH = np.float32(1.0)
"""Metres; deeper than any hull may reach."""
MOST_TESTED = 4_000
"""Cells of a hull's box that are tested; of larger boxes every second, third ... cell along an axis."""

_AT_ONCE = 12
"""Planes that points are tested against before those outside are left out."""
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
"""Thickness (m) of a box or hull that stands for a single sheet."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FreeSpace:
    """Cells around a link's surface.

    ``away`` is the distance of a cell's centre from the surface (m, to half a cell), ``depth`` the same
    where the cell is free and 0 where it is enclosed. Where other links are or pass, and none of the surface
    is, ``depth`` is at least `TAKEN_DEPTH`. Of a ``solid`` all enclosed cells belong to it.
    """

    grid: Grid
    away: Float[np.ndarray, "X Y Z"]
    depth: Float[np.ndarray, "X Y Z"]
    solid: bool = False


@dataclass(frozen=True, kw_only=True)
class Intrusion:
    """Free volume (m^3) in a convex region beyond a distance from the surface, and the farthest of it (m)."""

    volume: float
    depth: float


NO_INTRUSION = Intrusion(volume=0.0, depth=0.0)


def find_free_space(
    triangles: Float[np.ndarray, "F 3 3"],
    diagonal: float,
    others: Float[np.ndarray, "N 3"] | None = None,
    *,
    solid: bool = False,
) -> FreeSpace:
    """Free and enclosed cells of one link's surface (m), within an object of this diagonal (m).

    ``others`` are points where the surfaces of other links are or pass. Enclosed space that much of them
    pass through is free, the room of drawers, unless the surface is that of a ``solid``.
    """
    bounds = bounds_of(triangles.reshape(-1, 3))
    longest = max(float(np.ptp(bounds, axis=0).max()), 1e-6)
    count = int(np.clip(longest / (FINEST * diagonal), 8, CELLS))
    grid = make_grid(bounds + longest / count * ASIDE[:, None], count)
    wall = mark_surface(triangles, grid)
    away = _distances(wall) * np.float32(grid.cell)
    regions, _ = label_cells(~wall)
    taken = np.zeros(wall.shape, dtype=bool)
    if others is not None and len(others):
        cells = grid.cells_of(others)
        taken[tuple(cells[grid.holds(cells)].T)] = True
        taken &= ~wall
    size = np.bincount(regions.ravel())
    # Surfaces of lodgers are thin, so blocks of cells are counted in which they are.
    inside = np.argwhere(taken)
    owners = regions[taken]
    blocks, _ = number_rows(np.column_stack([owners, inside // BLOCK]))
    lodged = (np.bincount(owners[blocks], minlength=len(size)) * BLOCK**3 > LODGED * size) & (not solid)
    lodged[0], lodged[regions[0, 0, 0]] = False, True
    free = lodged[regions]
    depth = np.where(free, away, np.float32(0.0))
    return FreeSpace(
        grid=grid, away=away, depth=np.where(taken & free, np.maximum(depth, TAKEN_DEPTH), depth), solid=solid
    )


def _distances(wall: Bool[np.ndarray, "X Y Z"]) -> Float[np.ndarray, "X Y Z"]:
    """Distance of every cell from the nearest of wall, in cells; exact, but in integers, which takes half as
    long as ``ndimage`` does in floating point."""
    nearest = ndimage.distance_transform_edt(~wall, return_distances=False, return_indices=True)
    square = np.zeros(wall.shape, dtype=np.int32)
    for axis, (place, count) in enumerate(zip(np.asarray(nearest), wall.shape, strict=True)):
        place -= np.arange(count, dtype=np.int32).reshape(-1, *(1,) * (2 - axis))
        place *= place
        square += place
    return np.sqrt(square, dtype=np.float64).astype(np.float32)


def measure_intrusion(
    planes: Float[np.ndarray, "K 4"], bounds: Float[np.ndarray, "2 3"], space: FreeSpace, least: float
) -> Intrusion:
    """What a convex region takes of the free space farther than ``least`` (m) from the surface.

    Args:
        planes: Outward normals and offsets of the region.
        bounds: Its box (m).
        space: Free space of the link.
        least: Free space nearer than this counts as surface.
    """
    grid = space.grid
    low = np.maximum(np.ceil((bounds[0] - grid.low) / grid.cell - 0.5), 0).astype(np.int64)
    high = np.minimum(np.floor((bounds[1] - grid.low) / grid.cell - 0.5) + 1, grid.shape).astype(np.int64)
    size = high - low
    if (size <= 0).any():
        return NO_INTRUSION
    steps = _strides(size)
    window = tuple(slice(a, b, s) for a, b, s in zip(low, high, steps, strict=True))
    depth = space.depth[window]
    cells = np.argwhere(depth > least)
    if not len(cells):
        return NO_INTRUSION
    points = (grid.low + (low + cells * steps + 0.5) * grid.cell).astype(np.float32)
    for some in np.split(planes.astype(np.float32), range(_AT_ONCE, len(planes), _AT_ONCE)):
        inside = (points @ some[:, :3].T <= some[:, 3]).all(axis=1)
        points, cells = points[inside], cells[inside]
        if not len(cells):
            return NO_INTRUSION
    return Intrusion(
        volume=len(cells) * grid.cell**3 * float(np.prod(steps)), depth=float(depth[tuple(cells.T)].max())
    )


def _strides(size: np.ndarray) -> np.ndarray:
    """Steps along three axes that leave at most `MOST_TESTED` cells; long axes are thinned first."""
    steps = np.ones(3, dtype=np.int64)
    while np.prod(-(-size // steps)) > MOST_TESTED:
        steps[(-(-size // steps)).argmax()] += 1
    return steps


def is_open_between(
    first: Float[np.ndarray, "N 3"], second: Float[np.ndarray, "M 3"], space: FreeSpace, most: float
) -> bool:
    """Whether free space deeper than ``most`` (m) lies half-way between points of two sets, at some pair."""
    middles = (first[:, None] + second) / 2
    return bool((look_up(middles.reshape(-1, 3), space.depth, space.grid) > most).any())


def look_up(
    points: Float[np.ndarray, "N 3"], values: Float[np.ndarray, "X Y Z"], grid: Grid
) -> Float[np.ndarray, "N"]:
    """The values of the cells that points lie in; points beyond the grid take those of its border."""
    cells = np.clip(grid.cells_of(points), 0, np.array(grid.shape) - 1)
    return values[tuple(cells.T)]


def find_inside(points: Float[np.ndarray, "N 3"], space: FreeSpace) -> Float[np.ndarray, "N"]:
    """How deep (m) points lie in enclosed space, at least; 0 beyond the grid, in wall and in free cells."""
    cells = space.grid.cells_of(points)
    within = space.grid.holds(cells)
    deep, where = np.zeros(len(points)), tuple(cells[within].T)
    deep[within] = np.where(space.depth[where] > 0, np.float32(0.0), space.away[where])
    return np.maximum(deep - space.grid.cell, 0.0)


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
    return tuple(_fit(low, high, surface, space) for low, high in _choose(allowed, wanted))


def _find_aligned(triangles: Float[np.ndarray, "F 3 3"], space: FreeSpace) -> Aligned:
    normals = np.abs(triangle_normals(triangles))
    flat = triangles[normals.max(axis=1) >= ALIGNED]
    axes = normals[normals.max(axis=1) >= ALIGNED].argmax(axis=1)
    count = int(min(DENSITY * triangle_areas(flat).sum() / space.grid.cell**2, MOST_SAMPLES))
    points, owner = sample_triangles(flat, count)
    cells = space.grid.cells_of(points)
    within = space.grid.holds(cells)
    return Aligned(points=points[within], cells=cells[within], axes=axes[owner[within]])


def _choose(allowed: Bool[np.ndarray, "X Y Z"], wanted: Bool[np.ndarray, "X Y Z"]) -> list[np.ndarray]:
    """Maximal boxes of allowed cells, lowest cell and one past the highest, each worth its wanted cells."""
    both, edges = compress(allowed.astype(np.int8) + wanted)
    sizes = [np.diff(edge) for edge in edges]
    weights = (sizes[0][:, None, None] * sizes[1][:, None] * sizes[2]).astype(np.int32)
    filled, left = count_filled(both >= 1), np.where(both == 2, weights, np.int32(0))
    least = max(LEAST, LEAST_SHARE * float(left.sum()))
    sums, cells = count_filled(left), np.argwhere(left)
    candidates = np.zeros((0, 6), dtype=np.int64)
    out: list[np.ndarray] = []
    while len(out) < MOST and len(cells):
        seeds = cells[:: max(1, len(cells) // SEEDS)]
        candidates = np.concatenate([candidates, grow_boxes(filled, seeds).reshape(-1, 6)])
        candidates = candidates[number_rows(candidates)[0]]
        gains = box_sums(sums, candidates.reshape(-1, 2, 3))
        candidates, gains = candidates[gains >= least], gains[gains >= least]
        if not len(candidates):
            break
        best = candidates[gains.argmax()].reshape(2, 3)
        empty_box(left, sums, best)
        cells = cells[left[tuple(cells.T)] > 0]
        out.append(np.array([[edges[axis][best[end, axis]] for axis in range(3)] for end in range(2)]))
    return out


def _fit(low: np.ndarray, high: np.ndarray, surface: Aligned, space: FreeSpace) -> Hull:
    """A box of cells with its faces moved to the surface that its outermost cells hold."""
    grid = space.grid
    held = np.arange(len(surface.points))
    for axis in np.argsort(high - low):  # most points lie beside the thin side
        at = surface.cells[held, axis]
        held = held[(at >= low[axis]) & (at < high[axis])]
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
