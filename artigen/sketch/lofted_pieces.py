"""Builds and fits pieces with rounded edges and bends: shells and elbows."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from artigen.shapes.fittings.outlines import Outline, build_loft
from artigen.shapes.fittings.tubes import bend_elbow
from artigen.shapes.primitives import SEGMENTS, Primitive, as_vector, place_vertices
from artigen.sketch.piece import (
    CORNER_ENDS,
    CORNERS,
    INWARD,
    MAX_PIECES_OF_ARC,
    TOLERANCE,
    Piece,
    across,
    lined_inward,
)
from artigen.sketch.solid_pieces import find_surface, is_same, measure_cuts

LEAST_WALLS = 8
"""Smallest number of walls of a hollow shell; with fewer, the walls are boxes and prisms."""


def build_shell(piece: Piece) -> tuple[Primitive, ...]:
    """A solid with rounded edges, or walls around a hollow."""
    low, high, (u, v) = piece.low, piece.high, across(piece.axis)
    cut0, cut1, inset, wall = piece.rest
    room = min((high - low)[[u, v]]) / 2
    if abs(inset) + wall >= room:
        raise ValueError(
            f"a shell with an inset of {inset} and a wall of {wall}: expected a sum below {room}"
        )
    outline = Outline(
        a=(low[u], high[u]),
        b=(low[v], high[v]),
        cuts=(cut0, min(cut1, high[u] - low[u] - cut0)),
        pieces=piece.sides,
    )
    span = (low[piece.axis], high[piece.axis])
    lining = piece.lining if piece.lined == INWARD else None
    return build_loft(outline, piece.axis, span, piece.finish, inset=inset, wall=wall, lining=lining)


def build_elbow(piece: Piece) -> tuple[Primitive, ...]:
    """A quarter turn of a bent tube."""
    low, high, (u, v) = piece.low, piece.high, across(piece.axis)
    size, radius = high - low, (high - low)[piece.axis] / 2
    reach = (size[u] + size[v]) / 2
    if not reach > 2 * radius - TOLERANCE or radius <= 0:
        raise ValueError(f"an elbow of {reach} from a tube of {2 * radius}: expected at least the diameter")
    center, eye = (low + high) / 2, np.eye(3)
    far = CORNER_ENDS[piece.corners]
    for axis, end in zip((u, v), far, strict=True):
        center[axis] = (low, high)[end][axis]
    ways = tuple(as_vector((1 - 2 * end) * eye[axis]) for axis, end in zip((u, v), far, strict=True))
    return bend_elbow(
        as_vector(center), (ways[0], ways[1]), reach - radius, radius, piece.finish, pieces=piece.sides
    )


def fit_walls(primitives: Sequence[Primitive]) -> tuple[Piece, int] | None:
    """Fits a hollow shell to the first primitives; the second value is the number of primitives used."""
    count = _count_walls(primitives)
    return None if count < LEAST_WALLS else _fit_shell(primitives[:count], hollow=True)


def fit_solid_shell(primitive: Primitive) -> tuple[Piece, int] | None:
    """Fits a solid with rounded edges to one primitive; the second value is 1, the number of primitives
    used."""
    return _fit_shell([primitive], hollow=False)


def _fit_shell(primitives: Sequence[Primitive], *, hollow: bool) -> tuple[Piece, int] | None:
    points = np.concatenate([place_vertices(primitive) for primitive in primitives])
    for axis in range(3):
        for piece in _guess_shells(points, axis, primitives[0], hollow=hollow):
            if is_same(primitives, build_shell(piece)):
                return piece, len(primitives)
    return None


def _count_walls(primitives: Sequence[Primitive]) -> int:
    """Number of leading primitives that form a ring, each sharing a face with the next; 0 if they form
    none."""
    first = place_vertices(primitives[0])
    if len(first) > 8 or primitives[0].kind != "polytope":
        return 0
    last = first
    for count, primitive in enumerate(primitives[1 : CORNERS * (MAX_PIECES_OF_ARC + 1)], start=2):
        points = place_vertices(primitive)
        if len(points) > 8 or _count_shared(last, points) < CORNERS:
            return 0
        if count >= LEAST_WALLS and _count_shared(points, first) >= CORNERS:
            return count
        last = points
    return 0


def _count_shared(these: Float[np.ndarray, "V 3"], those: Float[np.ndarray, "W 3"]) -> int:
    return int((np.abs(these[:, None] - those[None]).max(axis=2) < TOLERANCE).any(axis=1).sum())


def _guess_shells(
    points: Float[np.ndarray, "V 3"], axis: int, first: Primitive, *, hollow: bool
) -> list[Piece]:
    """Candidate shells along an axis for solids with these corners; they differ in the segments per arc."""
    low, high, axes = points.min(axis=0), points.max(axis=0), list(across(axis))
    depth = np.minimum(points[:, axis] - low[axis], high[axis] - points[:, axis])
    if depth.max() > TOLERANCE:
        return []
    upper = points[:, axis] > (low[axis] + high[axis]) / 2
    ends = [points[~upper][:, axes], points[upper][:, axes]]
    insets = [float((end.min(axis=0) - low[axes]).mean()) for end in ends]
    wide = 0 if insets[0] < TOLERANCE else 1
    inset = insets[0] - insets[1]
    outer = ends[wide]
    cuts = measure_cuts(outer)
    if insets[wide] > TOLERANCE or cuts.min() < TOLERANCE:
        return []
    wall = _measure_wall(outer) if hollow else 0.0
    cut = (float(cuts[0, 0]), float(cuts[1, 0]))
    surface = lined_inward(first) if hollow else find_surface(first)
    numbers = (*low.tolist(), *high.tolist(), *cut, inset, wall)
    if abs(inset) + wall >= float((high - low)[axes].min()) / 2:
        return []
    return [
        Piece(kind="shell", numbers=numbers, axis=axis, sides=sides, **surface)
        for sides in range(1, MAX_PIECES_OF_ARC + 1)
        if len(np.unique(outer.round(7), axis=0)) <= (1 + hollow) * CORNERS * (sides + 1)
    ]


def _measure_wall(flat: Float[np.ndarray, "N 2"]) -> float:
    """Thickness of the wall between the outer and inner outlines, if the points form two outlines."""
    from scipy.spatial import ConvexHull

    outer = ConvexHull(flat.round(9)).vertices
    inner, hull = np.delete(flat, outer, axis=0), flat[outer]
    inner = inner[np.abs(inner[:, None] - hull[None]).max(axis=2).min(axis=1) > TOLERANCE]
    return float((inner.min(axis=0) - flat.min(axis=0)).mean()) if len(inner) else 0.0


def fit_elbow(primitives: Sequence[Primitive]) -> tuple[Piece, int] | None:
    """Fits an elbow to the first primitives; the second value is the number of primitives used."""
    points: list[Float[np.ndarray, "V 3"]] = []
    for count, primitive in enumerate(primitives[:MAX_PIECES_OF_ARC], start=1):
        points.append(place_vertices(primitive))
        if primitive.kind != "polytope" or len(points[-1]) != 2 * SEGMENTS:
            return None
        if count > 1 and _count_shared(points[-2], points[-1]) < SEGMENTS:
            return None
        for piece in _guess_elbows(np.concatenate(points), primitives[0], count):
            if is_same(primitives[:count], build_elbow(piece)):
                return piece, count
    return None


def _guess_elbows(points: Float[np.ndarray, "V 3"], first: Primitive, sides: int) -> list[Piece]:
    low, high = points.min(axis=0), points.max(axis=0)
    size, out = high - low, []
    for axis in range(3):
        u, v = across(axis)
        if abs(size[u] - size[v]) > TOLERANCE or size[u] < size[axis]:
            continue
        radius = size[axis] / 2 / np.cos(np.pi / SEGMENTS)
        spare = radius - size[axis] / 2  # corners of a tube do not reach the sides of its bounds
        for corners, ends in enumerate(CORNER_ENDS):
            bottom, top = low.copy(), high.copy()
            bottom[axis], top[axis] = low[axis] - spare, high[axis] + spare
            for side, end in zip((u, v), ends, strict=True):
                bottom[side] -= spare * end
                top[side] += spare * (1 - end)
            numbers = (*bottom.tolist(), *top.tolist())
            out.append(
                Piece(
                    kind="elbow",
                    finish=first.finish,
                    numbers=numbers,
                    axis=axis,
                    sides=sides,
                    corners=corners,
                )
            )
    return out
