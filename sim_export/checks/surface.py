"""Points on surfaces and how far apart two surfaces are."""

import numpy as np
from jaxtyping import Bool, Float, Int

from sim_export.hulls import hull_planes
from sim_export.package import Hull

_STEP = np.array([0.7548776662466927, 0.5698402909980532])
"""The plastic number's two-dimensional low-discrepancy sequence."""


def triangle_areas(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "F"]:
    """Area of each triangle."""
    edges = triangles[:, 1:] - triangles[:, :1]
    return np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 2.0


def sample_triangles(
    triangles: Float[np.ndarray, "F 3 3"], count: int
) -> tuple[Float[np.ndarray, "N 3"], Int[np.ndarray, "N"]]:
    """Evenly spread points on a surface, always the same ones, and the triangle each lies on."""
    total = np.cumsum(triangle_areas(triangles))
    if not len(total) or total[-1] <= 0.0 or count == 0:
        return np.zeros((0, 3)), np.zeros(0, dtype=np.int64)
    at = (np.arange(count) + 0.5) / count * total[-1]
    chosen = np.minimum(np.searchsorted(total, at), len(total) - 1)
    u, v = np.modf(np.arange(1, count + 1)[:, None] * _STEP)[0].T
    over = u + v > 1.0
    u, v = np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v)
    corners = triangles[chosen]
    points = (
        corners[:, 0]
        + u[:, None] * (corners[:, 1] - corners[:, 0])
        + v[:, None] * (corners[:, 2] - corners[:, 0])
    )
    return points, chosen


def inside_hulls(
    points: Float[np.ndarray, "N 3"], hulls: tuple[Hull, ...], depth: float = 0.0
) -> Bool[np.ndarray, "N"]:
    """Points that lie at least ``depth`` (m) deep in some hull."""
    out = np.zeros(len(points), dtype=bool)
    for hull in hulls:
        low, high = hull.vertices.min(axis=0) + depth, hull.vertices.max(axis=0) - depth
        near = np.flatnonzero(~out & np.all((points >= low) & (points <= high), axis=1))
        if len(near):
            planes = hull_planes(hull)
            deep = points[near] @ planes[:, :3].T - planes[:, 3] <= -depth
            out[near[deep.all(axis=1)]] = True
    return out


def nearest_distances(
    points: Float[np.ndarray, "N 3"], target: Float[np.ndarray, "M 3"]
) -> Float[np.ndarray, "N"]:
    """Distance of every point to the nearest target point; infinite where there is none."""
    from scipy.spatial import cKDTree

    if not len(target):
        return np.full(len(points), np.inf)
    return cKDTree(target).query(points)[0]
