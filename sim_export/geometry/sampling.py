"""Deterministic, evenly spread points on surfaces."""

from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int

from sim_export.geometry.triangles import triangle_areas

_STEP = np.array([0.7548776662466927, 0.5698402909980532])
"""The plastic number's two-dimensional low-discrepancy sequence."""


def sample_triangles(
    triangles: Float[np.ndarray, "F 3 3"], count: int
) -> tuple[Float[np.ndarray, "N 3"], Int[np.ndarray, "N"]]:
    """Evenly spread points on a surface, and the triangle of each; deterministic."""
    total = np.cumsum(triangle_areas(triangles))
    if not len(total) or total[-1] <= 0.0 or count == 0:
        return np.zeros((0, 3)), np.zeros(0, dtype=np.int64)
    at = (np.arange(count) + 0.5) / count * total[-1]
    chosen = np.minimum(np.searchsorted(total, at), len(total) - 1)
    u, v = _find_places(count)
    corners = triangles[chosen]
    points = (
        corners[:, 0]
        + u[:, None] * (corners[:, 1] - corners[:, 0])
        + v[:, None] * (corners[:, 2] - corners[:, 0])
    )
    return points, chosen


@lru_cache(maxsize=8)
def _find_places(count: int) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N"]]:
    """Evenly spread coordinates in a triangle along two of its edges; kept, as few numbers recur."""
    u, v = np.modf(np.arange(1, count + 1)[:, None] * _STEP)[0].T
    over = u + v > 1.0
    return np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v)
