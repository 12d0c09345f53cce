"""The triangles of a link that can be reached, and those that boxes leave uncovered."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from sim_export.collision.cover.free_space import FreeSpace
from sim_export.geometry.grid import is_exposed
from sim_export.geometry.triangles import triangle_normals
from sim_export.package import Hull

HALVED = 8
"""Times that triangles which boxes cover in part are halved, at most."""
SMALLEST = 4.0
"""Edge of such triangles over the slack, below which they are not halved any more."""
_PLACES = np.array(
    [
        [0.96, 0.02, 0.02], [0.02, 0.96, 0.02], [0.02, 0.02, 0.96],
        [0.50, 0.48, 0.02], [0.02, 0.50, 0.48], [0.48, 0.02, 0.50],
        [0.66, 0.17, 0.17], [0.17, 0.66, 0.17], [0.17, 0.17, 0.66], [1 / 3, 1 / 3, 1 / 3],
    ]
)  # fmt: skip
"""Barycentric coordinates of the points by which a triangle is judged."""


def find_exposed(triangles: Float[np.ndarray, "F 3 3"], space: FreeSpace) -> Float[np.ndarray, "G 3 3"]:
    """The triangles before which there is free space: those that a gripper can reach."""
    normals = triangle_normals(triangles)
    points = _spread(triangles)
    free = space.depth > 0.0
    shown = np.zeros(len(triangles), dtype=bool)
    for corner in range(points.shape[1]):
        for side in (1.0, -1.0):
            shown |= is_exposed(points[:, corner], side * normals, free, space.grid)
    return triangles[shown]


def find_uncovered(
    triangles: Float[np.ndarray, "F 3 3"], boxes: Sequence[Hull], slack: float
) -> Float[np.ndarray, "G 3 3"]:
    """What of some triangles lies farther than ``slack`` (m) outside of boxes, in smaller triangles."""
    out = []
    left = triangles
    for halving in range(HALVED + 1):
        points = _spread(left)
        inside = _in_boxes(points.reshape(-1, 3), boxes, slack).reshape(points.shape[:2])
        left, inside = left[~inside.all(axis=1)], inside[~inside.all(axis=1)]
        longest = np.linalg.norm(np.roll(left, -1, axis=1) - left, axis=2).max(axis=1)
        partly = inside.any(axis=1)
        more = partly & (halving < HALVED) & (longest > SMALLEST * slack)
        out.append(left[~more & (inside.mean(axis=1) < 0.5)])
        left = _halve(left[more])
        if not len(left):
            break
    return np.concatenate(out)


def _in_boxes(points: Float[np.ndarray, "N 3"], boxes: Sequence[Hull], slack: float) -> Bool[np.ndarray, "N"]:
    """Points in boxes that are ``slack`` (m) larger on all sides."""
    out = np.zeros(len(points), dtype=bool)
    for box in boxes:
        rows = np.flatnonzero(~out)
        for axis, (low, high) in enumerate(
            zip(box.vertices.min(axis=0) - slack, box.vertices.max(axis=0) + slack, strict=True)
        ):
            at = points[rows, axis]
            rows = rows[(at >= low) & (at <= high)]
        out[rows] = True
    return out


def _spread(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "F 10 3"]:
    """Points on every triangle, from its corners to its middle."""
    return np.einsum("kc,fcd->fkd", _PLACES, triangles)


def _halve(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "G 3 3"]:
    """Two triangles for each, divided across its longest edge."""
    edges = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)
    first = edges.argmax(axis=1)
    turned = triangles[np.arange(len(triangles))[:, None], (first[:, None] + np.arange(3)) % 3]
    a, b, c = turned[:, 0], turned[:, 1], turned[:, 2]
    middle = (a + b) / 2
    return np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
