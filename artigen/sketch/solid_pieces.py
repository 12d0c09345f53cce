"""Builds and fits pieces of one primitive: boxes, cylinders, frusta, prisms and slabs."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from artigen.shapes.fittings.outlines import trace_corners
from artigen.shapes.primitives import Primitive, as_vector, cylinder, place_vertices, polytope, rounded_box
from artigen.sketch.piece import (
    CORNER_ENDS,
    CORNERS,
    LINED,
    MAX_PIECES_OF_ARC,
    PIECE_KINDS,
    ROUND_SIDES,
    TOLERANCE,
    Piece,
    Surface,
    UnknownSolid,
    across,
)

Points = Float[np.ndarray, "V 3"]
Corner = Float[np.ndarray, "3"]


def build_box(piece: Piece) -> Primitive:
    """A box, sharp or bevelled."""
    return rounded_box(as_vector(piece.low), as_vector(piece.high), piece.rest[0], piece.finish)


def build_cylinder(piece: Piece) -> Primitive:
    """A cylinder along an axis."""
    low, high = piece.low, piece.high
    start, end = (low + high) / 2, (low + high) / 2
    start[piece.axis], end[piece.axis] = low[piece.axis], high[piece.axis]
    u, v = across(piece.axis)
    diameter = ((high - low)[u] + (high - low)[v]) / 2
    return cylinder(as_vector(start), as_vector(end), diameter / 2, piece.finish)


def build_frustum(piece: Piece) -> Primitive:
    """A solid between two rectangles or circles."""
    low, high, (u, v) = piece.low, piece.high, across(piece.axis)
    ends = np.array([piece.rest, (low[u], low[v], high[u], high[v])])
    if not (ends[:, 2:] > ends[:, :2]).all() or not high[piece.axis] > low[piece.axis]:
        raise ValueError(f"a frustum with ends {ends.tolist()}: edges must be positive")
    rim = _rim(piece.sides, u)
    corners = np.empty((2 * len(rim), 3))
    for index, (end, along) in enumerate(zip(ends, (low, high), strict=True)):
        rows = slice(index * len(rim), (index + 1) * len(rim))
        corners[rows, u] = (end[0] + end[2]) / 2 + rim[:, 0] * (end[2] - end[0]) / 2
        corners[rows, v] = (end[1] + end[3]) / 2 + rim[:, 1] * (end[3] - end[1]) / 2
        corners[rows, piece.axis] = along[piece.axis]
    return polytope(corners, piece.finish)


def _rim(sides: int, u: int) -> Float[np.ndarray, "N 2"]:
    """Corners of a regular polygon in [-1, 1]^2 with first axis ``u``; one of many sides has corners along y
    if possible."""
    if sides == 4:
        return np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    turns = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    rim = np.column_stack([np.cos(turns), np.sin(turns)])
    return rim[:, ::-1] if u == 1 else rim


def build_prism(piece: Piece) -> Primitive:
    """A quadrangle along an axis."""
    low, high, (u, v) = piece.low, piece.high, across(piece.axis)
    u1, v1, u3, v3 = piece.rest
    profile = np.array([(low[u], low[v]), (u1, v1), (high[u], high[v]), (u3, v3)])
    made = polytope(_extrude(profile, piece), piece.finish)
    if len(made.vertices) != 8:
        raise ValueError(f"a prism with corners {profile.tolist()}: they do not form a convex polygon")
    return made


def build_slab(piece: Piece) -> Primitive:
    """A box with cut corners; longer cuts are clamped to the edge."""
    return polytope(_extrude(_trace_slab(piece), piece), piece.finish)


def room_to_cut(corners: int) -> tuple[float, float]:
    """Largest share of an edge along u and along v that one arc of a slab with these corners may use."""
    cut = [bool(corners >> k & 1) for k in range(CORNERS)]
    opposite = (cut[0] and cut[2]) or (cut[1] and cut[3])
    along_u = opposite or (cut[0] and cut[1]) or (cut[2] and cut[3])
    along_v = opposite or (cut[1] and cut[2]) or (cut[3] and cut[0])
    return (0.5 if along_u else 1.0), (0.5 if along_v else 1.0)


def _trace_slab(piece: Piece) -> Float[np.ndarray, "N 2"]:
    low, high, axes = piece.low, piece.high, list(across(piece.axis))
    room = np.array(room_to_cut(piece.corners)) * (high - low)[axes]
    cut_u, cut_v = np.minimum(piece.rest, room).tolist()
    cuts = [(cut_u, cut_v) if piece.corners >> k & 1 else (0.0, 0.0) for k in range(CORNERS)]
    (a0, b0), (a1, b1) = low[axes].tolist(), high[axes].tolist()
    return trace_corners((a0, a1), (b0, b1), cuts, piece.sides)


def _extrude(profile: Float[np.ndarray, "N 2"], piece: Piece) -> Points:
    corners = np.empty((2 * len(profile), 3))
    corners[:, list(across(piece.axis))] = np.tile(profile, (2, 1))
    corners[:, piece.axis] = np.repeat([piece.low[piece.axis], piece.high[piece.axis]], len(profile))
    return corners


def fit_cylinder(primitive: Primitive) -> Piece:
    """Fits a cylinder to a primitive.

    Raises:
        UnknownSolid: If its axis is not a coordinate axis.
    """
    axis = int(np.abs(primitive.rotation[:, 2]).argmax())
    if abs(primitive.rotation[axis, 2]) < 1 - 1e-9:
        raise UnknownSolid(
            f"a cylinder along {primitive.rotation[:, 2].tolist()}, expected a coordinate axis"
        )
    half = np.full(3, primitive.size[0] / 2)
    half[axis] = primitive.size[2] / 2
    numbers = (*(primitive.center - half).tolist(), *(primitive.center + half).tolist())
    return Piece(kind="cylinder", numbers=numbers, axis=axis, **find_surface(primitive))


def find_surface(primitive: Primitive) -> Surface:
    """The finish and lining of a primitive.

    Raises:
        UnknownSolid: If the lined side is not in `LINED`.
    """
    if primitive.lined_side is None:
        return Surface(finish=primitive.finish, lining=None, lined=None)
    near = np.array(LINED) @ np.array(primitive.lined_side)
    if near.max() < 1 - 1e-9:
        raise UnknownSolid(f"a lining on the side {primitive.lined_side}, expected along a coordinate axis")
    return Surface(finish=primitive.finish, lining=primitive.lining, lined=int(near.argmax()))


def fit_polytope(primitive: Primitive) -> Piece:
    """Fits a sharp or bevelled box, a frustum, a prism or a slab to a primitive.

    Raises:
        UnknownSolid: If none of them fits.
    """
    points = place_vertices(primitive)
    low, high = points.min(axis=0), points.max(axis=0)
    shared = find_surface(primitive)
    bevel = find_bevel(points, low, high)
    if bevel is not None:
        numbers = (*low.tolist(), *high.tolist(), bevel)
        return Piece(kind="box", numbers=numbers, **shared)
    for guess, build in ((_guess_frustum, build_frustum), (_guess_prism, build_prism)):
        for axis in range(3):
            piece = guess(points, axis, low, high, shared)
            if piece is not None and is_same([primitive], [build(piece)]):
                return piece
    for axis in range(3):
        piece = _fit_slab(points, axis, low, high, shared)
        if piece is not None:
            return piece
    raise UnknownSolid(f"a solid with corners {np.round(points, 4).tolist()}, expected one of {PIECE_KINDS}")


def find_bevel(points: Points, low: Corner, high: Corner) -> float | None:
    """Width of a box's bevel, 0 for a sharp box; None for other solids."""
    depth = np.minimum(points - low, high - points)
    if len(points) == 8:
        return 0.0 if depth.max() < TOLERANCE else None
    if len(points) != 24:
        return None
    bevel = float(depth.max())
    inside = depth > TOLERANCE
    even = np.abs(depth[inside] - bevel).max() < TOLERANCE and (inside.sum(axis=1) == 2).all()
    return bevel if even else None


def _guess_frustum(points: Points, axis: int, low: Corner, high: Corner, surface: Surface) -> Piece | None:
    layers = split_layers(points, axis, low, high)
    if layers is None or len(layers[0]) not in (4, *ROUND_SIDES):
        return None
    u, v = across(axis)
    sides, rectangles = len(layers[0]), []
    for layer in layers:
        flat = layer[:, [u, v]]
        bottom, top = flat.min(axis=0), flat.max(axis=0)
        if sides > 4:
            middle = flat.mean(axis=0)
            reach = float(np.linalg.norm(flat - middle, axis=1).max())
            bottom, top = middle - reach, middle + reach
        rectangles.append((*bottom.tolist(), *top.tolist()))
    bounds = np.array([low, high])
    bounds[:, u], bounds[:, v] = rectangles[1][::2], rectangles[1][1::2]
    numbers = (*bounds[0].tolist(), *bounds[1].tolist(), *rectangles[0])
    return Piece(kind="frustum", numbers=numbers, axis=axis, sides=sides, **surface)


def _guess_prism(points: Points, axis: int, low: Corner, high: Corner, surface: Surface) -> Piece | None:
    layers = split_layers(points, axis, low, high)
    if layers is None or len(layers[0]) != 4:
        return None
    u, v = across(axis)
    flat = layers[0][:, [u, v]]
    spokes = flat - flat.mean(axis=0)
    flat = flat[np.argsort(np.arctan2(spokes[:, 1], spokes[:, 0]))]
    flat = np.roll(flat, -int(np.lexsort((flat[:, 1].round(7), flat[:, 0].round(7)))[0]), axis=0)
    bounds = np.array([low, high])
    bounds[:, u], bounds[:, v] = flat[[0, 2], 0], flat[[0, 2], 1]
    numbers = (*bounds[0].tolist(), *bounds[1].tolist(), *flat[1].tolist(), *flat[3].tolist())
    return Piece(kind="prism", numbers=numbers, axis=axis, **surface)


def _fit_slab(points: Points, axis: int, low: Corner, high: Corner, surface: Surface) -> Piece | None:
    layers = split_layers(points, axis, low, high)
    if layers is None or len(layers[0]) < 3:
        return None
    axes = list(across(axis))
    cut = measure_cuts(layers[0][:, axes])
    corners = sum(1 << k for k in range(CORNERS) if cut[k].min() > TOLERANCE)
    lengths = cut[[k for k in range(CORNERS) if corners >> k & 1]]
    if not len(lengths) or np.ptp(lengths, axis=0).max() > TOLERANCE:
        return None
    for sides in range(1, MAX_PIECES_OF_ARC + 1):
        numbers = (*low.tolist(), *high.tolist(), *lengths[0].tolist())
        piece = Piece(kind="slab", numbers=numbers, axis=axis, sides=sides, corners=corners, **surface)
        if _covers(_extrude(_trace_slab(piece), piece), points):
            return piece
    return None


def measure_cuts(flat: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, "4 2"]:
    """Lengths cut off each corner of a convex polygon's bounds, along its edges; 0 for corners that are
    kept."""
    low, high = flat.min(axis=0), flat.max(axis=0)
    out = np.empty((CORNERS, 2))
    for k, ends in enumerate(CORNER_ENDS):
        corner = np.where(ends, high, low)
        away = np.abs(flat - corner)
        out[k] = [away[away[:, 1 - along] < TOLERANCE, along].min() for along in (0, 1)]
    return out


def _covers(these: Points, those: Points) -> bool:
    """Whether two sets contain the same points, regardless of repetition."""
    apart = np.abs(these[:, None] - those[None]).max(axis=2)
    return bool(max(apart.min(axis=0).max(), apart.min(axis=1).max()) < TOLERANCE)


def split_layers(points: Points, axis: int, low: Corner, high: Corner) -> tuple[Points, Points] | None:
    """The corners at both ends of an axis, if these are all corners and equally many; else None."""
    bottom = points[:, axis] - low[axis] < TOLERANCE
    top = high[axis] - points[:, axis] < TOLERANCE
    if not (bottom ^ top).all() or bottom.sum() != top.sum():
        return None
    return points[bottom], points[top]


def is_same(these: Sequence[Primitive], those: Sequence[Primitive]) -> bool:
    """Whether two groups of primitives have the same corners, pairwise."""
    if len(these) != len(those):
        return False
    for a, b in zip(these, those, strict=True):
        one, other = place_vertices(a), place_vertices(b)
        if len(one) != len(other):
            return False
        apart = np.abs(one[:, None] - other[None]).max(axis=2).min(axis=1)
        if apart.max() > TOLERANCE:
            return False
    return True
