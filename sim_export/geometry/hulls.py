"""Convex polyhedra: hulls of points, planes, volumes, and cutting by half-spaces."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import ConvexHull, QhullError

from artigen.transforms import transform_points
from sim_export.errors import DegeneratePart
from sim_export.geometry.rows import all_three, number_rows
from sim_export.geometry.triangles import area_normals, cross_rows, face_edges
from sim_export.package import Hull, Link

FLAT = 1e-6
"""Points (m) that span less than this in some direction have no hull."""
PLANE = 2e-3
"""Thickness (m) of the hull around a surface that has none, such as a door drawn as one face."""
_KEPT = 4096
"""Hulls whose planes, width and length are kept: each is asked for them many times in a row."""
_BOX_FACES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip


def convex_hull(points: Float[np.ndarray, "N 3"]) -> Hull:
    """Convex hull of points, faces counter-clockwise from outside.

    Raises:
        DegeneratePart: if the points are flat (thinner than ``FLAT``) or fewer than four.
    """
    points = np.asarray(points, dtype=np.float64)
    hull = _find_hull(points)
    return hull if _is_manifold(hull) else _close_hull(points)


def replace_hulls(links: Sequence[Link], hulls: Sequence[tuple[Hull, ...]]) -> tuple[Link, ...]:
    """The links with these hulls; those whose hulls do not change are the same objects."""
    pairs = zip(links, hulls, strict=True)
    return tuple(link if own == link.hulls else replace(link, hulls=own) for link, own in pairs)


def hull_triangles(hulls: Iterable[Hull]) -> Float[np.ndarray, "F 3 3"]:
    """The surfaces of hulls, of which there must be one."""
    return np.concatenate([hull.vertices[hull.faces] for hull in hulls])


def wrap_surface(triangles: Float[np.ndarray, "F 3 3"]) -> tuple[Hull, ...]:
    """One convex hull of triangles, of a plane as thick as `PLANE`; none where they span no plane."""
    points = triangles.reshape(-1, 3)
    for _ in range(2):
        try:
            return (convex_hull(points),)
        except DegeneratePart:
            if len(points) < 3:
                break
            normal = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][2]
            points = np.concatenate([points + PLANE / 2 * normal, points - PLANE / 2 * normal])
    return ()


def _close_hull(points: Float[np.ndarray, "N 3"]) -> Hull:
    """Convex hull of points some of which Qhull cannot tell apart."""
    import manifold3d

    mesh = manifold3d.Manifold.hull_points(points).to_mesh64()
    return Hull(
        vertices=np.array(mesh.vert_properties)[:, :3], faces=np.array(mesh.tri_verts).astype(np.int64)
    )


def _is_manifold(hull: Hull) -> bool:
    """Whether every edge is passed once each way."""
    edges = face_edges(hull.faces)
    count = len(hull.vertices)
    key = np.sort(edges[:, 0] * count + edges[:, 1])
    back = np.sort(edges[:, 1] * count + edges[:, 0])
    return bool((key[1:] != key[:-1]).all() and (key == back).all())


def _find_hull(points: Float[np.ndarray, "N 3"]) -> Hull:
    if len(points) < 4:
        raise DegeneratePart(f"a hull of {len(points)} points: at least 4 are needed")
    center = points.mean(axis=0)
    thickness = _measure_thickness(points) if len(points) < 64 else np.inf
    if thickness < FLAT:
        raise DegeneratePart(f"a hull of {len(points)} points is flat: {thickness:.3g} m across")
    try:
        solved = ConvexHull(points - center)
    except QhullError as err:
        raise DegeneratePart(f"a hull of {len(points)} points is degenerate: {err.args[0][:80]!r}") from err
    used = np.sort(solved.vertices)
    slot = np.full(len(points), -1)
    slot[used] = np.arange(len(used))
    corners = points[solved.simplices]  # F 3 3
    inverted = np.einsum("ij,ij->i", area_normals(corners), solved.equations[:, :3]) < 0
    faces = np.where(inverted[:, None], solved.simplices[:, ::-1], solved.simplices)
    return Hull(vertices=points[used], faces=slot[faces])


def _measure_thickness(points: Float[np.ndarray, "N 3"]) -> float:
    """How far points (m) lie from the plane that fits them best, about."""
    return float(np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[-1])


def box_hull(low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]) -> Hull:
    """An axis-aligned box as a hull of 8 vertices and 12 faces."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    return Hull(vertices=np.where(corners == 0, low, high), faces=_BOX_FACES)


def move_hull(hull: Hull, T: Float[np.ndarray, "4 4"]) -> Hull:
    """Applies a rigid motion to a hull."""
    return Hull(vertices=transform_points(T, hull.vertices), faces=hull.faces)


def box_bounds(hull: Hull) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]] | None:
    """Lowest and highest corner of a hull that is an axis-aligned box, `None` of any other."""
    if hull.vertices.shape != (8, 3):
        return None
    low, high = hull.vertices.min(axis=0), hull.vertices.max(axis=0)
    upper = hull.vertices == high
    aligned = (upper | (hull.vertices == low)).all() and (low < high).all()
    return (low, high) if aligned and len(set(map(bytes, upper))) == 8 else None


@lru_cache(maxsize=_KEPT)
def hull_volume(hull: Hull) -> float:
    """Enclosed volume (m^3)."""
    corners = hull.vertices[hull.faces] - hull.vertices.mean(axis=0)
    return float(np.einsum("ij,ij->", corners[:, 0], cross_rows(corners[:, 1], corners[:, 2])) / 6.0)


@lru_cache(maxsize=_KEPT)
def hull_planes(hull: Hull) -> Float[np.ndarray, "F 4"]:
    """Outward unit normals and offsets: a point ``x`` is inside where ``n @ x <= d`` for every face.

    The array is read-only, since it is kept for the next call.
    """
    corners = hull.vertices[hull.faces]
    normals = area_normals(corners)
    lengths = np.linalg.norm(normals, axis=1)
    proper = lengths > 0
    normals = normals[proper] / lengths[proper, None]
    planes = np.column_stack([normals, np.einsum("ij,ij->i", normals, corners[proper, 0])])
    planes.flags.writeable = False
    return planes


def clip_hull(hull: Hull, normal: Float[np.ndarray, "3"], offset: float) -> Hull | None:
    """The part of a hull with ``normal @ x <= offset``; ``None`` if next to nothing is left."""
    heights = hull.vertices @ normal - offset
    below = heights <= 0.0
    if below.all():
        return hull
    if not below.any():
        return None
    if np.count_nonzero(normal) == 1 and (bounds := box_bounds(hull)) is not None:
        return _clip_box(*bounds, normal, offset)
    edges = np.sort(face_edges(hull.faces))
    edges = edges[number_rows(edges)[0]]
    crossing = edges[below[edges[:, 0]] != below[edges[:, 1]]]
    start, end = heights[crossing[:, 0]], heights[crossing[:, 1]]
    share = (start / (start - end))[:, None]
    cut = (1.0 - share) * hull.vertices[crossing[:, 0]] + share * hull.vertices[crossing[:, 1]]
    try:
        return convex_hull(np.concatenate([hull.vertices[below], cut]))
    except DegeneratePart:
        return None


def _clip_box(low: np.ndarray, high: np.ndarray, normal: np.ndarray, offset: float) -> Hull | None:
    """An axis-aligned box cut across one of its axes."""
    axis = int(np.flatnonzero(normal)[0])
    low, high = low.copy(), high.copy()
    end = high if normal[axis] > 0 else low
    end[axis] = offset / normal[axis]
    return box_hull(low, high) if high[axis] - low[axis] >= FLAT else None


def subtract_hull(hull: Hull, planes: Float[np.ndarray, "F 4"], min_width: float) -> tuple[Hull, ...]:
    """What is left of a hull outside the convex region ``normal @ x <= offset``, as disjoint hulls.

    Planes that cut off most come first, so that few pieces are needed; pieces thinner than
    ``min_width`` are left out.
    """
    inside: Hull | None = hull
    pieces = []
    waiting = list(planes)
    while waiting and inside is not None:
        beyond = [float((inside.vertices @ plane[:3]).max() - plane[3]) for plane in waiting]
        plane = waiting.pop(int(np.argmax(beyond)))
        if max(beyond) <= 0.0:
            break
        piece = clip_hull(inside, -plane[:3], -plane[3])
        if piece is not None and hull_width(piece)[0] >= min_width:
            pieces.append(piece)
        inside = clip_hull(inside, plane[:3], plane[3])
    return tuple(pieces)


def inside_hulls(points: Float[np.ndarray, "N 3"], hulls: Iterable[Hull]) -> Bool[np.ndarray, "N"]:
    """Points that lie in some hull."""
    out = np.zeros(len(points), dtype=bool)
    for hull in hulls:
        low, high = hull.vertices.min(axis=0), hull.vertices.max(axis=0)
        near = np.flatnonzero(~out & all_three((points >= low) & (points <= high)))
        if len(near):
            planes = hull_planes(hull)
            deep = points[near] @ planes[:, :3].T - planes[:, 3] <= 0.0
            out[near[deep.all(axis=1)]] = True
    return out


@lru_cache(maxsize=_KEPT)
def face_planes(hull: Hull) -> Float[np.ndarray, "G 4"]:
    """Planes of a hull (`hull_planes`), those of coplanar triangles given once."""
    planes = hull_planes(hull)
    first, _ = number_rows(np.round(1e5 * planes).astype(np.int64))
    planes = planes[np.sort(first)]
    planes.flags.writeable = False
    return planes


@lru_cache(maxsize=_KEPT)
def hull_width(hull: Hull) -> tuple[float, Float[np.ndarray, "3"]]:
    """Least distance between two parallel planes around a hull, one of them on a face, and its direction."""
    bounds = box_bounds(hull)
    if bounds is not None:
        extents = bounds[1] - bounds[0]
        return float(extents.min()), np.eye(3)[int(extents.argmin())]
    planes = hull_planes(hull)
    widths = planes[:, 3] - (hull.vertices @ planes[:, :3].T).min(axis=0)
    thinnest = int(widths.argmin())
    return float(widths[thinnest]), planes[thinnest, :3]


@lru_cache(maxsize=_KEPT)
def hull_length(hull: Hull) -> tuple[float, Float[np.ndarray, "3"]]:
    """Greatest extent of a hull along its principal directions and the object's axes, and its direction."""
    bounds = box_bounds(hull)
    if bounds is not None:
        extents = bounds[1] - bounds[0]
        return float(extents.max()), np.eye(3)[int(extents.argmax())]
    directions = np.concatenate([np.eye(3), np.linalg.svd(hull.vertices - hull.vertices.mean(axis=0))[2]])
    extents = np.ptp(hull.vertices @ directions.T, axis=0)
    longest = int(extents.argmax())
    return float(extents[longest]), directions[longest]


def count_polygons(hull: Hull) -> int:
    """Faces of a hull with coplanar triangles counted once, as physics engines count them."""
    planes = hull_planes(hull)
    size = np.abs(hull.vertices - hull.vertices.mean(axis=0)).max()
    scaled = np.column_stack(
        [planes[:, :3], (planes[:, 3] - planes[:, :3] @ hull.vertices.mean(axis=0)) / size]
    )
    return len(number_rows(np.rint(1e4 * scaled).astype(np.int64))[0])


def reduce_hull(hull: Hull, max_vertices: int, max_polygons: int) -> Hull:
    """A hull inside the given one within limits, such as those that PhysX sets for its GPU solver.

    Keeps the vertices that lie farthest outside of the hull of those kept before, as many as limits allow.
    """
    reduced, order = hull, None
    while len(reduced.vertices) > max_vertices or (
        len(reduced.faces) > max_polygons and count_polygons(reduced) > max_polygons
    ):
        order = _farthest_first(hull.vertices, max_vertices) if order is None else order[:-2]
        reduced = convex_hull(hull.vertices[order])
    return reduced


def _farthest_first(points: Float[np.ndarray, "N 3"], count: int) -> Int[np.ndarray, "K"]:
    """Up to ``count`` points, each the farthest from the hull of those before it; at first those at the ends
    of the principal axes."""
    along = points @ np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2].T
    first = np.concatenate([along.argmax(axis=0), along.argmin(axis=0)])
    kept = list(dict.fromkeys(first.tolist()))
    while len(kept) < 4 or _measure_thickness(points[kept]) < FLAT:
        middle = points[kept].mean(axis=0)
        across = np.linalg.svd(points[kept] - middle)[2][2]  # of the plane in which they lie
        kept.append(int(np.abs((points - middle) @ across).argmax()))
    while len(kept) < count:
        # Facets that rounding has made wide do to look for the next point.
        planes = ConvexHull(points[kept], qhull_options="Qt Q12").equations
        outside = (points @ planes[:, :3].T + planes[:, 3]).max(axis=1)
        if outside.max() <= FLAT:
            break
        kept.append(int(outside.argmax()))
    return np.array(kept)
