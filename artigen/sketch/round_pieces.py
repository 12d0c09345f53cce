"""Builds and fits round pieces of several primitives: rings, spokes and plates with a round hole."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.shapes.appliances.rings import build_pierced_plate
from artigen.shapes.appliances.rings import build_ring as build_wedges
from artigen.shapes.primitives import Primitive, as_vector, move, place_vertices, rounded_box
from artigen.sketch.piece import INWARD, MIN_WEDGES, TOLERANCE, Piece, across, lined_inward
from artigen.sketch.solid_pieces import find_bevel, is_same

PLATE_SIDES = 12
"""Number of primitives of a plate with a hole."""


def build_ring(piece: Piece) -> tuple[Primitive, ...]:
    """Wedges about x or z."""
    low, high, (u, v) = piece.low, piece.high, across(piece.axis)
    inner0, inner1, outer0 = piece.rest
    outer1 = ((high - low)[u] + (high - low)[v]) / 4
    if not (0 < inner0 < outer0 * np.cos(np.pi / piece.sides) and 0 < inner1 < outer1):
        raise ValueError(f"a ring with radii {inner0, outer0}, {inner1, outer1}: expected inner < outer")
    center = (low + high) / 2
    center[piece.axis] = 0.0
    return build_wedges(
        as_vector(center),
        "xyz"[piece.axis],
        (low[piece.axis], high[piece.axis]),
        ((inner0, outer0), (inner1, outer1)),
        piece.finish,
        sides=piece.sides,
        lining=piece.lining if piece.lined == INWARD else None,
    )


def build_spokes(piece: Piece) -> tuple[Primitive, ...]:
    """Boxes around an axis."""
    low, high, (u, v) = piece.low, piece.high, _spoke_axes(piece.axis)
    inner, half = piece.rest
    corner0, corner1 = np.empty(3), np.empty(3)
    corner0[piece.axis], corner1[piece.axis] = low[piece.axis], high[piece.axis]
    corner0[u], corner1[u] = inner, ((high - low)[u] + (high - low)[v]) / 4
    corner0[v], corner1[v] = -half, half
    center = (low + high) / 2
    center[piece.axis] = 0.0
    blade = rounded_box(as_vector(corner0), as_vector(corner1), 0.0, piece.finish)
    about = as_vector(np.eye(3)[piece.axis])
    step = 2 * np.pi / piece.sides
    return tuple(
        move(blade, as_vector(center), turn=(k + piece.phase / 2) * step, about=about)
        for k in range(piece.sides)
    )


def _spoke_axes(axis: int) -> tuple[int, int]:
    """Axes along the first spoke and across it, oriented as for the wedges of a ring."""
    return (1, 2) if axis == 0 else (0, 1) if axis == 2 else (2, 0)


def build_plate(piece: Piece) -> tuple[Primitive, ...]:
    """A plate across x with a round hole."""
    (x0, y0, z0), (x1, y1, z1) = piece.numbers[:3], piece.numbers[3:6]
    y, z, radius = piece.rest
    lining = piece.lining if piece.lined == INWARD else None
    return build_pierced_plate((x0, x1), ((y0, y1), (z0, z1)), (y, z, radius), piece.finish, lining=lining)


def fit_turned(primitives: Sequence[Primitive]) -> Piece | None:
    """Fits a ring or spokes: copies of one solid at equal angles over a full turn about an axis."""
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
        about = as_vector(np.eye(3)[axis])
        base = move(first, as_vector(-center), turn=0.0)
        points = place_vertices(move(base, turn=-phase * np.pi / sides, about=about))
        copy = _Copy(points=points, center=center, axis=axis, sides=sides, phase=phase, first=first)
        for fit, build in ((_fit_spokes, build_spokes), (_fit_ring, build_ring)):
            piece = fit(copy)
            if piece is not None and is_same(primitives[:sides], build(piece)):
                return piece
    return None


@dataclass(frozen=True, kw_only=True, eq=False)
class _Copy:
    """First of several copies rotated about one axis, moved to the origin and rotated back."""

    points: Float[np.ndarray, "V 3"]
    center: Float[np.ndarray, "3"]
    axis: int
    sides: int
    phase: int
    """1 if the first copy is rotated by half a step."""
    first: Primitive


def _fit_ring(copy: _Copy) -> Piece | None:
    points, axis, sides, first = copy.points, copy.axis, copy.sides, copy.first
    if copy.phase == 0 or axis == 1 or len(points) != 8 or sides < MIN_WEDGES:
        return None
    out = points[:, _spoke_axes(axis)[0]]
    span = (points[:, axis].min(), points[:, axis].max())
    ends = [out[np.abs(points[:, axis] - along) < TOLERANCE] for along in span]
    inner = [float(end.min()) for end in ends]
    outer = [float(end.max()) / np.cos(np.pi / sides) for end in ends]
    if min(inner) <= 0:
        return None
    return Piece(
        kind="ring",
        numbers=(*_square(copy.center, axis, span, outer[1]), inner[0], inner[1], outer[0]),
        axis=axis,
        sides=sides,
        **lined_inward(first),
    )


def _fit_spokes(copy: _Copy) -> Piece | None:
    points, axis, first = copy.points, copy.axis, copy.first
    u, v = _spoke_axes(axis)
    low, high = points.min(axis=0), points.max(axis=0)
    if find_bevel(points, low, high) != 0.0 or low[u] <= 0 or first.lining is not None:
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


def fit_plate(primitives: Sequence[Primitive]) -> Piece | None:
    """Fits a plate with a hole to its primitives."""
    points = np.concatenate([place_vertices(primitive) for primitive in primitives])
    low, high = points.min(axis=0), points.max(axis=0)
    depth = np.minimum(points - low, high - points)[:, 1:].min(axis=1)
    near = np.unique(points[depth > TOLERANCE][:, 1:].round(7), axis=0)
    if len(near) != PLATE_SIDES:
        return None
    middle = near.mean(axis=0)
    radius = float(np.linalg.norm(near - middle, axis=1).mean() * np.cos(np.pi / PLATE_SIDES))
    piece = Piece(
        kind="plate",
        numbers=(*low.tolist(), *high.tolist(), *middle.tolist(), radius),
        **lined_inward(primitives[0]),
    )
    return piece if is_same(primitives, build_plate(piece)) else None
