"""Smooths blocky surfaces while keeping locked coordinates, sharp rims and thin walls."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array, csr_array

_RELAXED_RINGS = 4
"""How far from a curved surface the vertices of flat ones follow, in cells."""
_STRETCHED = 4.0
"""Cells from an extreme over which a curved surface is stretched to its box."""


@dataclass(frozen=True, kw_only=True)
class SmoothingConfig:
    """How strongly the unlocked coordinates are smoothed; lengths in cells."""

    iterations: int = 80
    """Pairs of a shrinking and a growing step; more reach further along gentle slopes."""
    shrink: float = 0.6
    """Fraction of the way to the neighbours' mean in the shrinking step."""
    grow: float = 0.605
    """Fraction of the way back in the growing step; a little above ``shrink`` keeps the volume."""
    reach: float = 0.7
    """Farthest a coordinate may move from where it started; raise it if stairs remain on slopes."""
    least_wall: float = 0.3
    """Walls one cell thick keep at least this thickness along their axis."""

    def __post_init__(self) -> None:
        if self.iterations < 0:
            raise ValueError(f"smoothing: iterations is {self.iterations}, expected 0 or more")
        for name in ("shrink", "grow", "reach", "least_wall"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"smoothing: {name} is {getattr(self, name)}, expected 0 to 1")


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockySurface:
    """Quads of a blocky solid; vertices in lattice units, already on their fitted planes.

    ``locked`` marks the coordinates that a flat patch fixes, ``flat`` the quads of flat patches.
    ``slant`` numbers, per vertex and axis, the row of ``slants`` that gives the coordinate as
    ``a u + b v + c`` of the next two axes, -1 where none does; such coordinates are locked too.
    ``walls`` lists (low vertex, high vertex, axis) across walls one cell thick.
    """

    vertices: Float[np.ndarray, "V 3"]
    quads: Int[np.ndarray, "Q 4"]
    flat: Bool[np.ndarray, "Q"]
    locked: Bool[np.ndarray, "V 3"]
    walls: Int[np.ndarray, "W 3"]
    slant: Int[np.ndarray, "V 3"]
    slants: Float[np.ndarray, "S 3"]


def smooth_surface(surface: BlockySurface, cfg: SmoothingConfig | None = None) -> Float[np.ndarray, "V 3"]:
    """New vertex positions: round where the surface is curved, unchanged where coordinates are locked.

    Taubin's alternating steps. A vertex on a curved or slanted quad follows its neighbours along such
    quads only, so that the rim between a curved side and a flat end stays sharp; the others follow
    all their neighbours, so that a flat end adapts to its smoothed rim.
    """
    cfg = cfg or SmoothingConfig()
    if surface.flat.all() or cfg.iterations == 0:
        return surface.vertices
    curved = surface.quads[~surface.flat]
    ids = np.unique(curved)
    out = surface.vertices.copy()
    out[ids] = _smooth_curved(surface, curved, ids, cfg)
    return _relax_flat(surface, put_on_slants(out, surface.slant, surface.slants), ids)


def put_on_slants(
    vertices: Float[np.ndarray, "V 3"], slant: Int[np.ndarray, "V 3"], slants: Float[np.ndarray, "S 3"]
) -> Float[np.ndarray, "V 3"]:
    """Moves every vertex along its slanted axes onto the planes; where two meet, onto both."""
    out = vertices.copy()
    for _ in range(3):  # the planes' slopes are below one, so their intersection is approached fast
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

    The shift fades to zero within `_STRETCHED` cells. A side farther than ``reach`` cells from its
    box face is left alone. Lattice units.
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


def _smooth_curved(
    surface: BlockySurface, quads: np.ndarray, ids: np.ndarray, cfg: SmoothingConfig
) -> np.ndarray:
    """Positions of the vertices ``ids`` on curved quads; they depend on no others."""
    number = np.full(len(surface.vertices), -1)
    number[ids] = np.arange(len(ids))
    mean = _neighbour_mean(number[quads], len(ids))
    walls = surface.walls.copy()
    walls[:, :2] = number[walls[:, :2]]
    walls = walls[(walls[:, :2] >= 0).all(axis=1)]
    start, free = surface.vertices[ids], ~surface.locked[ids]
    low = np.where(free, start - cfg.reach, start)
    high = np.where(free, start + cfg.reach, start)
    at = start
    for _ in range(cfg.iterations):
        for step in (cfg.shrink, -cfg.grow):
            at = np.clip(at + step * (mean @ at - at), low, high)
        at = _spread_walls(at, free, walls, cfg.least_wall)
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
    edges = np.concatenate([quads[:, [n, (n + 1) % 4]] for n in range(4)])
    edges = np.concatenate([edges, edges[:, ::-1]])
    matrix = csr_array(coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(count, count)))
    degree = np.diff(matrix.indptr)
    matrix.data = 1.0 / np.repeat(degree, degree)
    return matrix


def _spread_walls(at: np.ndarray, free: np.ndarray, walls: np.ndarray, least: float) -> np.ndarray:
    """Moves the two sides of thin walls apart where they came closer than ``least``."""
    low, high, axis = walls.T
    missing = least - (at[high, axis] - at[low, axis])
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
