"""Rounds pieces in metres to whole grid steps."""

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

from artigen.sketch.piece import SQUARE_KINDS, Piece, across
from artigen.sketch.solid_pieces import build_prism, fit_polytope, room_to_cut

STEP = 0.0005
"""Metres per step of a length."""
_EPSILON = 1e-6
"""Metres."""


def snap_piece(piece: Piece) -> Piece:
    """Rounds a piece in metres to steps; edges keep a positive length and squares stay square."""
    numbers = [round(number / STEP) for number in piece.numbers]
    kind, (u, v) = piece.kind, across(piece.axis)
    for axis in range(3):
        if kind != "prism" or axis == piece.axis:
            numbers[3 + axis] = max(numbers[3 + axis], numbers[axis] + 1)
    if is_square(piece):
        diameter = max(round((piece.numbers[3 + u] - piece.numbers[u]) / STEP), 1)
        for axis in (u, v):
            middle = (piece.numbers[axis] + piece.numbers[3 + axis]) / 2
            numbers[axis] = round(middle / STEP - diameter / 2)
            numbers[3 + axis] = numbers[axis] + diameter
    if kind == "box":
        least = min(numbers[3 + axis] - numbers[axis] for axis in range(3))
        numbers[6] = min(numbers[6], (least - 1) // 2)
    if kind == "frustum":
        width = max(numbers[8] - numbers[6], 1)
        numbers[8] = numbers[6] + width
        numbers[9] = numbers[7] + width if is_square(piece) else max(numbers[9], numbers[7] + 1)
    if kind in ("slab", "shell"):
        sizes = [numbers[3 + axis] - numbers[axis] for axis in (u, v)]
        measured = [piece.numbers[3 + axis] - piece.numbers[axis] for axis in (u, v)]
        numbers[6:] = (_snap_slab if kind == "slab" else _snap_shell)(piece, sizes, measured)
    snapped = replace(piece, numbers=tuple(numbers))
    return _find_frustum(snapped) if kind == "prism" else snapped


def to_metres(piece: Piece) -> Piece:
    """A piece in steps, in metres."""
    return replace(piece, numbers=tuple(number * STEP for number in piece.numbers))


def _find_frustum(prism: Piece) -> Piece:
    """A prism in steps, or the equivalent frustum if it has two parallel sides perpendicular to an axis."""
    u, v = across(prism.axis)
    u1, v1, u3, v3 = prism.rest
    ends = prism.numbers[u], u1, prism.numbers[3 + u], u3
    others = prism.numbers[v], v1, prism.numbers[3 + v], v3
    if not any(len(set(side)) == 2 and side.count(side[0]) == 2 for side in (ends, others)):
        return prism
    try:
        found = fit_polytope(build_prism(to_metres(prism)))
    except ValueError:  # the rounded prism is degenerate; reading the sketch reports it
        return prism
    numbers = tuple(round(number / STEP) for number in found.numbers)
    return replace(found, numbers=numbers, lining=prism.lining, lined=prism.lined)


def _snap_slab(piece: Piece, sizes: Sequence[int], measured: Sequence[float]) -> list[int]:
    """Lengths of arcs in steps; arcs that use all of an edge still do.

    Args:
        piece: Piece in metres.
        sizes: Its edges along u and v, in steps.
        measured: The same edges in metres.
    """
    out = []
    for cut, share, size, length in zip(piece.rest, room_to_cut(piece.corners), sizes, measured, strict=True):
        most = ceil(share * size)
        out.append(most if cut > share * length - _EPSILON else min(max(round(cut / STEP), 1), most))
    return out


def _snap_shell(piece: Piece, sizes: Sequence[int], measured: Sequence[float]) -> list[int]:
    """As `_snap_slab`; the wall keeps a positive thickness."""
    low, high, inset, wall = (round(number / STEP) for number in piece.rest)
    low = min(max(low, 1), sizes[0] - 1)
    meet = piece.rest[0] + piece.rest[1] > measured[0] - _EPSILON
    high = sizes[0] - low if meet else min(max(high, 1), sizes[0] - low)
    room = (min(sizes) - 1) // 2
    inset = min(max(inset, -room), room)
    wall = min(max(wall, 1), room - abs(inset)) if piece.rest[3] > 0 else 0
    return [low, high, inset, wall]


def is_square(piece: Piece) -> bool:
    """Whether the kind of solid has equal extents across its axis."""
    return piece.kind in SQUARE_KINDS or (piece.kind == "frustum" and piece.sides > 4)
