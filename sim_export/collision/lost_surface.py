"""Surface of a link that lost its collision, and the solids there."""

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


def find_lost(
    triangles: Float[np.ndarray, "F 3 3"], hulls: Sequence[Hull], samples: int, least: float
) -> tuple[Float[np.ndarray, "N 3"], Float[np.ndarray, "N"]]:
    """Points of a link's surface farther than ``least`` (m) from its hulls, and how far: seen, not felt."""
    solid = np.concatenate([hull.vertices[hull.faces] for hull in hulls])
    seen, _ = sample_triangles(triangles, samples)
    seen = seen[~inside_hulls(seen, tuple(hulls))]
    away = surface_distances(seen, solid, _DENSER * samples, least)
    return seen[away > least], away[away > least]


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
