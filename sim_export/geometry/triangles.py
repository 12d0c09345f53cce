"""Arrays of triangles: normals, areas, slivers, edges, and boxes around them."""

import numpy as np
from jaxtyping import Bool, Float, Int


def cross_rows(a: Float[np.ndarray, "N 3"], b: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3"]:
    """Cross product row by row; `numpy.cross` takes four times longer on few rows."""
    x, y, z = a.T
    u, v, w = b.T
    out = np.empty(a.shape)
    out[:, 0], out[:, 1], out[:, 2] = y * w - z * v, z * u - x * w, x * v - y * u
    return out


def area_normals(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "F 3"]:
    """Normals with the length of twice the area of each triangle."""
    return cross_rows(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def triangle_normals(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "F 3"]:
    """Unit normals; those of triangles without area are 0."""
    normals = area_normals(triangles)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def triangle_areas(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "F"]:
    """Area of each triangle."""
    return np.linalg.norm(area_normals(triangles), axis=1) / 2.0


def find_slivers(triangles: Float[np.ndarray, "F 3 3"], ratio: float) -> Bool[np.ndarray, "F"]:
    """Triangles with a height of at most ``ratio`` of their longest edge."""
    longest = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2).max(axis=1)
    return 2.0 * triangle_areas(triangles) <= ratio * longest**2


def face_edges(faces: Int[np.ndarray, "F K"]) -> Int[np.ndarray, "E 2"]:
    """Directed edges of polygons: those from every first corner to the second, then those from there on."""
    sides = faces.shape[1]
    return np.concatenate([faces[:, [n, (n + 1) % sides]] for n in range(sides)])


def bounds_of(points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner of the box around points."""
    return np.stack([points.min(axis=0), points.max(axis=0)])


def diagonal_of(points: Float[np.ndarray, "N 3"]) -> float:
    """Length of the diagonal of the box around points."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def meet_box(
    triangles: Float[np.ndarray, "F 3 D"], low: Float[np.ndarray, "D"], high: Float[np.ndarray, "D"]
) -> Bool[np.ndarray, "F"]:
    """Triangles whose boxes overlap the one from ``low`` to ``high``."""
    return ((triangles.min(axis=1) <= high) & (triangles.max(axis=1) >= low)).all(axis=1)
