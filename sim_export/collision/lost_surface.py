"""Surface of a link that lost its collision, and the solids there."""

from collections.abc import Sequence

import manifold3d
import numpy as np
from jaxtyping import Bool, Float

from sim_export.checks.surface import inside_hulls, surface_distances
from sim_export.geometry.exposure import triangle_normals
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.solids import as_solid, solid_arrays
from sim_export.package import Hull

_DENSER = 4
"""The surface measured to has this many times the samples of the points measured from."""
_CHUNK = 512
"""Points that are tested against all faces at a time."""
_SKIN = 1e-3
"""A face covered by another hull of the link at this distance (m) is no outer surface."""


def find_lost(
    triangles: Float[np.ndarray, "F 3 3"], hulls: Sequence[Hull], samples: int, least: float
) -> tuple[Float[np.ndarray, "N 3"], Float[np.ndarray, "N"]]:
    """Points farther than ``least`` (m) from the other surface, and how far: what is lost of a link.

    They are seen but not felt, or felt inside of the solid where nothing is seen. Points on hulls that
    bulge out of the solid are not among them.
    """
    solid = np.concatenate([hull.vertices[hull.faces] for hull in hulls])
    seen, _ = sample_triangles(triangles, samples)
    seen = seen[~inside_hulls(seen, tuple(hulls))]
    forth = surface_distances(seen, solid, _DENSER * samples, least)
    felt, face = sample_triangles(solid, samples)
    felt = felt[~inside_hulls(felt + _SKIN * triangle_normals(solid)[face], tuple(hulls))]
    back = surface_distances(felt, triangles, _DENSER * samples, least)
    far = np.flatnonzero(back > least)
    far = far[inside_mesh(felt[far], triangles)]
    lost = forth > least
    return np.concatenate([seen[lost], felt[far]]), np.concatenate([forth[lost], back[far]])


def inside_mesh(
    points: Float[np.ndarray, "N 3"], triangles: Float[np.ndarray, "F 3 3"]
) -> Bool[np.ndarray, "N"]:
    """Points inside of a closed mesh: those over which more of its faces look up than down."""
    out = np.zeros(len(points), dtype=bool)
    # A little aside, so that no point lies below an edge of faces that are aligned with each other.
    shifted = points + 1e-7 * float(np.ptp(triangles.reshape(-1, 3), axis=0).max()) * np.array(
        [1.0, 0.618, 0]
    )
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    for first in range(0, len(points), _CHUNK):
        part = shifted[first : first + _CHUNK]
        over = (high[:, 2] >= part[:, None, 2]) & (low[:, 0] <= part[:, None, 0])
        over &= (part[:, None, 0] <= high[:, 0]) & (low[:, 1] <= part[:, None, 1])
        over &= part[:, None, 1] <= high[:, 1]
        point, face = np.nonzero(over)
        corners = triangles[face] - part[point, None]  # K 3 3
        x, y, z = corners[:, :, 0], corners[:, :, 1], corners[:, :, 2]
        # Signed areas of the three triangles that the point's foot makes with the edges, seen from above.
        parts = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
        within = (parts > 0).all(axis=1) | (parts < 0).all(axis=1)
        parts, z, point = parts[within], z[within], point[within]
        # parts[k] belongs to edge k -> k + 1 and so weighs the corner k + 2.
        height = (parts * np.roll(z, -2, axis=1)).sum(axis=1) / parts.sum(axis=1)
        above = height > 0
        turns = np.bincount(point[above], weights=np.sign(parts.sum(axis=1))[above], minlength=len(part))
        out[first : first + _CHUNK] = turns > 0.5
    return out


def group_points(
    points: Float[np.ndarray, "N 3"], distances: Float[np.ndarray, "N"], reach: float
) -> list[Float[np.ndarray, "K 3"]]:
    """Points that are linked by steps of at most ``reach`` (m), the group with the farthest first."""
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    tree = KDTree(points)
    near = tree.sparse_distance_matrix(tree, reach)
    near.setdiag(1.0)
    groups = connected_components(near, directed=False)[1]
    order = sorted(range(int(groups.max()) + 1), key=lambda group: -distances[groups == group].max())
    return [points[groups == group] for group in order]


def cut_out(
    points: Float[np.ndarray, "N 3"], solid: manifold3d.Manifold, pad: float
) -> list[manifold3d.Manifold]:
    """The connected pieces that a solid has around some points, up to ``pad`` (m) from their box."""
    low, high = points.min(axis=0) - pad, points.max(axis=0) + pad
    box = manifold3d.Manifold.cube(tuple(high - low)).translate(tuple(low))
    pieces = [piece for piece in (solid ^ box).decompose() if piece.volume() > 0.0]
    return [piece for piece in pieces if _holds(piece, points, 0.1 * pad)]


def _holds(piece: manifold3d.Manifold, points: np.ndarray, slack: float) -> bool:
    """Whether any of the points is in the box of a piece, or nearly."""
    box = np.array(piece.bounding_box())
    return bool(((points >= box[:3] - slack) & (points <= box[3:] + slack)).all(axis=1).any())


def stands_out(hull: Hull, solids: Sequence[manifold3d.Manifold]) -> float:
    """How far (m) a hull stands out of the solids, at most."""
    rest = as_solid(hull)
    for solid in solids:
        rest = rest - solid
    if rest.is_empty():
        return 0.0
    surface, faces = solid_arrays(manifold3d.Manifold.batch_boolean(list(solids), manifold3d.OpType.Add))
    reach = float(np.linalg.norm(np.ptp(hull.vertices, axis=0)))
    corners = surface[faces]
    low, high = hull.vertices.min(axis=0) - reach, hull.vertices.max(axis=0) + reach
    near = ((corners.max(axis=1) >= low) & (corners.min(axis=1) <= high)).all(axis=1)
    return float(surface_distances(solid_arrays(rest)[0], corners[near], 5000).max())
