"""Voxelises triangle surfaces: cells that a surface crosses or encloses, cavities, and what is exposed.

A column is the line through the centres of cells along one axis. The direction of each crossing with a
triangle tells whether the column enters or leaves a solid. One pass over all triangles thus gives the winding
number of every cell centre, for overlapping and nested shells too.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from sim_export.geometry.rows import all_three

_SHIFT = np.array([1.37e-4, 2.71e-4, 3.19e-4])
"""Offset (in cells) of columns from the cell centres, so that they miss axis-aligned edges."""
STEPS = (1.5, 2.5)
"""Cells in front of a surface at which free space is looked for; at less, a cell is wall itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Grid:
    """Cubic cells: cell (i, j, k) starts at ``low + (i, j, k) * cell`` (m)."""

    low: Float[np.ndarray, "3"]
    cell: float
    shape: tuple[int, int, int]

    def cells_of(self, points: Float[np.ndarray, "N 3"]) -> Int[np.ndarray, "N 3"]:
        """Indices of the cells that contain the points; points outside get indices out of range."""
        return np.floor((points - self.low) / self.cell).astype(np.int64)

    def holds(self, cells: Int[np.ndarray, "N 3"]) -> Bool[np.ndarray, "N"]:
        """Which indices are those of cells of the grid."""
        return all_three((cells >= 0) & (cells < self.shape))


def make_grid(bounds: Float[np.ndarray, "2 3"], resolution: int) -> Grid:
    """Cells over a box, ``resolution`` along its longest edge, with two empty cells around it."""
    size = bounds[1] - bounds[0]
    cell = float(size.max()) / resolution
    shape = np.ceil(size / cell - 1e-9).astype(int) + 4
    return Grid(low=bounds[0] - 2 * cell, cell=cell, shape=(int(shape[0]), int(shape[1]), int(shape[2])))


def fill_solid(triangles: Float[np.ndarray, "F 3 3"], grid: Grid) -> Bool[np.ndarray, "X Y Z"]:
    """Cells whose centre lies inside closed, outward oriented surfaces; shells may overlap."""
    column, height, sign = column_crossings(triangles, grid, 2)
    nx, ny, nz = grid.shape
    first = np.clip(np.ceil(height - 0.5), 0, nz).astype(np.int64)
    flat = column * (nz + 1) + first
    turns = np.bincount(flat, weights=-sign, minlength=nx * ny * (nz + 1))
    return (np.cumsum(turns.reshape(nx, ny, nz + 1), axis=2) > 0.5)[:, :, :nz]


def mark_surface(triangles: Float[np.ndarray, "F 3 3"], grid: Grid) -> Bool[np.ndarray, "X Y Z"]:
    """Cells in which a surface crosses a line between neighbouring centres, which leaves no gaps between face
    neighbours."""
    out = np.zeros(grid.shape, dtype=bool)
    for axis in range(3):
        column, height, _ = column_crossings(triangles, grid, axis)
        nz = grid.shape[axis]
        level = np.floor(height).astype(np.int64)
        inside = (level >= 0) & (level < nz)
        marked = np.zeros(out.size, dtype=bool)
        marked[column[inside] * nz + level[inside]] = True
        turned = marked.reshape(*(grid.shape[a] for a in _plane(axis)), nz)
        out |= np.moveaxis(turned, (0, 1, 2), (*_plane(axis), axis))
    return out


def label_cells(
    cells: Bool[np.ndarray, "*S"], structure: Bool[np.ndarray, "*T"] | None = None
) -> tuple[Int[np.ndarray, "*S"], int]:
    """Connected groups of cells numbered from 1, and their count; by default, groups connect by faces."""
    labels = np.zeros(cells.shape, dtype=np.int32)
    ndimage.label(cells, structure=structure, output=labels)
    return labels, int(labels.max())


def find_outside(wall: Bool[np.ndarray, "X Y Z"]) -> Bool[np.ndarray, "X Y Z"]:
    """Cells that can be reached from outside without crossing a wall; the outermost cells must be free."""
    regions, _ = label_cells(~wall)
    return regions == regions[0, 0, 0]


def is_exposed(
    points: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    free: Bool[np.ndarray, "X Y Z"],
    grid: Grid,
) -> Bool[np.ndarray, "N"]:
    """Whether free cells, or the space beyond the grid, lie in front of points on a surface.

    What lies in rooms that a surface encloses, like the inside of a double wall, is neither seen nor felt.
    """
    out = np.zeros(len(points), dtype=bool)
    for step in STEPS:
        cells = grid.cells_of(points + step * grid.cell * normals)
        within = grid.holds(cells)
        out |= ~within
        out[within] |= free[tuple(cells[within].T)]
    return out


def find_cavity(wall: Bool[np.ndarray, "X Y Z"], side: int) -> Bool[np.ndarray, "X Y Z"]:
    """Free cells in which an object could be placed: enclosed, reachable from outside, and wide enough.

    A cell is enclosed if ``wall`` cells lie on both sides of it along at least two of the three axes. A
    drawer has four walls, an open compartment at least four, the space under a table none. Of the enclosed
    cells, those that a free cube of ``side`` cells can cover are returned. The outermost cells of the grid
    must be free.
    """
    walled = np.zeros(wall.shape, dtype=np.int8)
    for axis in range(3):
        before = np.logical_or.accumulate(wall, axis=axis)
        after = np.flip(np.logical_or.accumulate(np.flip(wall, axis), axis=axis), axis)
        walled += before & after
    return open_with_cube(find_outside(wall) & (walled >= 2), side)


def open_with_cube(cells: Bool[np.ndarray, "X Y Z"], side: int) -> Bool[np.ndarray, "X Y Z"]:
    """Morphological opening: the union of all cubes of ``side`` cells that fit into ``cells``."""
    corners = cells
    for axis in range(3):
        corners = _combine_shifted(corners, side, axis, np.logical_and)
    out = np.flip(corners)
    for axis in range(3):
        out = _combine_shifted(out, side, axis, np.logical_or)
    return np.flip(out)


def _combine_shifted(cells: np.ndarray, side: int, axis: int, combine: np.ufunc) -> np.ndarray:
    """Combines each cell with the next ``side - 1`` cells along an axis; cells outside the grid are free."""
    out = cells.copy()
    done = 1
    while done < side:
        step = min(done, side - done)
        moved = np.zeros_like(out)
        source, target = [slice(None)] * 3, [slice(None)] * 3
        source[axis], target[axis] = slice(step, None), slice(None, -step)
        moved[tuple(target)] = out[tuple(source)]
        out = combine(out, moved)
        done += step
    return out


def _plane(axis: int) -> tuple[int, int]:
    return ((1, 2), (0, 2), (0, 1))[axis]


def column_crossings(
    triangles: np.ndarray, grid: Grid, axis: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Column, height in cells above the grid's lowest face, and sign (+1 upward normal) of each crossing."""
    scaled = (triangles - grid.low) / grid.cell
    u, v = _plane(axis)
    # Axis y makes (x, z, y) left-handed, which flips every sign.
    flip = -1.0 if axis == 1 else 1.0
    corners = np.stack(
        [scaled[..., u] - 0.5 - _SHIFT[u], scaled[..., v] - 0.5 - _SHIFT[v], scaled[..., axis]], -1
    )
    nu, nv = grid.shape[u], grid.shape[v]
    low = np.maximum(np.ceil(corners[..., :2].min(axis=1)), 0).astype(np.int64)
    high = np.minimum(np.floor(corners[..., :2].max(axis=1)), [nu - 1, nv - 1]).astype(np.int64)
    edge_a, edge_b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = edge_a[:, 0] * edge_b[:, 1] - edge_a[:, 1] * edge_b[:, 0]
    span = np.maximum(high - low + 1, 0)
    count = np.where(np.abs(area) > 1e-12, span[:, 0] * span[:, 1], 0)
    parts = [_cross(corners, low, span, area, rows) for rows in _chunks(count)]
    columns = np.concatenate([np.zeros((0, 2), np.int64), *(part[0] for part in parts)])
    height = np.concatenate([np.zeros(0), *(part[1] for part in parts)])
    sign = np.concatenate([np.zeros(0), *(part[2] for part in parts)])
    return columns[:, 0] * nv + columns[:, 1], height, flip * sign


def _chunks(count: np.ndarray) -> list[np.ndarray]:
    """Triangle indices in chunks of bounded size, each repeated once per column of its box."""
    rows = np.flatnonzero(count)
    total = np.cumsum(count[rows])
    groups = np.split(rows, np.flatnonzero(np.diff(total // 2_000_000)) + 1)
    return [np.repeat(group, count[group]) for group in groups if len(group)]


def _cross(
    corners: np.ndarray, low: np.ndarray, span: np.ndarray, area: np.ndarray, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    starts = np.flatnonzero(np.r_[True, rows[1:] != rows[:-1]])
    within = np.arange(len(rows)) - np.repeat(starts, np.diff(np.r_[starts, len(rows)]))
    u, v = np.divmod(within, span[rows, 1])
    u, v = u + low[rows, 0], v + low[rows, 1]
    (au, bu, cu), (av, bv, cv), heights = (corners[..., n].T for n in range(3))
    a_u, b_u, c_u = (own[rows] - u for own in (au, bu, cu))
    a_v, b_v, c_v = (own[rows] - v for own in (av, bv, cv))
    own_area = area[rows]
    weight_a, weight_b = (b_u * c_v - b_v * c_u) / own_area, (c_u * a_v - c_v * a_u) / own_area
    hit = np.flatnonzero((weight_a >= 0) & (weight_b >= 0) & (weight_a + weight_b <= 1))
    rows, weight_a, weight_b = rows[hit], weight_a[hit], weight_b[hit]
    a, b, c = (own[rows] for own in heights)
    height = weight_a * a + weight_b * b + (1 - weight_a - weight_b) * c
    return np.stack([u[hit], v[hit]], axis=1), height, np.sign(own_area[hit])
