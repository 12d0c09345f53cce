"""Parallel rays through triangles: distances to surfaces, cosines, and free depths behind them."""

import numpy as np
from jaxtyping import Float

from sim_export.geometry.triangles import area_normals, meet_box


def plane_axes(normal: Float[np.ndarray, "3"]) -> tuple[np.ndarray, np.ndarray]:
    """Two directions perpendicular to ``normal``; object axes if ``normal`` is one."""
    first = np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)


def ray_hits(
    origins: Float[np.ndarray, "R 3"],
    direction: Float[np.ndarray, "3"],
    triangles: Float[np.ndarray, "F 3 3"],
) -> tuple[Float[np.ndarray, "R F"], Float[np.ndarray, "F"]]:
    """Distances of parallel rays to triangles (infinite for misses and hits behind the origin), and for each
    triangle -1 if rays enter through it, 1 if they leave, 0 if it is edge-on."""
    a = triangles[:, 0]
    edge1, edge2 = triangles[:, 1] - a, triangles[:, 2] - a
    facing = np.cross(edge1, edge2) @ direction  # F
    p = np.cross(direction, edge2)
    determinant = np.einsum("fi,fi->f", edge1, p)
    proper = np.abs(determinant) > 1e-15
    scale = np.where(proper, 1.0 / np.where(proper, determinant, 1.0), 0.0)
    s = origins[:, None] - a[None]  # R F 3
    u = np.einsum("rfi,fi->rf", s, p) * scale
    q = np.cross(s, edge1[None])
    v = (q @ direction) * scale
    t = np.einsum("rfi,fi->rf", q, edge2) * scale
    hit = proper & (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0)
    return np.where(hit, t, np.inf), np.sign(facing)


def triangles_in_the_way(
    origins: Float[np.ndarray, "R 3"],
    direction: Float[np.ndarray, "3"],
    triangles: Float[np.ndarray, "F 3 3"],
) -> Float[np.ndarray, "G 3 3"]:
    """Triangles that parallel rays may hit: in projection, their boxes overlap that of the origins."""
    across = np.stack(plane_axes(direction), axis=1)  # 3 2
    flat, seen = triangles @ across, origins @ across
    return triangles[meet_box(flat, seen.min(axis=0), seen.max(axis=0))]


def first_hits(
    origins: Float[np.ndarray, "R 3"],
    direction: Float[np.ndarray, "3"],
    triangles: Float[np.ndarray, "F 3 3"],
    *,
    entering: bool = False,
) -> tuple[Float[np.ndarray, "R"], Float[np.ndarray, "R 3"]]:
    """Distance of each ray to the face that it hits first, infinite if it hits none, and the face's unit
    normal, which is arbitrary then. With ``entering``, only faces that rays enter through count."""
    triangles = triangles_in_the_way(origins, direction, triangles)
    if not len(triangles):
        return np.full(len(origins), np.inf), np.zeros((len(origins), 3))
    distances, sides = ray_hits(origins, direction, triangles)
    if entering:
        distances = np.where(sides < 0, distances, np.inf)
    faces = triangles[distances.argmin(axis=1)]
    normals = area_normals(faces)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)
    return distances.min(axis=1), normals


def hit_cosines(
    origins: Float[np.ndarray, "R 3"],
    direction: Float[np.ndarray, "3"],
    triangles: Float[np.ndarray, "F 3 3"],
    depth: float,
) -> Float[np.ndarray, "R"]:
    """Cosine between each ray and the face that it hits first; 0 if it hits none within ``depth``."""
    distances, normals = first_hits(origins, direction, triangles)
    return np.where(distances <= depth, np.abs(normals @ direction), 0.0)


def free_depths(
    origins: Float[np.ndarray, "R 3"],
    direction: Float[np.ndarray, "3"],
    starts: Float[np.ndarray, "R"],
    triangles: Float[np.ndarray, "F 3 3"],
) -> Float[np.ndarray, "R"]:
    """Free distance of each ray beyond ``starts``; infinite if it hits nothing."""
    triangles = triangles_in_the_way(origins, direction, triangles)
    if not len(triangles):
        return np.full(len(origins), np.inf)
    starts = np.where(np.isfinite(starts), starts, 0.0)
    distances = ray_hits(origins, direction, triangles)[0]
    return np.where(distances >= starts[:, None] - 1e-6, distances, np.inf).min(axis=1) - starts


def bar_depths(
    origins: Float[np.ndarray, "R 3"],
    direction: Float[np.ndarray, "3"],
    triangles: Float[np.ndarray, "F 3 3"],
) -> tuple[np.ndarray, np.ndarray]:
    """Parameters at which each ray enters the handle and first leaves it; infinite for misses."""
    distances, sides = ray_hits(origins, direction, triangles)
    fronts, backs = np.full(len(origins), np.inf), np.full(len(origins), np.inf)
    for row in range(len(origins)):
        hits = np.flatnonzero(np.isfinite(distances[row]) & (sides != 0))
        if not len(hits):
            continue
        # A ray through an edge shared by two triangles must count once.
        keys = np.unique(np.stack([np.round(distances[row, hits], 7), sides[hits]], axis=1), axis=0)
        depth = np.cumsum(-keys[:, 1])
        fronts[row] = keys[0, 0]
        out = np.flatnonzero(depth <= 0)
        backs[row] = keys[out[0], 0] if len(out) else keys[-1, 0]
    return fronts, backs
