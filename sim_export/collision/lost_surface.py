"""Where a link is seen but not felt, and what its solids have there."""

from collections.abc import Sequence

import manifold3d
import numpy as np
from jaxtyping import Float

from sim_export.checks.surface import inside_hulls, surface_distances
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.solids import as_solid, solid_arrays
from sim_export.package import Hull

_DENSER = 4
"""The surface measured to has this many times the samples of the points measured from."""
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
    corners = solid[face]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    felt = felt[~inside_hulls(felt + _SKIN * normals, tuple(hulls))]
    back = surface_distances(felt, triangles, _DENSER * samples, least)
    far = np.flatnonzero(back > least)
    far = far[winding_numbers(felt[far], triangles) > 0.5]
    lost = forth > least
    return np.concatenate([seen[lost], felt[far]]), np.concatenate([forth[lost], back[far]])


def winding_numbers(
    points: Float[np.ndarray, "N 3"], triangles: Float[np.ndarray, "F 3 3"]
) -> Float[np.ndarray, "N"]:
    """1 inside of a closed mesh, 0 outside."""
    out = np.zeros(len(points))
    for index, point in enumerate(points):
        a, b, c = np.moveaxis(triangles - point, 1, 0)
        x, y, z = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        above = np.einsum("ij,ij->i", a, np.cross(b, c))
        dots = [np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a))]
        out[index] = np.arctan2(above, x * y * z + dots[0] * z + dots[1] * x + dots[2] * y).sum()
    return out / (2.0 * np.pi)


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
