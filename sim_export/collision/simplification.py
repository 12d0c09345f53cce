"""`simplify_hulls`, `simplify_links`: replace convex pieces by boxes and cylinders within a tolerance.

Engines load primitives without cooking, and importers keep them. The pieces of a part are judged together:
the box around a wedge of a ring reaches only into the neighbouring wedges, so the ring stays what it is.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import manifold3d
import numpy as np
from jaxtyping import Float

from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import face_planes, hull_width
from sim_export.geometry.primitives import (
    PrimitiveShape,
    find_primitive,
    place_along,
    place_axes,
    primitive_hull,
)
from sim_export.geometry.solids import unite
from sim_export.geometry.triangles import area_normals, bounds_of
from sim_export.package import Hull

TOLERANCE = 0.0035
"""Metres between the exact surface and a primitive; links may overlap by as much on their way (V201)."""
SHARE = 0.25
"""The same as a share of the piece's thickness, which holds where it is less."""
EXACT = 1e-6
"""Metres; a hull that differs by no more is the same, as files have this precision."""
CANDIDATES = 4
"""Primitives that are tried for a piece, the smallest ones."""
_LEAST_SIDES = 5
"""Corners of a face that may be the cap of a cylinder."""
_FLAT = 1e-6
"""Metres; corners this near to a plane lie on it."""
_SPECK = 1e-12
"""Cubic metres; less than this is rounding."""


def simplify_hulls(hulls: Sequence[Hull]) -> tuple[Hull, ...]:
    """The convex pieces of one part, with a box or cylinder for each piece that nearly is one.

    A primitive stays behind no face of its piece by more than `TOLERANCE`, or `SHARE` of its thickness, and
    reaches beyond the union of the pieces by no more than that, measured along the normals of their faces. Of
    those that do, the smallest one is taken, as large as it may be.

    Args:
        hulls: Convex pieces of a part, which may overlap.

    Returns:
        As many hulls, in order; pieces that stay as they are are the same objects.
    """
    pieces = [_Piece(hull=hull) for hull in hulls]
    return tuple(_simplify(piece, pieces) for piece in pieces)


def simplify_links(parts: Sequence[Sequence[Hull]], owners: Sequence[int]) -> list[tuple[Hull, ...]]:
    """`simplify_hulls` of every part; a piece whose primitive would overlap another link at rest stays exact.

    Args:
        parts: Convex pieces of each part.
        owners: The part that leads the link of each part.
    """
    out = [simplify_hulls(hulls) for hulls in parts]
    for k, hulls in enumerate(parts):
        changed = [i for i, hull in enumerate(hulls) if out[k][i] is not hull]
        others = HullSet(
            hulls=tuple(hull for j, own in enumerate(out) if owners[j] != owners[k] for hull in own)
        )
        found = signed_distances(
            HullSet(hulls=tuple(out[k][i] for i in changed)), others, np.eye(4), np.eye(4)
        )
        met = {changed[first] for first in found.first[found.distance < 0.0].tolist()}
        out[k] = tuple(hulls[i] if i in met else hull for i, hull in enumerate(out[k]))
    return out


def measure_simplified(hulls: Sequence[Hull], simple: Sequence[Hull]) -> list[float]:
    """How far (m) each hull of `simplify_hulls` reaches beyond its part at most; 0 for hulls that stayed.

    Args:
        hulls: The convex pieces.
        simple: The hull for each of them.
    """
    return [
        0.0 if new is old else _reach(new, _Piece(hull=old)) for new, old in zip(simple, hulls, strict=True)
    ]


def _reach(hull: Hull, piece: "_Piece") -> float:
    """The excess of a primitive over its piece; other pieces fill what exceeds the slack."""
    shape = find_primitive(hull)
    return piece.slack if shape is None else min(max(_excess(shape, piece), 0.0), piece.slack)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Piece:
    """A hull with what is asked about it more than once."""

    hull: Hull

    @cached_property
    def planes(self) -> Float[np.ndarray, "K 4"]:
        return face_planes(self.hull)

    @cached_property
    def slack(self) -> float:
        """Metres that a primitive may differ from this piece."""
        return min(TOLERANCE, SHARE * hull_width(self.hull)[0])

    @cached_property
    def bounds(self) -> Float[np.ndarray, "2 3"]:
        return bounds_of(self.hull.vertices)

    def grow(self, margin: float) -> manifold3d.Manifold:
        """The solid with every face moved outwards by ``margin`` (m)."""
        from scipy.spatial import HalfspaceIntersection

        half_spaces = np.column_stack([self.planes[:, :3], -(self.planes[:, 3] + margin)])
        corners = HalfspaceIntersection(half_spaces, self.hull.vertices.mean(axis=0)).intersections
        return manifold3d.Manifold.hull_points(corners)


def _simplify(piece: _Piece, pieces: Sequence[_Piece]) -> Hull:
    if find_primitive(piece.hull) is not None:
        return piece.hull
    around = sorted((*_boxes_around(piece.hull), *_cylinders_around(piece.hull)), key=_volume)[:CANDIDATES]
    for shape in around:  # most can be told by the piece alone
        if _excess(shape, piece) <= piece.slack:
            return primitive_hull(shape)
    for shape in around:  # hulls of cylinders are smaller than these, and say nothing about them
        if shape.kind == "box" and _lies_within(primitive_hull(shape), pieces, piece.slack):
            return primitive_hull(shape)
    return piece.hull


def _boxes_around(hull: Hull) -> Iterator[PrimitiveShape]:
    """The smallest boxes around a hull with an edge along one of its edges and a face on one of its faces."""
    corners = hull.vertices[hull.faces]
    normals = area_normals(corners)
    edges = np.concatenate(
        [np.roll(corners, -k, axis=1)[:, 1] - np.roll(corners, -k, axis=1)[:, 0] for k in range(3)]
    )
    z = np.tile(normals / np.linalg.norm(normals, axis=1, keepdims=True), (3, 1))
    x = edges / np.linalg.norm(edges, axis=1, keepdims=True)
    frames = np.stack([x, np.cross(z, x), z], axis=1)
    heights = frames @ hull.vertices.T  # K 3 V
    low, high = heights.min(axis=2), heights.max(axis=2)
    sizes = high - low
    _, first = np.unique(np.round(np.sort(sizes, axis=1), 6), axis=0, return_index=True)
    for k in sorted(first, key=lambda row: float(sizes[row].prod()))[:CANDIDATES]:
        middle = frames[k].T @ ((low[k] + high[k]) / 2)
        yield PrimitiveShape(
            kind="box", sizes=tuple(sizes[k].tolist()), T_object_shape=place_axes(frames[k], middle)
        )


def _cylinders_around(hull: Hull) -> Iterator[PrimitiveShape]:
    """The cylinders around a hull that have a cap on a face with five corners or more."""
    for normal in face_planes(hull)[:, :3]:
        heights = hull.vertices @ normal
        cap = np.abs(heights - heights.max()) < _FLAT
        if cap.sum() < _LEAST_SIDES:
            continue
        spokes = hull.vertices - np.outer(heights, normal)
        center = (spokes.min(axis=0) + spokes.max(axis=0)) / 2
        radius = float(np.linalg.norm(spokes - center, axis=1).max())
        middle = center + normal * (heights.min() + heights.max()) / 2
        yield PrimitiveShape(
            kind="cylinder",
            sizes=(radius, float(np.ptp(heights))),
            T_object_shape=place_along(normal, middle),
        )


def _volume(shape: PrimitiveShape) -> float:
    if shape.kind == "box":
        return float(np.prod(shape.sizes))
    return np.pi * shape.sizes[0] ** 2 * shape.sizes[1]


def _excess(shape: PrimitiveShape, piece: _Piece) -> float:
    """How far (m) a primitive reaches beyond the faces of a piece."""
    T = shape.T_object_shape
    tilt = np.abs(piece.planes[:, :3] @ T[:3, :3])  # share of every own axis in the normals, K 3
    if shape.kind == "box":
        reach = tilt @ np.array(shape.sizes) / 2
    else:
        reach = np.hypot(tilt[:, 0], tilt[:, 1]) * shape.sizes[0] + tilt[:, 2] * shape.sizes[1] / 2
    return float((piece.planes[:, :3] @ T[:3, 3] + reach - piece.planes[:, 3]).max())


def _lies_within(hull: Hull, pieces: Sequence[_Piece], margin: float) -> bool:
    """Whether a hull lies within the union of pieces, each of them grown by ``margin`` (m)."""
    low, high = hull.vertices.min(axis=0) - margin, hull.vertices.max(axis=0) + margin
    near = [piece for piece in pieces if (piece.bounds[0] <= high).all() and (piece.bounds[1] >= low).all()]
    points = np.concatenate([hull.vertices, hull.vertices[hull.faces].mean(axis=1)])
    inside = [(points @ piece.planes[:, :3].T <= piece.planes[:, 3] + margin).all(axis=1) for piece in near]
    if not np.any(inside, axis=0).all():  # most are told apart by these
        return False
    grown = unite(piece.grow(margin) for piece in near)
    return (manifold3d.Manifold.hull_points(hull.vertices) - grown).volume() < _SPECK
