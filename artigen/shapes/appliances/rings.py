"""Round solids made of convex pieces: rings and drums of wedges, plates with a round hole."""

from functools import cache
from itertools import pairwise

import numpy as np

from artigen.shapes.primitives import FRONT, RIGHT, Primitive, Vector, line, move, polytope, prism
from artigen.shapes.ranges import Range

SECTORS = 12
"""Pieces of a plate around its hole."""
AXES: dict[str, Vector] = {"x": (1.0, 0.0, 0.0), "z": (0.0, 0.0, 1.0)}


def build_ring(
    center: Vector,
    axis: str,
    span: Range,
    radii: tuple[Range, Range],
    finish: str,
    *,
    sides: int = 16,
    lining: str | None = None,
) -> tuple[Primitive, ...]:
    """A ring of wedges around an axis ("x" or "z"): a tube, or a funnel if its ends differ.

    Args:
        center: Point on the axis, from which ``span`` counts.
        axis: Direction of the axis.
        span: Ends of the tube along the axis.
        radii: Inner radius (of the free circle) and outer radius (of the corners) at the two ends.
        finish: Role of the finish.
        sides: Number of wedges.
        lining: Role of the finish of the inside.
    """
    wedge = _wedge(axis, span, radii, finish, sides)
    if lining is not None:
        inward = RIGHT if axis == "x" else FRONT
        wedge = line(wedge, lining, inward)
    turn = 2 * np.pi / sides
    return tuple(move(wedge, center, turn=(k + 0.5) * turn, about=AXES[axis]) for k in range(sides))


def build_pierced_plate(
    x: Range,
    outline: tuple[Range, Range],
    hole: tuple[float, float, float],
    finish: str,
    *,
    lining: str | None = None,
) -> tuple[Primitive, ...]:
    """A vertical plate (y, z ranges in ``outline``) with a round hole (y, z, radius of the free circle).

    Each piece is the part of the plate in one sector outside one side of the polygon around the hole.
    """
    y, z, radius = hole
    rim = radius / np.cos(np.pi / SECTORS)
    angles = (np.arange(SECTORS + 1) + 0.5) * 2 * np.pi / SECTORS
    corners = np.array([(a - y, b - z) for a in outline[0] for b in outline[1]])
    corner_angles = np.arctan2(corners[:, 1], corners[:, 0]) % (2 * np.pi)
    pieces = []
    for start, end in pairwise(angles):
        between = (corner_angles - start) % (2 * np.pi) < end - start
        near = rim * np.array([(np.cos(a), np.sin(a)) for a in (start, end)])
        far = np.array([_reach_edge(a, outline, (y, z)) for a in (start, end)])
        profile = np.concatenate([near, far, corners[between]])
        piece = prism(profile + np.array([y, z]), (x[0], 0.0, 0.0), (x[1], 0.0, 0.0), finish)
        if lining is not None:
            middle = (start + end) / 2
            piece = line(piece, lining, (0.0, -float(np.cos(middle)), -float(np.sin(middle))))
        pieces.append(piece)
    return tuple(pieces)


def _reach_edge(angle: float, outline: tuple[Range, Range], center: tuple[float, float]) -> np.ndarray:
    """Point, relative to the centre, where a ray from the centre leaves the rectangle."""
    ray = np.array([np.cos(angle), np.sin(angle)])
    limits = [
        (outline[k][1 if ray[k] > 0 else 0] - center[k]) / ray[k] for k in (0, 1) if abs(ray[k]) > 1e-12
    ]
    return ray * min(limits)


@cache
def _wedge(axis: str, span: Range, radii: tuple[Range, Range], finish: str, sides: int) -> Primitive:
    """One wedge of a ring about the origin, centred on +y (axis x) or +x (axis z)."""
    half = np.pi / sides
    corners = []
    for along, (inner, outer) in zip(span, radii, strict=True):
        flat = [(inner, side * inner * np.tan(half)) for side in (-1, 1)]
        flat += [(outer * np.cos(half), side * outer * np.sin(half)) for side in (-1, 1)]
        for out, aside in flat:
            corners.append((along, out, aside) if axis == "x" else (out, aside, along))
    return polytope(np.array(corners), finish)
