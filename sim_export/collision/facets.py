"""Merges nearly coplanar facets inside the hull, before engines merge them outside.

Cuts along a swing leave fans of facets a degree or two apart. PhysX merges facets that differ by less
than 0.7 mm per metre and moves the common plane outwards until it holds all corners, a fan at a
time: hulls that clear each other by a millimetre then touch. One plane through the innermost corner of such
facets loses less than that millimetre, and is the same in every engine.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from sim_export.collision.hull_limits import hull_aspect
from sim_export.collision.hulls import box_bounds, clip_hull, hull_planes, hull_volume, hull_width
from sim_export.package import Hull, Link

TOLERANCE = 0.0015
"""Distance of one facet's middle from the other's plane, over the hull's diagonal, below which two
neighbours are one; twice what PhysX merges, since its fans grow."""
MAX_REMOVED = 0.03
"""Greatest share of a hull's volume that this may cost; what would cost more stays as it is."""
MIN_WIDTH = 0.0012
"""Nor may it leave a hull thinner than this (m)."""
MAX_ASPECT = 60.0
"""Nor longer than so many thicknesses."""
MOST = 24
"""Most planes of a hull."""


def flatten_links(links: Sequence[Link]) -> tuple[Link, ...]:
    """Links whose hulls have no facets that engines would merge; those without any are the same objects."""
    out = []
    for link in links:
        hulls = tuple(flatten_facets(hull) for hull in link.hulls)
        same = all(new is old for new, old in zip(hulls, link.hulls, strict=True))
        out.append(link if same else replace(link, hulls=hulls))
    return tuple(out)


def flatten_facets(hull: Hull) -> Hull:
    """A hull inside of the given one, with one facet in place of neighbours that are nearly coplanar."""
    if box_bounds(hull) is not None:
        return hull
    tolerance = TOLERANCE * float(np.linalg.norm(np.ptp(hull.vertices, axis=0)))
    least = (1.0 - MAX_REMOVED) * hull_volume(hull)
    flat = hull
    for _ in range(MOST):
        plane = _merged_plane(flat, tolerance)
        cut = None if plane is None else clip_hull(flat, plane[:3], float(plane[3]))
        if cut is None or cut is flat:
            break
        if hull_volume(cut) < least or hull_width(cut)[0] < MIN_WIDTH:
            break
        if len(cut.vertices) > len(hull.vertices) or hull_aspect(cut) > MAX_ASPECT:
            break
        flat = cut
    return flat


def _merged_plane(hull: Hull, tolerance: float) -> Float[np.ndarray, "4"] | None:
    """The plane inside of the two neighbouring facets that differ least, or `None` if none do so little."""
    planes = hull_planes(hull)
    if len(planes) != len(hull.faces):  # a face without area
        return None
    facet = np.unique(np.round(planes, 7) + 0.0, axis=0, return_inverse=True)[1].ravel()
    corners = hull.vertices[hull.faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    total = np.bincount(facet, weights=areas)
    middles = (
        np.stack([np.bincount(facet, weights=areas * corners.mean(axis=1)[:, n]) for n in range(3)], axis=1)
        / np.maximum(total, 1e-300)[:, None]
    )
    first = np.unique(facet, return_index=True)[1]
    normals, offsets = planes[first, :3], planes[first, 3]
    edges = np.sort(
        np.concatenate([hull.faces[:, [0, 1]], hull.faces[:, [1, 2]], hull.faces[:, [2, 0]]]), axis=1
    )
    owner = np.tile(facet, 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    pairs = owner[order].reshape(-1, 2)
    pairs = np.unique(np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1), axis=0)
    if not len(pairs):
        return None
    a, b = pairs.T
    apart = np.maximum(
        offsets[a] - np.einsum("ij,ij->i", normals[a], middles[b]),
        offsets[b] - np.einsum("ij,ij->i", normals[b], middles[a]),
    )
    apart[np.einsum("ij,ij->i", normals[a], normals[b]) < 0.9] = np.inf
    best = int(apart.argmin())
    if apart[best] > tolerance:
        return None
    normal = total[a[best]] * normals[a[best]] + total[b[best]] * normals[b[best]]
    normal /= np.linalg.norm(normal)
    members = np.unique(hull.faces[(facet == a[best]) | (facet == b[best])])
    return np.append(normal, float((hull.vertices[members] @ normal).min()))
