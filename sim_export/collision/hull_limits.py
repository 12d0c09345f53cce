"""Limits of physics engines on hulls, and how hulls are changed to comply.

PhysX's GPU solver limits vertices, faces and slenderness. It also merges facets that differ by less than
0.7 mm per metre and moves the common plane outwards until it holds all corners, a fan at a time: hulls
that clear each other by a millimetre then touch. Cuts along a swing leave such fans; one plane through
the innermost corner of their facets loses less than that millimetre, and is the same in every engine.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull
from scipy.spatial.distance import pdist

from sim_export.geometry.hulls import (
    box_bounds,
    clip_hull,
    convex_hull,
    hull_length,
    hull_planes,
    hull_volume,
    hull_width,
    reduce_hull,
    replace_hulls,
)
from sim_export.geometry.primitives import is_box
from sim_export.geometry.rows import number_rows
from sim_export.geometry.triangles import area_normals, diagonal_of, face_edges
from sim_export.package import Hull, Link

MOST_OF_LINK = 96
"""Hulls of a link after clearance and additions, at most; check V006 allows as many."""
MAX_CUTS = 5
"""Times that a hull is cut, and its pieces again. A board needs two; a bevelled one that is nearly square
needs four, as its greatest extent runs from corner to corner, and a plate with five corners may need five."""

MAX_VERTICES = 32
"""Most vertices of a hull; 32 have at most 60 faces, whichever of them count as flat."""
MAX_POLYGONS = 54
"""Most faces of a hull, coplanar triangles counted once."""
MIN_WIDTH = 0.0015
"""Least thickness (m); thinner hulls are thickened to it. More than is checked, because files hold
micrometres: rounding bends a face of a hull of 1 mm by a thousandth of its thickness."""
MAX_ASPECT = 60.0
"""Greatest length over thickness; longer hulls are cut and, where that would make too many, first
thickened a little. PhysX handles oblong hulls badly from 64 on, but takes boxes of any length."""
THICKEST = 0.004
"""Thickness, over the object's diagonal, to which long thin hulls are thickened rather than divided."""
COPLANAR = 0.0015
"""Distance of one facet's middle from the other's plane, over the hull's diagonal, below which two
neighbours are one; twice what PhysX merges, since its fans grow."""
MAX_FLATTENED = 0.03
"""Greatest share of a hull's volume that this may cost; what would cost more stays as it is."""
FLATTENED_WIDTH = 0.0012
"""Nor may it leave a hull thinner than this (m)."""
MOST_MERGED = 24
"""Most facets of a hull that are merged, one after the other."""
ALIKE = 1.12
"""A box stands for a hull of up to this many times less volume."""
HALVINGS = 7
"""Times that a hull is divided, and its halves again."""
_SPARE = 0.97
"""Share of the longest allowed length that hulls are made for."""


def comply_hull(hull: Hull) -> Hull:
    """A hull with few enough vertices and faces and thick enough, whatever its length: itself if it is so."""
    for _ in range(4):  # either change may undo a little of the other
        changed = reduce_hull(thicken_hull(hull, MIN_WIDTH), MAX_VERTICES, MAX_POLYGONS)
        if changed is hull:
            break
        hull = changed
    return hull


def trim_hull(hull: Hull) -> tuple[Hull, ...]:
    """A hull within the limits without growing anywhere: fewer vertices, and cut where it is oblong."""
    reduced = reduce_hull(hull, MAX_VERTICES, MAX_POLYGONS)
    return tuple(_cut_to_aspect(reduced))


def hull_aspect(hull: Hull) -> float:
    """Greatest length over least thickness; 1 for boxes, whose length no engine minds."""
    return 1.0 if is_box(hull) else hull_length(hull)[0] / hull_width(hull)[0]


def thicken_hull(hull: Hull, width: float) -> Hull:
    """Stretches a hull along its thinnest direction to ``width``, about its middle."""
    for _ in range(3):  # a needle is thin in two directions
        measured, normal = hull_width(hull)
        if measured >= width * (1.0 - 1e-9):
            break
        heights = hull.vertices @ normal
        middle = (heights.min() + heights.max()) / 2
        hull = convex_hull(hull.vertices + np.outer((heights - middle) * (width / measured - 1.0), normal))
    return hull


def _cut_to_aspect(hull: Hull, depth: int = MAX_CUTS) -> list[Hull]:
    """Cuts a hull across its length until every piece is compact enough.

    Tips of wedges, which never are, are left out.
    """
    count = int(np.ceil(hull_aspect(hull) / MAX_ASPECT - 1e-9))
    if count <= 1:
        return [hull]
    _, direction = hull_length(hull)
    width, _ = hull_width(hull)
    if depth == 0:
        return []
    heights = hull.vertices @ direction
    steps = np.linspace(heights.min(), heights.max(), count + 1)
    out: list[Hull] = []
    for low, high in pairwise(steps):
        piece = clip_hull(hull, direction, high)
        piece = None if piece is None else clip_hull(piece, -direction, -low)
        if piece is not None and hull_width(piece)[0] > 0.5 * width:
            out += _cut_to_aspect(piece, depth - 1)
    return out


def compact_hull(
    hull: Hull,
    thickest: float,
    alike: float = ALIKE,
    halvings: int = HALVINGS,
    reach: float = np.inf,
    lost: float = np.inf,
) -> list[Hull]:
    """A hull, or what stands for it within the limits: its box, a thicker hull, or halves of these.

    A large dome of few corners would lie deep inside of what it stands for; its halves have as many each.

    Args:
        thickest: Thickness (m) up to which a hull is thickened rather than divided.
        alike: Volume of its box over that of a hull up to which the box is taken.
        halvings: Times that it may be divided; what is left oblong then is left out.
        reach: How far (m) its box may stand out of it.
        lost: How far (m) it may stand out of a hull with fewer corners.
    """
    proper = comply_hull(hull)
    compact = hull_aspect(proper) <= MAX_ASPECT
    if compact and (not halvings or _stand_out(hull, proper) <= lost):
        return [proper]
    length, along = hull_length(hull)
    if not compact:
        box = around_box(hull)
        if hull_volume(box) <= alike * hull_volume(hull) and _stand_out(box, hull) <= reach:
            return [box]
        if not halvings:  # the tip of a wedge is thinner the shorter it is
            return []
        # Its longest diagonal, because thickening turns the directions along which its length is measured.
        needed = max(length, float(pdist(hull.vertices).max())) / (_SPARE * MAX_ASPECT)
        if needed <= max(thickest, hull_width(hull)[0]):
            thick = comply_hull(thicken_hull(hull, needed))
            if hull_aspect(thick) <= MAX_ASPECT:
                return [thick]
    heights = hull.vertices @ along
    middle = float(heights.min() + heights.max()) / 2
    halves = (clip_hull(hull, along, middle), clip_hull(hull, -along, -middle))
    return [
        part
        for half in halves
        if half is not None and hull_width(half)[0] >= 0.5 * MIN_WIDTH
        for part in compact_hull(half, thickest, alike, halvings - 1, reach, lost)
    ]


def _stand_out(hull: Hull, other: Hull) -> float:
    """How far (m) the corners of a hull lie beyond the planes of another one."""
    planes = hull_planes(other)
    return float((hull.vertices @ planes[:, :3].T - planes[:, 3]).max())


def around_box(hull: Hull) -> Hull:
    """The smallest box around a hull with a face on its flattest side."""
    normal = hull_width(hull)[1]
    helper = np.eye(3)[int(np.abs(normal).argmin())]
    u = np.cross(normal, helper)
    u /= np.linalg.norm(u)
    axes = np.stack([u, np.cross(normal, u)])
    flat = hull.vertices @ axes.T
    outline = flat[ConvexHull(flat).vertices]
    edges = np.roll(outline, -1, axis=0) - outline
    edges = edges[edges.any(axis=1)]  # two corners may lie in one place
    edges /= np.linalg.norm(edges, axis=1, keepdims=True)
    sides = np.stack([edges, np.column_stack([-edges[:, 1], edges[:, 0]])], axis=1)  # E 2 2
    spread = np.ptp(np.einsum("esi,ni->ens", sides, outline), axis=1)
    rows = sides[int(spread.prod(axis=1).argmin())] @ axes
    return box_along(hull.vertices, np.concatenate([rows, [normal]]))


def box_along(points: Float[np.ndarray, "N 3"], axes: Float[np.ndarray, "3 3"]) -> Hull:
    """The box around points whose edges run along the rows of ``axes``."""
    heights = points @ axes.T
    corners = np.stack(np.meshgrid(*zip(heights.min(axis=0), heights.max(axis=0), strict=True)), axis=-1)
    return convex_hull(corners.reshape(-1, 3) @ axes)


def flatten_links(links: Sequence[Link]) -> tuple[Link, ...]:
    """Links whose hulls have no facets that engines would merge; those without any are the same objects."""
    return replace_hulls(links, [tuple(map(flatten_facets, link.hulls)) for link in links])


def flatten_facets(hull: Hull) -> Hull:
    """A hull inside of the given one, with one facet in place of neighbours that are nearly coplanar."""
    if box_bounds(hull) is not None:
        return hull
    tolerance = COPLANAR * diagonal_of(hull.vertices)
    least = (1.0 - MAX_FLATTENED) * hull_volume(hull)
    flat = hull
    for _ in range(MOST_MERGED):
        plane = _merged_plane(flat, tolerance)
        cut = None if plane is None else clip_hull(flat, plane[:3], float(plane[3]))
        if cut is None or cut is flat:
            break
        if hull_volume(cut) < least or hull_width(cut)[0] < FLATTENED_WIDTH:
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
    first, facet = number_rows(np.rint(1e7 * planes).astype(np.int64))
    corners = hull.vertices[hull.faces]
    areas = np.linalg.norm(area_normals(corners), axis=1)
    total = np.bincount(facet, weights=areas)
    middles = (
        np.stack([np.bincount(facet, weights=areas * corners.mean(axis=1)[:, n]) for n in range(3)], axis=1)
        / np.maximum(total, 1e-300)[:, None]
    )
    normals, offsets = planes[first, :3], planes[first, 3]
    edges = np.sort(face_edges(hull.faces), axis=1)
    owner = np.tile(facet, 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    pairs = owner[order].reshape(-1, 2)
    pairs = np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1)
    pairs = pairs[number_rows(pairs)[0]]
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
