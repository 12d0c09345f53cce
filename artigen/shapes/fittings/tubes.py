"""Bent tubes and rods as mitred convex pieces: spouts, lever handles, bails, lamp arms."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from artigen.shapes.primitives import Primitive, Vector, polytope


def bend_tube(
    path: Sequence[Vector], radii: float | Sequence[float], finish: str, *, sides: int = 12
) -> tuple[Primitive, ...]:
    """A rod along a polyline, mitred at every bend.

    Args:
        path: Points of its centre line (m), at least two; bends of less than a right angle.
        radii: Of its corners (m), one for all points or one each.
        finish: Surface.
        sides: Sides of its cross section; multiples of four fill the box around a round rod.
    """
    points = np.asarray(path, dtype=float)
    sizes = np.broadcast_to(np.asarray(radii, dtype=float), len(points))
    ways = np.diff(points, axis=0)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    angles = np.arange(sides) * 2 * np.pi / sides
    across = np.cross(ways[0], np.eye(3)[int(np.argmin(np.abs(ways[0])))])
    across /= np.linalg.norm(across)
    rings = []
    for index, (point, size) in enumerate(zip(points, sizes, strict=True)):
        before, after = ways[max(index - 1, 0)], ways[min(index, len(ways) - 1)]
        circle = np.outer(np.cos(angles), across) + np.outer(np.sin(angles), np.cross(before, across))
        mitre = before + after
        along = (circle @ mitre) / (before @ mitre)
        rings.append(point + size * (circle - along[:, None] * before))
        across = across - (across @ after) / (1.0 + before @ after) * mitre  # turned with the rod
    return tuple(polytope(np.concatenate(pair), finish) for pair in pairwise(rings))


def sweep_arc(
    center: Vector, first: Vector, second: Vector, turn: tuple[float, float], count: int
) -> Float[np.ndarray, "N 3"]:
    """Points on an arc: ``center + cos(a) first + sin(a) second`` for ``count`` angles between two."""
    angles = np.linspace(*turn, count)[:, None]
    return np.array(center) + np.cos(angles) * np.array(first) + np.sin(angles) * np.array(second)
