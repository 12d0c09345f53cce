"""Cuts surfaces of revolution, such as those of bottles, pots and lids, into sectors about their axis.

Each sector is nearly convex; planes along the axes of the object would take three times as many pieces.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sim_export.collision.cover.surface_pieces import cut_triangles
from sim_export.geometry.rows import number_rows
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import triangle_normals

AXIS_SAMPLES = 4000
"""Points by which a surface is judged to be one of revolution."""
ALONG = 0.9
"""Component of a normal along the axis from which on a point is on an end, which any plate has."""
LEAST_SIDE = 0.2
"""Share of a surface that is no end."""
RING = 0.02
"""Width and height of a ring about the axis, over the longest edge of the surface."""
TURNS = 16
"""Parts into which rings are divided."""
CLOSED = 0.75
"""Share of these parts that a closed ring has."""
ROUND = 0.7
"""Share of the sides of a surface of revolution that is in closed rings."""
SAGITTA = 0.008
"""Depth of the arc of a sector over the object's diagonal; half of what check V103 allows."""
FEWEST, MOST = 6, 24
"""Sectors of a surface."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Axis:
    """A line in space, and the radius (m) of what turns about it."""

    direction: Float[np.ndarray, "3"]
    point: Float[np.ndarray, "3"]
    radius: float


def find_axis(triangles: Float[np.ndarray, "F 3 3"]) -> Axis | None:
    """The axis of a surface of revolution that is parallel to an axis of the object; None for other
    surfaces."""
    points, face = sample_triangles(triangles, AXIS_SAMPLES)
    normals = triangle_normals(triangles)[face]
    found = [_judge_axis(direction, points, normals) for direction in np.eye(3)]
    share, axis = max(found, key=lambda pair: pair[0])
    return axis if share >= ROUND else None


def _judge_axis(
    direction: Float[np.ndarray, "3"], points: Float[np.ndarray, "N 3"], normals: Float[np.ndarray, "N 3"]
) -> tuple[float, Axis]:
    """The best axis in a direction, and the share of the surface's sides that is in closed rings about it."""
    side = np.abs(normals @ direction) < ALONG
    point = _fit_axis(direction, points[side], normals[side]) if side.mean() >= LEAST_SIDE else np.zeros(3)
    height = (points - point) @ direction
    arms = points - point - np.outer(height, direction)
    radii = np.linalg.norm(arms, axis=1)
    across = np.roll(direction, 1)
    turn = np.arctan2(arms @ np.cross(direction, across), arms @ across) / (2.0 * np.pi) % 1.0
    width = RING * float(np.ptp(points, axis=0).max())
    rings = np.round(np.column_stack([height, radii]) / width).astype(np.int64)
    ring = number_rows(rings)[1]
    filled = np.zeros((int(ring.max()) + 1, TURNS), dtype=bool)
    filled[ring, np.minimum((turn * TURNS).astype(np.int64), TURNS - 1)] = True
    closed = (filled.mean(axis=1) >= CLOSED)[ring]
    share = float(closed[side].mean()) if side.mean() >= LEAST_SIDE else 0.0
    return share, Axis(direction=direction, point=point, radius=float(radii.max()))


def _fit_axis(
    direction: Float[np.ndarray, "3"], points: Float[np.ndarray, "N 3"], normals: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "3"]:
    """A point on the line in a direction that most normals meet: ``n @ (direction x (p - point)) = 0``.

    The sum of distances is least, found in ten rounds of weighted least squares, so that a handle counts no
    more than its share.
    """
    rows = np.cross(normals, direction)
    offsets = np.einsum("nk,nk->n", normals, np.cross(direction, points))
    near = 2e-3 * float(np.ptp(points, axis=0).max())  # below this distance all normals count alike
    point, weights = np.zeros(3), np.ones(len(points))
    for _ in range(10):
        weighted = rows * weights[:, None]
        point = np.linalg.lstsq(weighted.T @ rows, weighted.T @ offsets, rcond=None)[0]
        weights = 1.0 / np.maximum(np.abs(rows @ point - offsets), near)
    return point


def count_sectors(radius: float, depth: float) -> int:
    """Even number of sectors whose arcs of a radius (m) are less deep (m)."""
    needed = np.pi / np.arccos(1.0 - min(depth / radius, 1.0))
    return int(np.clip(2 * np.ceil(needed / 2.0), FEWEST, MOST))


def cut_sectors(
    triangles: Float[np.ndarray, "F 3 3"], axis: Axis, count: int, done: int = 0
) -> list[Float[np.ndarray, "G 3 3"]]:
    """The triangles of every sector that has any, divided by planes through the axis.

    Each plane divides two opposite sectors; the first ``done`` planes have divided the triangles already.
    """
    if not len(triangles) or 2 * done == count:
        return [triangles] if len(triangles) else []
    angle, across = 2.0 * np.pi * done / count, np.roll(axis.direction, 1)
    normal = np.cos(angle) * across + np.sin(angle) * np.cross(axis.direction, across)
    halves = cut_triangles(triangles, normal, float(normal @ axis.point))
    return [part for half in halves for part in cut_sectors(half, axis, count, done + 1)]
