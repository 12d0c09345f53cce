"""Distances between surfaces."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from sim_export.geometry.rows import all_three
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import cross_rows

if TYPE_CHECKING:
    from scipy.spatial import KDTree

MAX_P99 = 0.015
"""Distance between collision and visual, over the object's diagonal, that at most 1 % of the points of either
may exceed (V103)."""
_NEAREST = 8


@dataclass(frozen=True, kw_only=True, eq=False)
class SampledSurface:
    """Triangles with sample points, indexed for search."""

    triangles: Float[np.ndarray, "F 3 3"]
    owner: Int[np.ndarray, "S"]
    """Triangle of each point."""
    tree: "KDTree | None"
    """None for an empty surface."""


def sample_surface_tree(triangles: Float[np.ndarray, "F 3 3"], samples: int) -> SampledSurface:
    """Samples and indexes a surface for `distances_to`."""
    from scipy.spatial import KDTree

    spread, owner = sample_triangles(triangles, samples)
    # Evenly spread points need no balancing, and an unbalanced tree builds three times as fast.
    tree = KDTree(spread, leafsize=16, balanced_tree=False, compact_nodes=False) if len(spread) else None
    return SampledSurface(triangles=triangles, owner=owner, tree=tree)


def surface_distances(
    points: Float[np.ndarray, "N 3"], triangles: Float[np.ndarray, "F 3 3"], samples: int, near: float = 0.0
) -> Float[np.ndarray, "N"]:
    """Distances of points to a surface, see `distances_to`, which it samples with ``samples`` points."""
    if not len(points):
        return np.zeros(0)
    return distances_to(points, sample_surface_tree(triangles, samples), near)


def distances_to(
    points: Float[np.ndarray, "N 3"], surface: SampledSurface, near: float = 0.0
) -> Float[np.ndarray, "N"]:
    """Distance of points to a surface: exact to the triangles under its nearest samples.

    The result is never too small. It is too large, by less than the sample spacing, only where the nearest
    triangle has none of the nearest samples. Distances below ``near`` are to the nearest sample, which is
    several times faster and sufficient if only larger distances matter.
    """
    tree, owner, triangles = surface.tree, surface.owner, surface.triangles
    if tree is None or not len(points):
        return np.full(len(points), np.inf)
    if near > 0.0:
        out = np.asarray(tree.query(points)[0])
        exact = np.flatnonzero(out >= near)
    else:
        out, exact = np.zeros(len(points)), np.arange(len(points))
    if not len(exact):
        return out
    _, nearest = tree.query(points[exact], k=min(_NEAREST, len(owner)))
    candidates = owner[nearest.reshape(len(exact), -1)]  # N K
    repeated = np.repeat(points[exact], candidates.shape[1], axis=0)
    flat = triangle_distances(repeated, triangles[candidates.ravel()])
    out[exact] = flat.reshape(candidates.shape).min(axis=1)
    return out


def triangle_distances(
    points: Float[np.ndarray, "N 3"], triangles: Float[np.ndarray, "N 3 3"]
) -> Float[np.ndarray, "N"]:
    """Distance of each point to its own triangle."""
    edges = np.roll(triangles, -1, axis=1) - triangles  # N 3 3
    offset = points[:, None] - triangles
    length = np.maximum(np.einsum("nki,nki->nk", edges, edges), 1e-30)
    along = np.clip(np.einsum("nki,nki->nk", offset, edges) / length, 0.0, 1.0)
    to_edges = np.linalg.norm(offset - along[..., None] * edges, axis=2).min(axis=1)
    normal = cross_rows(edges[:, 0], edges[:, 1])
    size = np.linalg.norm(normal, axis=1)
    outward = cross_rows(edges.reshape(-1, 3), offset.reshape(-1, 3)).reshape(-1, 3, 3)
    above = all_three(np.einsum("nki,nki->nk", outward, normal[:, None]) >= 0) & (size > 0)
    height = np.abs(np.einsum("ni,ni->n", offset[:, 0], normal)) / np.maximum(size, 1e-30)
    return np.where(above, height, to_edges)
