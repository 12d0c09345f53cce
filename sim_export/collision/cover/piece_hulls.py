"""The hull of a piece of a surface, and of a sheet, which gets a thickness."""

import numpy as np
from jaxtyping import Float

from sim_export.collision.cover.free_space import SHEET, TAKEN_DEPTH, FreeSpace, look_up
from sim_export.collision.cover.surface_pieces import Piece
from sim_export.errors import DegeneratePart
from sim_export.geometry.hulls import convex_hull
from sim_export.package import Hull

UNLIKE = 0.3
"""Difference of openness from which on a sheet grows to one side only."""


def piece_hull(piece: Piece, space: FreeSpace) -> Hull | None:
    """The hull of a piece; a sheet gets its thickness on the side that is enclosed, or on both."""
    if len(piece.planes):
        try:
            return convex_hull(piece.triangles.reshape(-1, 3))
        except DegeneratePart:
            pass
    middle = piece.corners.mean(axis=0)
    axes = np.linalg.svd(piece.corners - middle, full_matrices=False)[2]
    if len(axes) < 3:
        return None
    normal = axes[2]
    free = [_openness(piece.samples, side * normal, space) for side in (1.0, -1.0)]
    first, last = (
        (-0.5, 0.5) if abs(free[0] - free[1]) < UNLIKE else (0.0, 1.0) if free[0] < free[1] else (-1.0, 0.0)
    )
    points = np.concatenate([piece.corners + end * SHEET * normal for end in (first, last)])
    try:
        return convex_hull(points)
    except DegeneratePart:
        return None


def _openness(points: Float[np.ndarray, "N 3"], side: Float[np.ndarray, "3"], space: FreeSpace) -> float:
    """How little a sheet should grow to one side: the share of free cells there, taken ones thrice."""
    depth = look_up(points + 1.5 * space.grid.cell * side, space.depth, space.grid)
    return float((depth > 0).mean() + 2.0 * (depth >= TAKEN_DEPTH).mean())
