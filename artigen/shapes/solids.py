"""All primitives of a shape in one table, and visibility of points on their surfaces.

A part is the union of its primitives: points inside another primitive of the same part, or on a shared face,
are not on its surface. Parts are separate objects and do not hide each other.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.shapes.primitives import Primitive, contains, place_vertices
from artigen.shapes.shape import Shape

EPSILON = 1e-7
"""Distance (m) within which two surfaces count as one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Solids:
    """The primitives of a shape, part by part: bounds, owners, and which are axis-aligned boxes."""

    primitives: tuple[Primitive, ...]
    part_ids: Int[np.ndarray, "P"]
    low: Float[np.ndarray, "P 3"]
    high: Float[np.ndarray, "P 3"]
    upright: Bool[np.ndarray, "P"]
    """Whether the solid equals its bounding box."""


def list_solids(shape: Shape) -> Solids:
    """Collects the primitives of all parts in order."""
    primitives = tuple(primitive for part in shape.parts for primitive in part.primitives)
    bounds = np.array([primitive_bounds(primitive) for primitive in primitives])
    sizes = bounds[:, 1] - bounds[:, 0]
    upright = [
        primitive.kind == "polytope"
        and len(primitive.planes) == 6
        and bool(np.abs(size - primitive.size).max() < EPSILON)
        and bool((np.abs(primitive.planes[:, :3]).max(axis=1) > 1 - 1e-12).all())
        and bool((np.abs(primitive.rotation).max(axis=0) > 1 - 1e-12).all())
        for primitive, size in zip(primitives, sizes, strict=True)
    ]
    return Solids(
        primitives=primitives,
        part_ids=primitive_parts(shape),
        low=bounds[:, 0],
        high=bounds[:, 1],
        upright=np.array(upright),
    )


def primitive_parts(shape: Shape) -> Int[np.ndarray, "P"]:
    """Index of the part of every primitive, counted through all parts in order."""
    return np.repeat(np.arange(len(shape.parts)), [len(part.primitives) for part in shape.parts])


def primitive_bounds(primitive: Primitive) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner (m) of the exact solid: of the round cylinder, not of its prism."""
    if primitive.kind == "cylinder":
        along = primitive.rotation[:, 2]
        across = np.sqrt(np.clip(1.0 - along**2, 0.0, None))
        reach = primitive.size[0] / 2 * across + primitive.size[2] / 2 * np.abs(along)
        return np.stack([primitive.center - reach, primitive.center + reach])
    points = place_vertices(primitive)
    return np.stack([points.min(axis=0), points.max(axis=0)])


def see_points(
    solids: Solids,
    points: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    owners: Int[np.ndarray, "N"],
) -> Bool[np.ndarray, "N"]:
    """Whether points (m, on the surface of their owner) lie on the surface of their part.

    If two primitives share a face with the same orientation, the point of the first one counts.

    Args:
        solids: The primitives.
        points: Points on them, in ascending order of owner.
        normals: Outward unit normals.
        owners: Index of the primitive of each point.
    """
    seen = np.ones(len(points), dtype=bool)
    columns = np.ascontiguousarray(points.T)
    for index, close in _close_rows(solids, columns, columns, owners):
        rows = close[seen[close]]
        step = EPSILON * normals[rows]
        covered = _inside(solids, index, points[rows] + step)
        same = (owners[rows] > index) & ~covered
        covered[same] = _inside(solids, index, points[rows[same]] - step[same])
        seen[rows[covered]] = False
    return seen


def cover_boxes(
    solids: Solids,
    low: Float[np.ndarray, "N 3"],
    high: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    owners: Int[np.ndarray, "N"],
) -> tuple[Bool[np.ndarray, "N"], Bool[np.ndarray, "N"]]:
    """Pieces of surface that others of their part certainly hide, and pieces that need a test by points.

    Args:
        solids: The primitives.
        low: Lowest corners of the pieces' bounds (m), in ascending order of owner.
        high: Highest corners.
        normals: Outward unit normals.
        owners: Index of the primitive of each piece.
    """
    hidden, unsure = np.zeros(len(low), dtype=bool), np.zeros(len(low), dtype=bool)
    for index, close in _close_rows(
        solids, np.ascontiguousarray(low.T), np.ascontiguousarray(high.T), owners
    ):
        rows = close[~hidden[close]]
        middle, half, step = (
            (low[rows] + high[rows]) / 2,
            (high[rows] - low[rows]) / 2,
            EPSILON * normals[rows],
        )
        within, apart = _judge_boxes(solids, index, middle + step, half)
        later = np.flatnonzero(owners[rows] > index)
        behind, clear = _judge_boxes(solids, index, middle[later] - step[later], half[later])
        within[later] |= behind
        apart[later] &= clear
        hidden[rows] = within
        unsure[rows] |= ~(within | apart)
    return hidden, unsure & ~hidden


def _judge_boxes(
    solids: Solids, index: int, middle: Float[np.ndarray, "N 3"], half: Float[np.ndarray, "N 3"]
) -> tuple[Bool[np.ndarray, "N"], Bool[np.ndarray, "N"]]:
    """Masks of boxes that lie within a primitive, and of boxes that are certainly disjoint from it."""
    if solids.upright[index]:
        center, size = (
            (solids.low[index] + solids.high[index]) / 2,
            (solids.high[index] - solids.low[index]) / 2,
        )
        away = np.abs(middle - center) - size
        return (away < -half).all(axis=1), (away >= half).any(axis=1)
    primitive = solids.primitives[index]
    own = (middle - primitive.center) @ primitive.rotation
    if primitive.kind == "cylinder":
        reach = half @ np.abs(primitive.rotation)
        round_reach = np.hypot(reach[:, 0], reach[:, 1])
        aside = np.hypot(own[:, 0], own[:, 1]) - primitive.size[0] / 2
        along = np.abs(own[:, 2]) - primitive.size[2] / 2
        within = (aside < -round_reach) & (along < -reach[:, 2])
        return within, (aside >= round_reach) | (along >= reach[:, 2])
    normals = primitive.rotation @ primitive.planes[:, :3].T
    height, reach = own @ primitive.planes[:, :3].T + primitive.planes[:, 3], half @ np.abs(normals)
    return np.all(height < -reach, axis=1), np.any(height >= reach, axis=1)


def _close_rows(
    solids: Solids,
    low: Float[np.ndarray, "3 N"],
    high: Float[np.ndarray, "3 N"],
    owners: Int[np.ndarray, "N"],
) -> Iterator[tuple[int, Int[np.ndarray, "M"]]]:
    """For every primitive, the rows of others of its part that touch its bounds."""
    starts = np.searchsorted(owners, np.arange(len(solids.primitives) + 1))
    bottom, top = solids.low - EPSILON, solids.high + EPSILON
    for index, others in enumerate(_neighbours(solids)):
        spans = [np.arange(starts[k], starts[k + 1]) for k in np.flatnonzero(others)]
        rows = np.concatenate(spans) if spans else starts[:0]
        for axis in range(3):
            rows = rows[(high[axis, rows] >= bottom[index, axis]) & (low[axis, rows] <= top[index, axis])]
        if len(rows):
            yield index, rows


def _neighbours(solids: Solids) -> Bool[np.ndarray, "P P"]:
    """Mask of primitives of the same part that may touch, by their bounds."""
    low, high = solids.low - EPSILON, solids.high + EPSILON
    meet = np.all((low[:, None] <= high[None]) & (high[:, None] >= low[None]), axis=-1)
    meet &= solids.part_ids[:, None] == solids.part_ids[None]
    np.fill_diagonal(meet, val=False)
    return meet


def _inside(solids: Solids, index: int, points: Float[np.ndarray, "N 3"]) -> Bool[np.ndarray, "N"]:
    if solids.upright[index]:
        return np.all((points > solids.low[index]) & (points < solids.high[index]), axis=1)
    return contains(solids.primitives[index], points)
