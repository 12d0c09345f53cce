"""Cells of a grid that the surface of a shape crosses, with the area of each part in each cell.

The result is exact, not sampled: faces are cut along the planes between cells, so that a cell is found if and
only if surface passes through it. Parallelograms with an edge along an axis (nearly all faces) are cut in
closed form, other faces as polygons. Cylinders are prisms with enough sides that the error is a small
fraction of a cell.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.shapes.polygons import TINY, cut_polygons, polygon_areas, polygon_middles, repeat_rows
from artigen.shapes.primitives import Primitive, place_vertices, polygon
from artigen.shapes.shape import Shape
from artigen.shapes.solids import Solids, cover_boxes, list_solids, see_points

_LOOKS = np.array([[0.02, 0.02], [0.02, 0.98], [0.98, 0.02], [0.98, 0.98], [0.5, 0.5]])
"""Sample points on a parallelogram that another primitive may cover."""
_SHRINK = 0.96
"""Position of sample points on other polygons, as a share of the way from the middle to each corner."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CellAreas:
    """Area of a part in a cell (in units of a cell face), one row per piece of surface."""

    cells: Int[np.ndarray, "N 3"]
    part_ids: Int[np.ndarray, "N"]
    areas: Float[np.ndarray, "N"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sheets:
    """Parallelograms, in cells: ``origin + u first + v second``, outwards along ``first x second``."""

    origin: Float[np.ndarray, "N 3"]
    first: Float[np.ndarray, "N 3"]
    second: Float[np.ndarray, "N 3"]
    axis: Int[np.ndarray, "N"]
    """Axis along which ``first`` runs; ``second`` is perpendicular to it."""
    owners: Int[np.ndarray, "N"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Polygons:
    """Faces, in cells, counterclockwise from outside; padded with the last corner."""

    corners: Float[np.ndarray, "N M 3"]
    counts: Int[np.ndarray, "N"]
    owners: Int[np.ndarray, "N"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Pieces:
    """Planar pieces, each in one cell."""

    middles: Float[np.ndarray, "N 3"]
    areas: Float[np.ndarray, "N 3"]
    """Area vectors along the outward normal."""
    low: Float[np.ndarray, "N 3"]
    high: Float[np.ndarray, "N 3"]
    looks: Callable[[Int[np.ndarray, "K"]], Float[np.ndarray, "K L 3"]]
    """Sample points on selected pieces, for estimating how much others cover."""
    owners: Int[np.ndarray, "N"]


def rasterize_shape(shape: Shape, resolution: int = 64) -> CellAreas:
    """Cuts the surfaces of all parts into cells of the unit cube around the closed object."""
    low, high = shape.bounds()
    cell = float((high - low).max()) / resolution
    corner = (low + high) / 2 - cell * resolution / 2
    solids = list_solids(shape)
    sheets, polygons = _list_faces(solids, corner, cell)
    pieces = [_cut_sheets(sheets), *(some for faces in polygons for some in _cut_faces(faces))]
    sizes = [np.sqrt(np.einsum("ni,ni->n", some.areas, some.areas)) for some in pieces]
    normals = [some.areas / size[:, None] for some, size in zip(pieces, sizes, strict=True)]
    owners = np.concatenate([some.owners for some in pieces])
    inner = np.concatenate(
        [some.middles - TINY * normal for some, normal in zip(pieces, normals, strict=True)]
    )
    seen = _find_shares(pieces, np.concatenate(normals), solids, corner, cell)
    kept = seen > 0
    return CellAreas(
        cells=np.clip(np.floor(inner[kept]).astype(np.int64), 0, resolution - 1),
        part_ids=solids.part_ids[owners[kept]],
        areas=(np.concatenate(sizes) * seen)[kept],
    )


def _list_faces(
    solids: Solids, corner: Float[np.ndarray, "3"], cell: float
) -> tuple[_Sheets, list[_Polygons]]:
    """Axis-aligned parallelograms and all other faces, in cells; polygons are grouped by width."""
    found: dict[int, list[tuple[np.ndarray, int]]] = {}  # by width
    for index, primitive in enumerate(solids.primitives):
        if primitive.kind == "cylinder":
            faces = _cylinder_faces(primitive, cell)
        else:
            faces = [place_vertices(primitive)[primitive.rings]]
        for corners in faces:
            found.setdefault(corners.shape[1], []).append((corners, index))
    sheets, polygons = [], []
    for _, some in sorted(found.items()):
        corners = (np.concatenate([one for one, _ in some]) - corner) / cell
        owners = np.repeat([index for _, index in some], [len(one) for one, _ in some])
        counts = np.argmin(np.abs(corners - corners[:, -1:]).max(axis=2), axis=1) + 1
        ruled, along = _find_sheets(corners, counts, owners)
        sheets.append(along)
        polygons.append(_Polygons(corners=corners[~ruled], counts=counts[~ruled], owners=owners[~ruled]))
    joined = {name: np.concatenate([vars(some)[name] for some in sheets]) for name in vars(sheets[0])}
    return _Sheets(**joined), polygons


def _find_sheets(
    corners: Float[np.ndarray, "N M 3"], counts: Int[np.ndarray, "N"], owners: Int[np.ndarray, "N"]
) -> tuple[Bool[np.ndarray, "N"], _Sheets]:
    """Mask and sheets of the faces that are parallelograms with an edge along an axis and another
    perpendicular to it."""
    if corners.shape[1] < 4:
        corners = np.concatenate([corners, corners[:, -1:]], axis=1)
    a, b, c, d = (corners[:, k] for k in range(4))
    whole = (counts == 4) & (np.abs(a + c - b - d).max(axis=1) < TINY)
    ways = np.stack([b - a, c - b])  # the face as given, and rotated so that its second edge is the first
    short = np.abs(ways) < TINY
    along = short.sum(axis=2) == 2
    axis = np.argmax(np.abs(ways), axis=2)
    upright = np.stack([short[1 - k, np.arange(len(a)), axis[k]] for k in (0, 1)])
    fits = along & upright & whole
    way, ruled = np.argmax(fits, axis=0), fits.any(axis=0)
    rows = np.flatnonzero(ruled)
    way = way[rows]
    return ruled, _Sheets(
        origin=np.where(way[:, None] == 0, a[rows], b[rows]),
        first=ways[way, rows],
        second=np.where(way[:, None] == 0, (d - a)[rows], (a - b)[rows]),
        axis=axis[way, rows],
        owners=owners[rows],
    )


def _cylinder_faces(primitive: Primitive, cell: float) -> list[Float[np.ndarray, "N M 3"]]:
    """Strips of the side, and the two ends, with an error of at most a fiftieth of a cell."""
    radius, half = primitive.size[0] / 2, primitive.rotation[:, 2] * primitive.size[2] / 2
    sides = 16 if radius < cell else 32 if radius < 4 * cell else 64
    ring = primitive.center + radius * polygon(sides) @ primitive.rotation[:, :2].T
    after = np.roll(ring, -1, axis=0)
    strips = np.stack([ring - half, after - half, after + half, ring + half], axis=1)
    return [strips, np.stack([ring[::-1] - half, ring + half])]


def _cut_sheets(sheets: _Sheets) -> _Pieces:
    """Cuts along the axis in steps of a cell, and across it at every plane that the edge crosses."""
    axis = sheets.axis
    face, start, end = _cut_segments(sheets.origin, sheets.second)
    at = sheets.origin[face, axis[face]]
    reach = at + sheets.first[face, axis[face]]
    low, high = np.minimum(at, reach), np.maximum(at, reach)
    first_cell = np.floor(low + TINY).astype(np.int64)
    counts = np.maximum(np.ceil(high - TINY).astype(np.int64) - first_cell, 1)
    row, number = repeat_rows(counts)
    cell = first_cell[row] + number
    bottom, top = np.maximum(low[row], cell), np.minimum(high[row], cell + 1)
    origin = sheets.origin[face] + start[:, None] * sheets.second[face]
    second = (end - start)[:, None] * sheets.second[face]
    whole = np.cross(sheets.first[face], second) / (high - low)[:, None]
    rows = np.arange(len(row))
    face, origin, second = face[row], origin[row], second[row]
    first = np.zeros_like(origin)
    origin[rows, axis[face]] = bottom
    first[rows, axis[face]] = top - bottom
    return _Pieces(
        middles=origin + (first + second) / 2,
        areas=whole[row] * (top - bottom)[:, None],
        low=origin + np.minimum(second, 0.0),
        high=origin + first + np.maximum(second, 0.0),
        looks=lambda some: (
            origin[some, None] + _LOOKS[:, :1] * first[some, None] + _LOOKS[:, 1:] * second[some, None]
        ),
        owners=sheets.owners[face],
    )


def _cut_faces(faces: _Polygons) -> list[_Pieces]:
    """Cuts polygons into cells."""
    return [
        _list_pieces(corners, counts, faces.owners[rows])
        for rows, corners, counts in cut_polygons(faces.corners, faces.counts)
    ]


def _list_pieces(
    corners: Float[np.ndarray, "N M 3"], counts: Int[np.ndarray, "N"], owners: Int[np.ndarray, "N"]
) -> _Pieces:
    """Pieces from the corners of polygons with positive area."""
    areas = polygon_areas(corners)
    proper = (areas**2).sum(axis=1) > TINY**4
    corners, counts = corners[proper], counts[proper]
    middles = polygon_middles(corners, counts)

    def looks(some: np.ndarray) -> Float[np.ndarray, "K L 3"]:
        padding = np.arange(corners.shape[1]) >= counts[some, None]
        spokes = np.where(padding, 0.0, _SHRINK)[..., None] * (corners[some] - middles[some, None])
        return middles[some, None] + np.concatenate([spokes, np.zeros((len(some), 1, 3))], axis=1)

    return _Pieces(
        middles=middles,
        areas=areas[proper],
        low=corners.min(axis=1),
        high=corners.max(axis=1),
        looks=looks,
        owners=owners[proper],
    )


def _cut_segments(
    origin: Float[np.ndarray, "N 3"], edge: Float[np.ndarray, "N 3"]
) -> tuple[Int[np.ndarray, "M"], Float[np.ndarray, "M"], Float[np.ndarray, "M"]]:
    """Index of the segment, start and end in [0, 1] of each part between planes at integers."""
    rows, cuts = [np.repeat(np.arange(len(origin)), 2)], [np.tile([0.0, 1.0], len(origin))]
    for axis in range(3):
        start, end = origin[:, axis], origin[:, axis] + edge[:, axis]
        first = np.floor(np.minimum(start, end)).astype(np.int64) + 1
        counts = np.maximum(np.ceil(np.maximum(start, end)).astype(np.int64) - first, 0)
        row, number = repeat_rows(counts)
        rows.append(row)
        cuts.append((first[row] + number - start[row]) / edge[row, axis])
    row, cut = np.concatenate(rows), np.concatenate(cuts)
    order = np.lexsort((cut, row))
    row, cut = row[order], np.clip(cut[order], 0.0, 1.0)
    length = np.linalg.norm(edge, axis=1)[row[:-1]] * np.diff(cut)
    proper = (row[:-1] == row[1:]) & (length > TINY)
    return row[:-1][proper], cut[:-1][proper], cut[1:][proper]


def _find_shares(
    pieces: list[_Pieces],
    normals: Float[np.ndarray, "N 3"],
    solids: Solids,
    corner: Float[np.ndarray, "3"],
    cell: float,
) -> Float[np.ndarray, "N"]:
    """Share of every piece that is surface of its part, estimated at a few points where others cut it."""
    owners = np.concatenate([some.owners for some in pieces])
    order = np.argsort(owners, kind="stable")
    low = np.concatenate([some.low for some in pieces])[order] * cell + corner
    high = np.concatenate([some.high for some in pieces])[order] * cell + corner
    hidden, unsure = np.empty((2, len(owners)), dtype=bool)
    hidden[order], unsure[order] = cover_boxes(solids, low, high, normals[order], owners[order])
    points, rows, start = [], [], 0
    for some in pieces:
        own = np.flatnonzero(unsure[start : start + len(some.owners)])
        looks = some.looks(own)
        points.append(looks.reshape(-1, 3))
        rows.append(np.repeat(start + own, looks.shape[1]))
        start += len(some.owners)
    row = np.concatenate(rows)
    order = np.argsort(owners[row], kind="stable")
    row = row[order]
    found = see_points(solids, np.concatenate(points)[order] * cell + corner, normals[row], owners[row])
    counts = np.bincount(row, minlength=len(owners))
    shares = np.bincount(row, found, len(owners)) / np.maximum(counts, 1)
    return np.where(unsure, shares, ~hidden)
