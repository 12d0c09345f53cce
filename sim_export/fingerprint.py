"""Fingerprints of package geometry: an exact hash, and a descriptor with a meaningful distance.

The descriptor is a histogram of surface area over a grid in the closed object's box, with separate channels
for static and moving links. Areas are distributed to the eight nearest cells with linear weights, so that
small changes have small effects. Half the sum of absolute differences of two descriptors, their total
variation, is the share of the surface that would have to move to turn one object into the other, at the
resolution of the grid.
"""

import hashlib
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from sim_export.geometry.triangles import triangle_areas
from sim_export.package import Link, SimPackage, SourceMesh

CELLS = 8
"""Cells along each axis of the box."""
PIECE = 0.5
"""Longest edge, in cells, of the pieces that triangles are subdivided into."""
STEP = 1e-4
"""Rounding of geometry in the hash (metres)."""
LEVELS = np.iinfo(np.uint16).max
"""Quantisation levels of a share in a stored descriptor."""


def hash_geometry(package: SimPackage) -> str:
    """SHA-256 of links, joints, visual triangles and collision hulls, rounded to `STEP`; independent of
    names, colours, materials and the order of triangles.

    Raises:
        ValueError: If a visual is a source mesh, whose triangles are in a file.
    """
    text = hashlib.sha256()
    for link in package.links:
        text.update(f"link {link.label}\n".encode())
        text.update(_sorted_triangles(_visual_triangles((link,))))
        for hull in link.hulls:
            text.update(np.unique(_round(hull.vertices), axis=0).tobytes())
    place = {link.name: index for index, link in enumerate(package.links)}
    for joint in package.joints:
        numbers = [*joint.origin, *joint.axis, joint.lower, joint.upper, joint.ratio]
        text.update(f"joint {joint.kind} {place[joint.parent]} {place[joint.child]}\n".encode())
        numbers += [joint.spring] if joint.spring > 0.0 else []
        numbers += [joint.offset] if joint.offset != 0.0 else []
        text.update(_round(np.array(numbers)).tobytes())
    return text.hexdigest()


def describe_surface(package: SimPackage) -> Float[np.ndarray, "2 C C C"]:
    """Share of the closed object's visual area in each cell, for static and moving links; sums to 1.

    Raises:
        ValueError: If there is no visual surface, or it consists of source meshes.
    """
    moving = {joint.child for joint in package.joints if joint.type != "fixed"}
    by_child = {joint.child: joint.parent for joint in package.joints}

    def moves(name: str | None) -> bool:
        while name is not None:
            if name in moving:
                return True
            name = by_child.get(name)
        return False

    kinds = [
        _visual_triangles([link for link in package.links if moves(link.name) == wanted])
        for wanted in (False, True)
    ]
    points = np.concatenate(kinds).reshape(-1, 3)
    if not len(points):
        raise ValueError(f"package {package.name!r} has no visual triangles")
    low = points.min(axis=0)
    size = np.maximum(points.max(axis=0) - low, 1e-9)
    # Areas in metres, positions in cells: shares must not depend on the proportions of the box.
    shares = np.stack([_spread_areas(triangles, low, CELLS / size) for triangles in kinds])
    return shares / shares.sum()


def quantise(descriptor: Float[np.ndarray, "2 C C C"]) -> bytes:
    """A descriptor as 16-bit shares, little endian."""
    return np.rint(descriptor * LEVELS).astype("<u2").tobytes()


def _visual_triangles(links: Sequence[Link]) -> Float[np.ndarray, "F 3 3"]:
    found = [np.zeros((0, 3, 3))]
    for visual in (visual for link in links for visual in link.visuals):
        if isinstance(visual.mesh, SourceMesh):
            raise ValueError(f"visual {visual.name!r} is a source mesh, whose triangles are in a file")  # noqa: TRY004
        found.append(visual.mesh.vertices[visual.mesh.faces])
    return np.concatenate(found)


def _round(values: np.ndarray) -> np.ndarray:
    return np.rint(values / STEP).astype("<i8")


def _sorted_triangles(triangles: np.ndarray) -> bytes:
    """Rounded triangles, each rotated to start at its smallest corner, in ascending order."""
    corners = _round(triangles)
    low = corners.min(axis=(0, 1)) if len(corners) else np.zeros(3, np.int64)
    span = (corners.max(axis=(0, 1)) - low + 1) if len(corners) else np.ones(3, np.int64)
    code = ((corners - low) * np.array([span[1] * span[2], span[2], 1])).sum(axis=2)
    first = code.argmin(axis=1)
    turned = np.take_along_axis(corners, ((first[:, None] + np.arange(3)) % 3)[:, :, None], axis=1)
    flat = turned.reshape(-1, 9)
    return flat[np.lexsort(flat.T[::-1])].tobytes()


def _spread_areas(
    triangles: Float[np.ndarray, "F 3 3"], low: np.ndarray, scale: np.ndarray
) -> Float[np.ndarray, "C C C"]:
    """Area (m^2) near the centre of each cell; `low` and `scale` map points to cells."""
    grid = np.zeros((CELLS,) * 3)
    placed = (triangles - low) * scale
    edges = np.linalg.norm(placed - np.roll(placed, 1, axis=1), axis=2).max(axis=1, initial=0.0)
    counts = np.maximum(np.ceil(edges / PIECE), 1).astype(int)
    areas = triangle_areas(triangles)
    for count in np.unique(counts):
        chosen = counts == count
        weights = _piece_centers(int(count))
        points = np.einsum("pk,fkd->fpd", weights, placed[chosen]).reshape(-1, 3)
        area = np.repeat(areas[chosen] / len(weights), len(weights))
        _add(grid, points, area)
    return grid


def _piece_centers(count: int) -> Float[np.ndarray, "P 3"]:
    """Barycentric centres of the count^2 equal pieces of a triangle."""
    i, j = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    up, down = i + j < count, i + j < count - 1
    u = np.concatenate([i[up] + 1 / 3, i[down] + 2 / 3]) / count
    v = np.concatenate([j[up] + 1 / 3, j[down] + 2 / 3]) / count
    return np.stack([1.0 - u - v, u, v], axis=1)


def _add(grid: np.ndarray, points: Float[np.ndarray, "N 3"], areas: Float[np.ndarray, "N"]) -> None:
    """Distributes areas to the eight cells whose centres surround each point."""
    at = np.clip(points - 0.5, 0.0, CELLS - 1.0)
    base = np.minimum(at.astype(int), CELLS - 2)
    share = at - base
    for corner in np.ndindex(2, 2, 2):
        weight = np.where(corner, share, 1.0 - share).prod(axis=1)
        cell = base + corner
        flat = (cell[:, 0] * CELLS + cell[:, 1]) * CELLS + cell[:, 2]
        grid += np.bincount(flat, areas * weight, CELLS**3).reshape(grid.shape)
