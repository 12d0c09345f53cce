"""Conversion between pieces and the convex primitives of a part.

Most pieces are one primitive; a ring, spokes around an axle, a plate with a round hole, a hollow shell and an
elbow are several. `fit_pieces` converts primitives to pieces; `build_piece` is the inverse.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

from artigen.shapes.primitives import Primitive, line
from artigen.sketch.lofted_pieces import build_elbow, build_shell, fit_elbow, fit_solid_shell, fit_walls
from artigen.sketch.piece import INWARD, LINED, Piece, PieceKind, UnknownSolid
from artigen.sketch.round_pieces import (
    PLATE_SIDES,
    build_plate,
    build_ring,
    build_spokes,
    fit_plate,
    fit_turned,
)
from artigen.sketch.solid_pieces import (
    build_box,
    build_cylinder,
    build_frustum,
    build_prism,
    build_slab,
    fit_cylinder,
    fit_polytope,
)

SINGLE: Mapping[PieceKind, Callable[[Piece], Primitive]] = {
    "box": build_box,
    "cylinder": build_cylinder,
    "frustum": build_frustum,
    "prism": build_prism,
    "slab": build_slab,
}
"""Builders of the kinds that are one primitive."""
SEVERAL: Mapping[PieceKind, Callable[[Piece], tuple[Primitive, ...]]] = {
    "ring": build_ring,
    "spokes": build_spokes,
    "plate": build_plate,
    "shell": build_shell,
    "elbow": build_elbow,
}
"""Builders of the others."""


def fit_pieces(primitives: Sequence[Primitive]) -> tuple[Piece, ...]:
    """Fits pieces to a part's primitives, in their order; numbers in metres.

    Raises:
        UnknownSolid: If no piece represents a primitive.
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
    made = (SINGLE[piece.kind](piece),) if piece.kind in SINGLE else SEVERAL[piece.kind](piece)
    if piece.lining is None or piece.lined is None or piece.lined == INWARD:
        return made
    return tuple(line(primitive, piece.lining, LINED[piece.lined]) for primitive in made)


def _fit_group(primitives: Sequence[Primitive]) -> tuple[Piece, int]:
    """Fits a piece to the first primitives; the second value is the number of primitives used."""
    first = primitives[0]
    if first.kind == "cylinder":
        return fit_cylinder(first), 1
    turned = fit_turned(primitives)
    if turned is not None:
        return turned, turned.sides
    if len(primitives) >= PLATE_SIDES and first.lining is not None:
        plate = fit_plate(primitives[:PLATE_SIDES])
        if plate is not None:
            return plate, PLATE_SIDES
    walls = fit_walls(primitives)
    if walls is not None:
        return walls
    try:
        return fit_polytope(first), 1
    except UnknownSolid:
        found = fit_elbow(primitives) or fit_solid_shell(first)
        if found is None:
            raise
        return found
