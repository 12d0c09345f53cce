"""Which surface can be reached from outside: the only one that a camera sees or a gripper touches.

What lies in rooms that a surface encloses, like the inside of a double wall, is neither seen nor felt.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from sim_export.geometry.grid import Grid
from sim_export.geometry.rows import all_three
from sim_export.geometry.sampling import cross_rows

STEPS = (1.5, 2.5)
"""Cells in front of a surface at which free space is looked for; at less, a cell is wall itself."""


def find_outside(wall: Bool[np.ndarray, "X Y Z"]) -> Bool[np.ndarray, "X Y Z"]:
    """Cells that can be reached from outside without crossing a wall; the outermost cells must be free."""
    regions = np.zeros(wall.shape, dtype=np.int32)
    ndimage.label(~wall, output=regions)
    return regions == regions[0, 0, 0]


def is_exposed(
    points: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    free: Bool[np.ndarray, "X Y Z"],
    grid: Grid,
) -> Bool[np.ndarray, "N"]:
    """Whether free cells, or the space beyond the grid, lie in front of points on a surface."""
    out = np.zeros(len(points), dtype=bool)
    for step in STEPS:
        cells = grid.cells_of(points + step * grid.cell * normals)
        within = all_three((cells >= 0) & (cells < grid.shape))
        out |= ~within
        out[within] |= free[tuple(cells[within].T)]
    return out


def triangle_normals(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "F 3"]:
    """Unit normals; those of triangles without area are 0."""
    normals = cross_rows(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
