"""Hollow bodies with any star-shaped outline: bowls, seats, rims, from one convex piece per side.

An outline is a polygon of (x, y) corners, counterclockwise; outlines of one body have equally many.
"""

import numpy as np
from jaxtyping import Float

from artigen.shapes.fittings.hardware import Range
from artigen.shapes.primitives import Primitive, polytope

Outline = Float[np.ndarray, "N 2"]


def draw_egg(
    center: tuple[float, float], front: float, back: float, half: float, *, sides: int = 16
) -> Outline:
    """An ellipse that reaches ``front`` to -x, ``back`` to +x and ``half`` to both sides (m)."""
    turns = np.arange(sides) * 2 * np.pi / sides
    reach = np.where(np.cos(turns) < 0, front, back)
    return np.column_stack([center[0] + reach * np.cos(turns), center[1] + half * np.sin(turns)])


def inset(outline: Outline, by: float) -> Outline:
    """The outline with every corner moved ``by`` metres towards the middle of its box."""
    spokes = outline - (outline.min(axis=0) + outline.max(axis=0)) / 2
    return outline - by * spokes / np.linalg.norm(spokes, axis=1, keepdims=True)


def build_solid(low: Outline, high: Outline, z: Range, finish: str) -> Primitive:
    """A convex body between two convex outlines at two heights."""
    return polytope(np.concatenate([_lift(low, z[0]), _lift(high, z[1])]), finish)


def build_wall(
    outer: tuple[Outline, Outline], inner: tuple[Outline, Outline], z: Range, finish: str
) -> tuple[Primitive, ...]:
    """A wall around a hollow, between outlines at its foot and at its rim.

    Args:
        outer: At the foot and at the rim.
        inner: Of the hollow, at the foot and at the rim.
        z: Heights of foot and rim.
        finish: Surface.
    """
    rings = [
        _lift(outline, height) for pair in (outer, inner) for outline, height in zip(pair, z, strict=True)
    ]
    following = [np.roll(ring, -1, axis=0) for ring in rings]
    corners = np.stack([*rings, *following], axis=1)
    return tuple(polytope(piece, finish) for piece in corners)


def _lift(outline: Outline, height: float) -> Float[np.ndarray, "N 3"]:
    return np.column_stack([outline, np.full(len(outline), height)])
