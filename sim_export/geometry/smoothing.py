"""Smooths blocky surfaces while keeping locked coordinates, sharp rims and thin walls."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array, csr_array

from sim_export.geometry.triangles import face_edges

_RELAXED_RINGS = 4
"""Distance (cells) from a curved surface within which vertices of flat ones follow it."""
_STRETCHED = 4.0
"""Distance (cells) from an extreme over which a curved surface is stretched to its box."""

ITERATIONS = 80
"""Pairs of a shrinking and a growing step; more spread farther along gentle slopes."""
SHRINK = 0.6
"""Fraction of the way to the neighbours' mean in the shrinking step."""
GROW = 0.605
"""Fraction of the way back in the growing step; a little above `SHRINK` keeps the volume."""
REACH = 0.7
"""Largest displacement of a coordinate."""
LEAST_WALL = 0.3
"""Walls one cell thick keep at least this thickness along their axis."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockySurface:
    """Quads of a blocky solid; vertices in lattice units, already on their fitted planes.

    ``locked`` marks the coordinates that a flat patch fixes, ``flat`` the quads of flat patches. ``slant``
    gives, per vertex and axis, the row of ``slants`` that determines the coordinate as ``a u + b v + c`` of
    the next two axes, -1 if none does; such coordinates are locked too. ``walls`` lists (low vertex, high
    vertex, axis) across walls one cell thick.
    """

    vertices: Float[np.ndarray, "V 3"]
    quads: Int[np.ndarray, "Q 4"]
    flat: Bool[np.ndarray, "Q"]
    locked: Bool[np.ndarray, "V 3"]
    walls: Int[np.ndarray, "W 3"]
    slant: Int[np.ndarray, "V 3"]
    slants: Float[np.ndarray, "S 3"]


def smooth_surface(surface: BlockySurface) -> Float[np.ndarray, "V 3"]:
    """Smoothed vertex positions: round on curved surfaces, unchanged at locked coordinates.

    Uses Taubin's alternating steps. A vertex on a curved or slanted quad follows its neighbours along such
    quads only, so that the rim between a curved side and a flat end stays sharp. Other vertices follow all
    their neighbours, so that a flat end adapts to its smoothed rim.
    """
    if surface.flat.all():
        return surface.vertices
    curved = surface.quads[~surface.flat]
    ids = np.unique(curved)
    out = surface.vertices.copy()
    out[ids] = _smooth_curved(surface, curved, ids)
    return _relax_flat(surface, put_on_slants(out, surface.slant, surface.slants), ids)


def put_on_slants(
    vertices: Float[np.ndarray, "V 3"], slant: Int[np.ndarray, "V 3"], slants: Float[np.ndarray, "S 3"]
) -> Float[np.ndarray, "V 3"]:
    """Moves every vertex along its slanted axes onto the planes; where two meet, onto both."""
    out = vertices.copy()
    for _ in range(3):  # slopes below one make the iteration converge quickly to the intersection
        for axis in range(3):
            rows = np.flatnonzero(slant[:, axis] >= 0)
            a, b, c = slants[slant[rows, axis]].T
            out[rows, axis] = a * out[rows, (axis + 1) % 3] + b * out[rows, (axis + 2) % 3] + c
    return out


def stretch_to_box(
    vertices: Float[np.ndarray, "V 3"],
    free: Bool[np.ndarray, "V 3"],
    box: Float[np.ndarray, "2 3"],
    reach: float,
) -> Float[np.ndarray, "V 3"]:
    """Moves the unlocked coordinates near the extremes so that the surface touches its box.

    The shift fades to zero within `_STRETCHED` cells. A side more than ``reach`` cells from its box face is
    unchanged. Lattice units.
    """
    out = vertices.copy()
    for axis in range(3):
        for side, sign in ((0, -1.0), (1, 1.0)):
            outward = sign * out[:, axis]
            missing = sign * box[side, axis] - outward.max()
            if abs(missing) > reach:
                continue
            weight = np.clip(1.0 - (outward.max() - outward) / _STRETCHED, 0.0, 1.0)
            out[:, axis] += sign * missing * weight * free[:, axis]
    return out


def _smooth_curved(surface: BlockySurface, quads: np.ndarray, ids: np.ndarray) -> np.ndarray:
    """Positions of the vertices ``ids`` on curved quads; they depend on no other vertices."""
    number = np.full(len(surface.vertices), -1)
    number[ids] = np.arange(len(ids))
    mean = _neighbour_mean(number[quads], len(ids))
    walls = surface.walls.copy()
    walls[:, :2] = number[walls[:, :2]]
    walls = walls[(walls[:, :2] >= 0).all(axis=1)]
    start, free = surface.vertices[ids], ~surface.locked[ids]
    low = np.where(free, start - REACH, start)
    high = np.where(free, start + REACH, start)
    at = start
    for _ in range(ITERATIONS):
        for step in (SHRINK, -GROW):
            at = np.clip(at + step * (mean @ at - at), low, high)
        at = _spread_walls(at, free, walls)
    return at


def _relax_flat(surface: BlockySurface, at: np.ndarray, curved_ids: np.ndarray) -> np.ndarray:
    """Lets the vertices of flat quads near curved ones follow, so that no triangle folds over."""
    mean = _neighbour_mean(surface.quads, len(at))
    near = np.zeros(len(at))
    near[curved_ids] = 1.0
    for _ in range(_RELAXED_RINGS):
        near = near + mean @ near
    near[curved_ids] = 0.0
    rows = np.flatnonzero(near)
    if not len(rows):
        return at
    mean = mean[rows]
    out = at.copy()
    for _ in range(2 * _RELAXED_RINGS):
        out[rows] = np.where(surface.locked[rows], at[rows], mean @ out)
    return out


def _neighbour_mean(quads: np.ndarray, count: int) -> csr_array:
    """Row-stochastic matrix that averages each vertex's neighbours along the quads' edges."""
    edges = face_edges(quads)
    edges = np.concatenate([edges, edges[:, ::-1]])
    matrix = csr_array(coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(count, count)))
    degree = np.diff(matrix.indptr)
    matrix.data = 1.0 / np.repeat(degree, degree)
    return matrix


def _spread_walls(at: np.ndarray, free: np.ndarray, walls: np.ndarray) -> np.ndarray:
    """Moves the two sides of thin walls apart if they came closer than `LEAST_WALL`."""
    low, high, axis = walls.T
    missing = LEAST_WALL - (at[high, axis] - at[low, axis])
    thin = missing > 0
    if not thin.any():
        return at
    low, high, axis, missing = low[thin], high[thin], axis[thin], missing[thin]
    share_low, share_high = free[low, axis].astype(float), free[high, axis].astype(float)
    both = np.maximum(share_low + share_high, 1.0)
    down, up = np.zeros_like(at), np.zeros_like(at)
    np.maximum.at(down, (low, axis), missing * share_low / both)
    np.maximum.at(up, (high, axis), missing * share_high / both)
    return at - down + up
