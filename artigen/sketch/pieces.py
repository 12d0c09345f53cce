"""Pieces: the solids that a sketch is written in, and the convex primitives that each stands for.

A piece is one solid as a person would name it: a box, a rod, a tapered leg, a ring. Most are one primitive;
a ring, spokes around an axle and a plate with a round hole are a fixed number of them. `fit_pieces` finds the
pieces of a part's primitives and `build_piece` makes the primitives again.

Numbers are lengths and coordinates in metres, in the order of `NUMBERS`: six that bound the solid (lowest,
then highest corner) and up to four more, by kind. ``u`` and ``v`` are the axes after the piece's own axis,
in cyclic order.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Literal, TypedDict, get_args

import numpy as np
from jaxtyping import Float

from artigen.shapes.appliances.rings import build_pierced_plate, build_ring
from artigen.shapes.primitives import (
    Primitive,
    Vector,
    cylinder,
    line,
    move,
    place_vertices,
    polytope,
    rounded_box,
)

PieceKind = Literal["box", "cylinder", "frustum", "prism", "ring", "spokes", "plate"]
PIECE_KINDS: tuple[PieceKind, ...] = get_args(PieceKind)
NUMBERS: dict[PieceKind, tuple[str, ...]] = {
    "box": ("x0", "y0", "z0", "x1", "y1", "z1", "bevel"),
    "cylinder": ("x0", "y0", "z0", "x1", "y1", "z1"),
    "frustum": ("x0", "y0", "z0", "x1", "y1", "z1", "u0", "v0", "u1", "v1"),
    "prism": ("x0", "y0", "z0", "x1", "y1", "z1", "u1", "v1", "u3", "v3"),
    "ring": ("x0", "y0", "z0", "x1", "y1", "z1", "inner0", "inner1", "outer0"),
    "spokes": ("x0", "y0", "z0", "x1", "y1", "z1", "inner", "half_width"),
    "plate": ("x0", "y0", "z0", "x1", "y1", "z1", "hole_y", "hole_z", "radius"),
}
"""The numbers of each kind (m).

box       bounds; width of the bevel on each face, 0 for sharp edges
cylinder  bounds of the round solid, square across its axis
frustum   bounds of the end at the top of its axis (span along the axis), then the rectangle of the other end;
          with more than four sides both rectangles are squares around a circle through the corners
prism     span along the axis; of its four corners (u, v) the first in the low corner, the third in the high
          one, then the second and the fourth
ring      span along the axis and the square around the outer circle of its far end; inner radii at both ends,
          outer radius of the near end
spokes    as ring, of boxes: inner radius and half their width
plate     bounds; centre and radius of a round hole along x
"""
ROUND_SIDES = (10, 16)
"""Corners of a frustum's ends that stand for circles."""
MIN_WEDGES = 8
"""Wedges that a ring has at least."""
LINED: tuple[Vector, ...] = (
    (1.0, 0.0, 0.0),
    (-1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, -1.0, 0.0),
    (0.0, 0.0, 1.0),
    (0.0, 0.0, -1.0),
)
"""Sides that can be lined; one more stands for the inside of a ring or hole."""
INWARD = len(LINED)
_TOLERANCE = 1e-6
"""Distance (m) within which a fitted piece must repeat the corners of its primitives."""
_PLATE_SIDES = 12


class UnknownSolid(ValueError):
    """A primitive that is none of the pieces."""


@dataclass(frozen=True, kw_only=True)
class Piece:
    """One solid; numbers in metres where it describes a shape, in grid steps where it is part of a sketch."""

    kind: PieceKind
    finish: str
    numbers: tuple[float, ...]
    lining: str | None = None
    lined: int | None = None
    """Index into `LINED`, or `INWARD`."""
    axis: int = 0
    """Of all but boxes and plates: 0 to 2 for x to z."""
    sides: int = 0
    """Corners of a frustum's ends, number of a ring's wedges or of spokes."""
    phase: int = 0
    """Spokes: in half steps from the first axis across, 0 or 1."""

    def __post_init__(self) -> None:
        if len(self.numbers) != len(NUMBERS[self.kind]):
            raise ValueError(
                f"a {self.kind} of {len(self.numbers)} numbers, expected {len(NUMBERS[self.kind])}"
            )
        if (self.lining is None) != (self.lined is None):
            raise ValueError("a piece has a lining and the side it lines, or neither")


def across(axis: int) -> tuple[int, int]:
    """The axes after ``axis``, in cyclic order."""
    return (axis + 1) % 3, (axis + 2) % 3


@cache
def number_axes(kind: PieceKind, axis: int) -> tuple[int | None, ...]:
    """The axis along which each number is a coordinate; None for a length."""
    u, v = across(axis)
    named: dict[str, int | None] = {"x": 0, "y": 1, "z": 2, "u": u, "v": v}
    holes = {"hole_y": 1, "hole_z": 2}
    return tuple(
        named[name[0]] if name[1:] in ("0", "1", "3") and name[0] in named else holes.get(name)
        for name in NUMBERS[kind]
    )


def fit_pieces(primitives: Sequence[Primitive]) -> tuple[Piece, ...]:
    """The pieces that a part's primitives are, in their order; numbers in metres.

    Raises:
        UnknownSolid: If a primitive is none of the known solids.
    """
    found, at = [], 0
    while at < len(primitives):
        piece, count = _fit_group(primitives[at:])
        found.append(piece)
        at += count
    return tuple(found)


@lru_cache(maxsize=4096)
def build_piece(piece: Piece) -> tuple[Primitive, ...]:
    """The convex primitives of a piece; numbers in metres.

    Raises:
        ValueError: If the numbers describe no solid.
    """
    low, high = np.array(piece.numbers[:3]), np.array(piece.numbers[3:6])
    more = piece.numbers[6:]
    match piece.kind:
        case "box":
            made = (rounded_box(_vector(low), _vector(high), more[0], piece.finish),)
        case "cylinder":
            made = (_build_cylinder(piece, low, high),)
        case "frustum":
            made = (_build_frustum(piece, low, high),)
        case "prism":
            made = (_build_prism(piece, low, high),)
        case "ring":
            made = _build_ring(piece, low, high)
        case "spokes":
            made = _build_spokes(piece, low, high)
        case "plate":
            outline = ((low[1], high[1]), (low[2], high[2]))
            lining = piece.lining if piece.lined == INWARD else None
            made = build_pierced_plate(
                (low[0], high[0]), outline, (more[0], more[1], more[2]), piece.finish, lining=lining
            )
    if piece.lining is None or piece.lined is None or piece.lined == INWARD:
        return made
    return tuple(line(primitive, piece.lining, LINED[piece.lined]) for primitive in made)


def _vector(values: Float[np.ndarray, "3"]) -> Vector:
    return float(values[0]), float(values[1]), float(values[2])


def _build_cylinder(piece: Piece, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]) -> Primitive:
    start, end = (low + high) / 2, (low + high) / 2
    start[piece.axis], end[piece.axis] = low[piece.axis], high[piece.axis]
    u, v = across(piece.axis)
    diameter = ((high - low)[u] + (high - low)[v]) / 2
    return cylinder(_vector(start), _vector(end), diameter / 2, piece.finish)


def _build_frustum(piece: Piece, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]) -> Primitive:
    u, v = across(piece.axis)
    ends = np.array([piece.numbers[6:], (low[u], low[v], high[u], high[v])])
    if not (ends[:, 2:] > ends[:, :2]).all() or not high[piece.axis] > low[piece.axis]:
        raise ValueError(f"a frustum with ends {ends.tolist()}: edges must be positive")
    rim = _rim(piece.sides, u, v)
    corners = np.empty((2 * len(rim), 3))
    for index, (end, along) in enumerate(zip(ends, (low, high), strict=True)):
        rows = slice(index * len(rim), (index + 1) * len(rim))
        corners[rows, u] = (end[0] + end[2]) / 2 + rim[:, 0] * (end[2] - end[0]) / 2
        corners[rows, v] = (end[1] + end[3]) / 2 + rim[:, 1] * (end[3] - end[1]) / 2
        corners[rows, piece.axis] = along[piece.axis]
    return polytope(corners, piece.finish)


def _rim(sides: int, u: int, v: int) -> Float[np.ndarray, "N 2"]:
    """Corners (u, v) of a polygon in [-1, 1]^2; of many sides, one has corners along y if it can."""
    if sides == 4:
        return np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    turns = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    rim = np.column_stack([np.cos(turns), np.sin(turns)])
    return rim[:, ::-1] if u == 1 else rim


def _build_prism(piece: Piece, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]) -> Primitive:
    u, v = across(piece.axis)
    u1, v1, u3, v3 = piece.numbers[6:]
    profile = np.array([(low[u], low[v]), (u1, v1), (high[u], high[v]), (u3, v3)])
    corners = np.empty((8, 3))
    corners[:, [u, v]] = np.tile(profile, (2, 1))
    corners[:, piece.axis] = np.repeat([low[piece.axis], high[piece.axis]], 4)
    made = polytope(corners, piece.finish)
    if len(made.vertices) != 8:
        raise ValueError(f"a prism with corners {profile.tolist()}: they do not form a convex polygon")
    return made


def _build_ring(
    piece: Piece, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]
) -> tuple[Primitive, ...]:
    """Wedges about x or z."""
    u, v = across(piece.axis)
    inner0, inner1, outer0 = piece.numbers[6:]
    outer1 = ((high - low)[u] + (high - low)[v]) / 4
    if not (0 < inner0 < outer0 * np.cos(np.pi / piece.sides) and 0 < inner1 < outer1):
        raise ValueError(f"a ring with radii {inner0, outer0}, {inner1, outer1}: expected inner < outer")
    center = (low + high) / 2
    center[piece.axis] = 0.0
    return build_ring(
        _vector(center),
        "xyz"[piece.axis],
        (low[piece.axis], high[piece.axis]),
        ((inner0, outer0), (inner1, outer1)),
        piece.finish,
        sides=piece.sides,
        lining=piece.lining if piece.lined == INWARD else None,
    )


def _build_spokes(
    piece: Piece, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]
) -> tuple[Primitive, ...]:
    u, v = _spoke_axes(piece.axis)
    inner, half = piece.numbers[6:]
    corner0, corner1 = np.empty(3), np.empty(3)
    corner0[piece.axis], corner1[piece.axis] = low[piece.axis], high[piece.axis]
    corner0[u], corner1[u] = inner, ((high - low)[u] + (high - low)[v]) / 4
    corner0[v], corner1[v] = -half, half
    center = (low + high) / 2
    center[piece.axis] = 0.0
    blade = rounded_box(_vector(corner0), _vector(corner1), 0.0, piece.finish)
    about = _vector(np.eye(3)[piece.axis])
    step = 2 * np.pi / piece.sides
    return tuple(
        move(blade, _vector(center), turn=(k + piece.phase / 2) * step, about=about)
        for k in range(piece.sides)
    )


def _spoke_axes(axis: int) -> tuple[int, int]:
    """Along the first spoke, and across it: as wedges of rings lie."""
    return (1, 2) if axis == 0 else (0, 1) if axis == 2 else (2, 0)


def _fit_group(primitives: Sequence[Primitive]) -> tuple[Piece, int]:
    """The piece that the first primitives are, and how many of them it takes."""
    first = primitives[0]
    if first.kind == "cylinder":
        return _fit_cylinder(first), 1
    turned = _fit_turned(primitives)
    if turned is not None:
        return turned, turned.sides
    if len(primitives) >= _PLATE_SIDES and first.lining is not None:
        plate = _fit_plate(primitives[:_PLATE_SIDES])
        if plate is not None:
            return plate, _PLATE_SIDES
    return _fit_polytope(first), 1


class _Said(TypedDict):
    finish: str
    lining: str | None
    lined: int | None


def _surface(primitive: Primitive) -> _Said:
    """What a piece says of its surface."""
    if primitive.lined_side is None:
        return _Said(finish=primitive.finish, lining=None, lined=None)
    near = np.array(LINED) @ np.array(primitive.lined_side)
    if near.max() < 1 - 1e-9:
        raise UnknownSolid(f"a lining on the side {primitive.lined_side}, expected along an axis")
    return _Said(finish=primitive.finish, lining=primitive.lining, lined=int(near.argmax()))


def _fit_cylinder(primitive: Primitive) -> Piece:
    axis = int(np.abs(primitive.rotation[:, 2]).argmax())
    if abs(primitive.rotation[axis, 2]) < 1 - 1e-9:
        raise UnknownSolid(f"a cylinder along {primitive.rotation[:, 2].tolist()}, expected along an axis")
    half = np.full(3, primitive.size[0] / 2)
    half[axis] = primitive.size[2] / 2
    numbers = (*(primitive.center - half).tolist(), *(primitive.center + half).tolist())
    return Piece(kind="cylinder", numbers=numbers, axis=axis, **_surface(primitive))


def _fit_polytope(primitive: Primitive) -> Piece:
    """A box, sharp or bevelled, a frustum or a prism."""
    points = place_vertices(primitive)
    low, high = points.min(axis=0), points.max(axis=0)
    shared = _surface(primitive)
    bevel = _find_bevel(points, low, high)
    if bevel is not None:
        numbers = (*low.tolist(), *high.tolist(), bevel)
        return Piece(kind="box", numbers=numbers, **shared)
    for fit in (_fit_frustum, _fit_prism):
        for axis in range(3):
            found = fit(points, axis, low, high)
            if found is None:
                continue
            sides, numbers = found
            kind = "frustum" if fit is _fit_frustum else "prism"
            piece = Piece(kind=kind, numbers=numbers, axis=axis, sides=sides, **shared)
            if _is_same([primitive], build_piece(piece)):
                return piece
    raise UnknownSolid(f"a solid with corners {np.round(points, 4).tolist()}, expected one of {PIECE_KINDS}")


def _find_bevel(
    points: Float[np.ndarray, "V 3"], low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]
) -> float | None:
    """Width of a box's bevel, 0 for a sharp one; None for other solids."""
    depth = np.minimum(points - low, high - points)
    if len(points) == 8:
        return 0.0 if depth.max() < _TOLERANCE else None
    if len(points) != 24:
        return None
    bevel = float(depth.max())
    inside = depth > _TOLERANCE
    even = np.abs(depth[inside] - bevel).max() < _TOLERANCE and (inside.sum(axis=1) == 2).all()
    return bevel if even else None


def _fit_frustum(
    points: Float[np.ndarray, "V 3"], axis: int, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]
) -> tuple[int, tuple[float, ...]] | None:
    layers = _split_layers(points, axis, low, high)
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
    return sides, (*bounds[0].tolist(), *bounds[1].tolist(), *rectangles[0])


def _fit_prism(
    points: Float[np.ndarray, "V 3"], axis: int, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]
) -> tuple[int, tuple[float, ...]] | None:
    layers = _split_layers(points, axis, low, high)
    if layers is None or len(layers[0]) != 4:
        return None
    u, v = across(axis)
    flat = layers[0][:, [u, v]]
    spokes = flat - flat.mean(axis=0)
    flat = flat[np.argsort(np.arctan2(spokes[:, 1], spokes[:, 0]))]
    flat = np.roll(flat, -int(np.lexsort((flat[:, 1].round(7), flat[:, 0].round(7)))[0]), axis=0)
    bounds = np.array([low, high])
    bounds[:, u], bounds[:, v] = flat[[0, 2], 0], flat[[0, 2], 1]
    return 0, (*bounds[0].tolist(), *bounds[1].tolist(), *flat[1].tolist(), *flat[3].tolist())


def _split_layers(
    points: Float[np.ndarray, "V 3"], axis: int, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]
) -> tuple[Float[np.ndarray, "N 3"], Float[np.ndarray, "N 3"]] | None:
    """The corners at both ends of an axis, if that is all of them and as many at each."""
    bottom = points[:, axis] - low[axis] < _TOLERANCE
    top = high[axis] - points[:, axis] < _TOLERANCE
    if not (bottom ^ top).all() or bottom.sum() != top.sum():
        return None
    return points[bottom], points[top]


def _fit_turned(primitives: Sequence[Primitive]) -> Piece | None:
    """A ring or spokes: copies of one solid, turned about an axis by equal steps of a full turn."""
    first = primitives[0]
    count = 1
    while count < len(primitives) and np.array_equal(primitives[count].vertices, first.vertices):
        count += 1
    if count < 2:
        return None
    turn = primitives[1].rotation @ first.rotation.T
    angle = float(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
    if angle < 1e-6:
        return None
    sides = round(2 * np.pi / angle)
    axis = int(np.abs(np.diag(turn) - 1).argmin())
    if sides < 2 or sides > count or abs(turn[axis, axis] - 1) > 1e-9:
        return None
    u, v = across(axis)
    flat = np.array([primitive.center[[u, v]] for primitive in primitives[:sides]])
    center = np.zeros(3)
    center[[u, v]] = flat.mean(axis=0)
    for phase in (0, 1):
        about = _vector(np.eye(3)[axis])
        base = move(first, _vector(-center), turn=0.0)
        points = place_vertices(move(base, turn=-phase * np.pi / sides, about=about))
        copy = _Copy(points=points, center=center, axis=axis, sides=sides, phase=phase, first=first)
        for fit in (_fit_spokes, _fit_ring):
            piece = fit(copy)
            if piece is not None and _is_same(primitives[:sides], build_piece(piece)):
                return piece
    return None


@dataclass(frozen=True, kw_only=True, eq=False)
class _Copy:
    """The first of solids that are copies turned about one axis, moved to the origin and turned back."""

    points: Float[np.ndarray, "V 3"]
    center: Float[np.ndarray, "3"]
    axis: int
    sides: int
    phase: int
    """1 where the first is turned by half a step."""
    first: Primitive


def _fit_ring(copy: _Copy) -> Piece | None:
    points, axis, sides, first = copy.points, copy.axis, copy.sides, copy.first
    if copy.phase == 0 or axis == 1 or len(points) != 8 or sides < MIN_WEDGES:
        return None
    out = points[:, _spoke_axes(axis)[0]]
    span = (points[:, axis].min(), points[:, axis].max())
    ends = [out[np.abs(points[:, axis] - along) < _TOLERANCE] for along in span]
    inner = [float(end.min()) for end in ends]
    outer = [float(end.max()) / np.cos(np.pi / sides) for end in ends]
    if min(inner) <= 0:
        return None
    return Piece(
        kind="ring",
        finish=first.finish,
        numbers=(*_square(copy.center, axis, span, outer[1]), inner[0], inner[1], outer[0]),
        axis=axis,
        sides=sides,
        lining=first.lining,
        lined=None if first.lining is None else INWARD,
    )


def _fit_spokes(copy: _Copy) -> Piece | None:
    points, axis, first = copy.points, copy.axis, copy.first
    u, v = _spoke_axes(axis)
    low, high = points.min(axis=0), points.max(axis=0)
    if _find_bevel(points, low, high) != 0.0 or low[u] <= 0 or first.lining is not None:
        return None
    span = (low[axis], high[axis])
    return Piece(
        kind="spokes",
        finish=first.finish,
        numbers=(*_square(copy.center, axis, span, float(high[u])), float(low[u]), float(high[v])),
        axis=axis,
        sides=copy.sides,
        phase=copy.phase,
    )


def _square(
    center: Float[np.ndarray, "3"], axis: int, span: tuple[float, float], radius: float
) -> tuple[float, ...]:
    low, high = center - radius, center + radius
    low[axis], high[axis] = span
    return (*low.tolist(), *high.tolist())


def _fit_plate(primitives: Sequence[Primitive]) -> Piece | None:
    points = np.concatenate([place_vertices(primitive) for primitive in primitives])
    low, high = points.min(axis=0), points.max(axis=0)
    depth = np.minimum(points - low, high - points)[:, 1:].min(axis=1)
    near = np.unique(points[depth > _TOLERANCE][:, 1:].round(7), axis=0)
    if len(near) != _PLATE_SIDES:
        return None
    middle = near.mean(axis=0)
    radius = float(np.linalg.norm(near - middle, axis=1).mean() * np.cos(np.pi / _PLATE_SIDES))
    piece = Piece(
        kind="plate",
        finish=primitives[0].finish,
        numbers=(*low.tolist(), *high.tolist(), *middle.tolist(), radius),
        lining=primitives[0].lining,
        lined=INWARD,
    )
    return piece if _is_same(primitives, build_piece(piece)) else None


def _is_same(these: Sequence[Primitive], those: Sequence[Primitive]) -> bool:
    """Whether two groups have the same corners, one by one."""
    if len(these) != len(those):
        return False
    for a, b in zip(these, those, strict=True):
        one, other = place_vertices(a), place_vertices(b)
        if len(one) != len(other):
            return False
        apart = np.abs(one[:, None] - other[None]).max(axis=2).min(axis=1)
        if apart.max() > _TOLERANCE:
            return False
    return True
