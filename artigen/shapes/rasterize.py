"""The cells of a grid that the surface of a shape crosses, and how much area each part has in each.

No samples: faces are cut along the planes between cells, so that a cell is found if and only if surface
passes through it. Faces with an edge along an axis (nearly all) are cut in closed form, others triangle
by triangle. Cylinders are prisms of so many sides that the difference is a small part of a cell.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.shapes.primitives import Primitive
from artigen.shapes.shape import Shape
from artigen.shapes.solids import Solids, list_solids, may_be_covered, see_points

_TINY = 1e-6
"""Cells: shorter pieces are none, and a face between two cells belongs to the one behind it."""
_LOOKS = np.array([[0.02, 0.02], [0.02, 0.98], [0.98, 0.02], [0.98, 0.98], [0.5, 0.5]])
_HALF_LOOKS = np.array([[0.02, 0.02], [0.02, 0.96], [0.96, 0.02], [0.33, 0.33]])
"""Where a piece that another primitive may cover is looked at."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CellAreas:
    """Area (in faces of a cell) that a part has in a cell, one row for every piece of surface."""

    cells: Int[np.ndarray, "N 3"]
    part_ids: Int[np.ndarray, "N"]
    areas: Float[np.ndarray, "N"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Pieces:
    """Flat pieces, in cells: parallelograms ``origin + u first + v second``, or their halves with u + v < 1.

    ``first x second`` points outwards where ``sign`` is 1.
    """

    origin: Float[np.ndarray, "N 3"]
    first: Float[np.ndarray, "N 3"]
    second: Float[np.ndarray, "N 3"]
    sign: Float[np.ndarray, "N"]
    owners: Int[np.ndarray, "N"]

    def pick(self, rows: np.ndarray) -> "_Pieces":
        """Some of the pieces."""
        return _Pieces(**{name: value[rows] for name, value in vars(self).items()})


def rasterize_shape(shape: Shape, resolution: int = 64) -> CellAreas:
    """Cuts the surfaces of all parts into cells of the unit cube that the closed object fills."""
    low, high = shape.bounds()
    cell = float((high - low).max()) / resolution
    corner = (low + high) / 2 - cell * resolution / 2
    solids = list_solids(shape)
    whole, halves = _list_faces(solids, corner, cell)
    along = [
        (np.abs(whole.first[:, [a, b]]).max(axis=1) < _TINY) & (np.abs(whole.second[:, axis]) < _TINY)
        for axis, a, b in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    ]
    across = [
        (np.abs(whole.second[:, [a, b]]).max(axis=1) < _TINY) & (np.abs(whole.first[:, axis]) < _TINY)
        for axis, a, b in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    ]
    axis = np.argmax([*along, *across], axis=0)
    ruled = np.any([*along, *across], axis=0)
    slanted = whole.pick(~ruled)
    halves = _join([halves, slanted, _other_half(slanted)])
    turned = ruled & (axis >= 3)
    sheets = _join([whole.pick(ruled & (axis < 3)), _swap(whole.pick(turned))])
    axis = np.concatenate([axis[ruled & (axis < 3)], axis[turned] - 3])
    order = np.argsort(sheets.owners, kind="stable")
    chunks = [(_cut_sheets(sheets.pick(order), axis[order]), False), (_cut_halves(halves), True)]
    measured = [_measure(pieces, half, solids, corner, cell, resolution) for pieces, half in chunks]
    return CellAreas(
        cells=np.concatenate([chunk.cells for chunk in measured]),
        part_ids=np.concatenate([chunk.part_ids for chunk in measured]),
        areas=np.concatenate([chunk.areas for chunk in measured]),
    )


def _list_faces(solids: Solids, corner: Float[np.ndarray, "3"], cell: float) -> tuple[_Pieces, _Pieces]:
    """Parallelograms and single triangles of all primitives, in cells."""
    triangles, owners, whole, halves = [], [], [], []
    for index, primitive in enumerate(solids.primitives):
        if primitive.kind == "cylinder":
            side, ends = _cylinder_faces(primitive, index, cell)
            whole.append(side)
            halves.append(ends)
        else:
            points = primitive.vertices @ primitive.rotation.T + primitive.center
            triangles.append(points[primitive.faces])
            owners.append(np.full(len(primitive.faces), index))
    if triangles:
        pairs, single = _pair_triangles(np.concatenate(triangles), np.concatenate(owners))
        whole.append(pairs)
        halves.append(single)

    def in_cells(pieces: _Pieces) -> _Pieces:
        return _Pieces(
            origin=(pieces.origin - corner) / cell,
            first=pieces.first / cell,
            second=pieces.second / cell,
            sign=pieces.sign,
            owners=pieces.owners,
        )

    return in_cells(_join(whole)), in_cells(_join(halves))


def _cylinder_faces(primitive: Primitive, index: int, cell: float) -> tuple[_Pieces, _Pieces]:
    """Strips of the side and triangles of the ends; enough of them to err by a fiftieth of a cell."""
    radius, half = primitive.size[0] / 2, primitive.rotation[:, 2] * primitive.size[2] / 2
    sides = 16 if radius < cell else 32 if radius < 4 * cell else 64
    turn = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    ring = radius * np.column_stack([np.cos(turn), np.sin(turn)]) @ primitive.rotation[:, :2].T
    after = np.roll(ring, -1, axis=0)
    up = np.tile(2 * half, (sides, 1))
    ones, owners = np.ones(sides), np.full(sides, index)
    side = _Pieces(
        origin=primitive.center - half + ring, first=after - ring, second=up, sign=ones, owners=owners
    )
    ends = [
        _Pieces(
            origin=np.tile(primitive.center + at * half, (sides, 1)),
            first=ring,
            second=after,
            sign=at * ones,
            owners=owners,
        )
        for at in (-1, 1)
    ]
    return side, _join(ends)


def _pair_triangles(
    triangles: Float[np.ndarray, "T 3 3"], owners: Int[np.ndarray, "T"]
) -> tuple[_Pieces, _Pieces]:
    """Pairs of triangles that share their longest edge and make a parallelogram, and all others."""
    edges = np.roll(triangles, -1, axis=1) - np.roll(triangles, 1, axis=1)  # opposite of each corner
    apex = np.argmax(np.einsum("tkx,tkx->tk", edges, edges), axis=1)
    rows = np.arange(len(triangles))
    a, b, c = (triangles[rows, (apex + k) % 3] for k in range(3))
    middle = np.round(np.column_stack([owners[:, None], (b + c) / 2]), 9)
    order = np.lexsort(middle.T)
    twins = np.abs(np.diff(middle[order], axis=0)).max(axis=1, initial=0.0) < 1e-8
    twins &= np.concatenate([[True], ~twins[:-1]])  # the first two of three that agree
    one, two = order[:-1][twins], order[1:][twins]
    fits = np.abs(a[one] + a[two] - b[one] - c[one]).max(axis=1, initial=0.0) < 1e-9
    normal = np.cross(b - a, c - a)
    fits &= np.einsum("ni,ni->n", normal[one], normal[two]) > 0
    one, two = one[fits], two[fits]
    alone = np.ones(len(triangles), dtype=bool)
    alone[one] = alone[two] = False
    pieces = _Pieces(origin=a, first=b - a, second=c - a, sign=np.ones(len(a)), owners=owners)
    return pieces.pick(np.sort(one)), pieces.pick(alone)


def _other_half(pieces: _Pieces) -> _Pieces:
    return _Pieces(
        origin=pieces.origin + pieces.first + pieces.second,
        first=-pieces.first,
        second=-pieces.second,
        sign=pieces.sign,
        owners=pieces.owners,
    )


def _swap(pieces: _Pieces) -> _Pieces:
    return _Pieces(
        origin=pieces.origin,
        first=pieces.second,
        second=pieces.first,
        sign=-pieces.sign,
        owners=pieces.owners,
    )


def _join(chunks: list[_Pieces]) -> _Pieces:
    return _Pieces(
        **{name: np.concatenate([vars(chunk)[name] for chunk in chunks]) for name in vars(chunks[0])}
    )


def _cut_sheets(sheets: _Pieces, axis: Int[np.ndarray, "N"]) -> _Pieces:
    """Cuts parallelograms whose ``first`` runs along an axis and whose ``second`` is upright to it."""
    face, start, end = _cut_segments(sheets.origin, sheets.second)
    at = sheets.origin[face, axis[face]]
    reach = at + sheets.first[face, axis[face]]
    low, high = np.minimum(at, reach), np.maximum(at, reach)
    first_cell = np.floor(low + _TINY).astype(np.int64)
    counts = np.maximum(np.ceil(high - _TINY).astype(np.int64) - first_cell, 1)
    row = np.repeat(np.arange(len(face)), counts)
    cell = first_cell[row] + np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
    bottom, top = np.maximum(low[row], cell), np.minimum(high[row], cell + 1)
    face, start, end, rows = face[row], start[row], end[row], np.arange(len(row))
    origin = sheets.origin[face] + start[:, None] * sheets.second[face]
    first = np.zeros_like(origin)
    origin[rows, axis[face]] = bottom
    first[rows, axis[face]] = top - bottom
    flipped = np.sign(sheets.first[face, axis[face]])
    return _Pieces(
        origin=origin,
        first=first,
        second=(end - start)[:, None] * sheets.second[face],
        sign=sheets.sign[face] * flipped,
        owners=sheets.owners[face],
    )


def _cut_segments(
    origin: Float[np.ndarray, "N 3"], edge: Float[np.ndarray, "N 3"]
) -> tuple[Int[np.ndarray, "M"], Float[np.ndarray, "M"], Float[np.ndarray, "M"]]:
    """Which segment, and from where to where on it in [0, 1], between planes at whole numbers."""
    rows, cuts = [np.repeat(np.arange(len(origin)), 2)], [np.tile([0.0, 1.0], len(origin))]
    for axis in range(3):
        start, end = origin[:, axis], origin[:, axis] + edge[:, axis]
        first = np.floor(np.minimum(start, end)).astype(np.int64) + 1
        counts = np.maximum(np.ceil(np.maximum(start, end)).astype(np.int64) - first, 0)
        row = np.repeat(np.arange(len(origin)), counts)
        plane = first[row] + np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
        rows.append(row)
        cuts.append((plane - start[row]) / edge[row, axis])
    row, cut = np.concatenate(rows), np.concatenate(cuts)
    order = np.lexsort((cut, row))
    row, cut = row[order], np.clip(cut[order], 0.0, 1.0)
    length = np.linalg.norm(edge, axis=1)[row[:-1]] * np.diff(cut)
    proper = (row[:-1] == row[1:]) & (length > _TINY)
    return row[:-1][proper], cut[:-1][proper], cut[1:][proper]


def _cut_halves(halves: _Pieces) -> _Pieces:
    """Cuts triangles along the planes between cells until each lies in one cell."""
    done, waiting = [], halves
    while len(waiting.origin):
        corners = np.stack(
            [waiting.origin, waiting.origin + waiting.first, waiting.origin + waiting.second], axis=1
        )
        low = np.floor(corners.min(axis=1) + _TINY)
        high = np.ceil(corners.max(axis=1) - _TINY)
        spans = high - low
        axis = spans.argmax(axis=1)
        rows = np.arange(len(axis))
        whole = spans[rows, axis] <= 1
        done.append(waiting.pick(whole))
        plane = np.round((low + high)[rows, axis] / 2)
        cut = ~whole
        waiting = _cut_at(waiting.pick(cut), corners[cut], axis[cut], plane[cut])
    return _join(done) if done else halves


def _cut_at(
    pieces: _Pieces, corners: Float[np.ndarray, "N 3 3"], axis: Int[np.ndarray, "N"], plane: np.ndarray
) -> _Pieces:
    """Each triangle in three: the corner that is alone on its side of the plane, and the rest in two."""
    rows = np.arange(len(axis))
    height = corners[rows, :, axis] - plane[:, None]
    above = height > 0
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    a, b, c = (corners[rows, (alone + k) % 3] for k in range(3))
    ha, hb, hc = (height[rows, (alone + k) % 3][:, None] for k in range(3))
    p, q = a + ha / (ha - hb) * (b - a), a + ha / (ha - hc) * (c - a)
    out = []
    for one, two, three in ((a, p, q), (p, b, c), (p, c, q)):
        area = np.linalg.norm(np.cross(two - one, three - one), axis=1)
        piece = _Pieces(
            origin=one, first=two - one, second=three - one, sign=pieces.sign, owners=pieces.owners
        )
        out.append(piece.pick(area > _TINY**2))
    return _join(out)


def _measure(
    pieces: _Pieces,
    half: bool,  # noqa: FBT001 - what _Pieces says
    solids: Solids,
    corner: Float[np.ndarray, "3"],
    cell: float,
    resolution: int,
) -> CellAreas:
    """Cell, part and visible area of every piece."""
    if (np.diff(pieces.owners) < 0).any():
        pieces = pieces.pick(np.argsort(pieces.owners, kind="stable"))
    cross = pieces.sign[:, None] * np.cross(pieces.first, pieces.second)
    length = np.linalg.norm(cross, axis=1)
    normals = cross / length[:, None]
    share = 1 / 3 if half else 1 / 2
    middle = pieces.origin + share * (pieces.first + pieces.second)
    cells = np.clip(np.floor(middle - _TINY * normals).astype(np.int64), 0, resolution - 1)
    seen = _seen_shares(pieces, normals, half, solids, corner, cell)
    kept = seen > 0
    areas = length * (0.5 if half else 1.0) * seen
    return CellAreas(cells=cells[kept], part_ids=solids.part_ids[pieces.owners[kept]], areas=areas[kept])


def _seen_shares(
    pieces: _Pieces,
    normals: Float[np.ndarray, "N 3"],
    half: bool,  # noqa: FBT001 - what _Pieces says
    solids: Solids,
    corner: Float[np.ndarray, "3"],
    cell: float,
) -> Float[np.ndarray, "N"]:
    """How much of each piece is surface of its part, judged at a few points where others are near."""
    low = pieces.origin + np.minimum(pieces.first, 0.0) + np.minimum(pieces.second, 0.0)
    high = pieces.origin + np.maximum(pieces.first, 0.0) + np.maximum(pieces.second, 0.0)
    near = may_be_covered(solids, low * cell + corner, high * cell + corner, pieces.owners)
    seen = np.ones(len(near))
    looks = _HALF_LOOKS if half else _LOOKS
    some = pieces.pick(near)
    points = some.origin[:, None] + np.einsum("ku,unx->nkx", looks, np.stack([some.first, some.second]))
    flat = points.reshape(-1, 3) * cell + corner
    count = len(looks)
    found = see_points(solids, flat, np.repeat(normals[near], count, axis=0), np.repeat(some.owners, count))
    seen[near] = found.reshape(-1, count).mean(axis=1)
    return seen
