"""All primitives of a shape in one table, and which points of their surfaces can be seen from outside.

A part is the union of its primitives: what lies inside another primitive of the same part, or between
two that touch, is no surface of it. Parts are separate things: they hide nothing of each other.
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
    """The primitives of a shape, part by part: bounds, owners, and which are boxes along the axes."""

    primitives: tuple[Primitive, ...]
    part_ids: Int[np.ndarray, "P"]
    low: Float[np.ndarray, "P 3"]
    high: Float[np.ndarray, "P 3"]
    upright: Bool[np.ndarray, "P"]
    """The solid is its bounding box."""


def list_solids(shape: Shape) -> Solids:
    """Collects the primitives of all parts in order."""
    primitives = tuple(primitive for part in shape.parts for primitive in part.primitives)
    counts = [len(part.primitives) for part in shape.parts]
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
        part_ids=np.repeat(np.arange(len(shape.parts)), counts),
        low=bounds[:, 0],
        high=bounds[:, 1],
        upright=np.array(upright),
    )


def primitive_bounds(primitive: Primitive) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner (m) of the exact solid: a round cylinder, not the prism for it."""
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
    """Which points (m, on the surface of their owner) lie on the surface of their part.

    Where two primitives have a face in common that looks the same way, the point of the first one counts.

    Args:
        solids: The primitives.
        points: Points on them, in ascending order of owner.
        normals: Outward unit normals.
        owners: Index of the primitive that each point lies on.
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


def may_be_covered(
    solids: Solids,
    low: Float[np.ndarray, "N 3"],
    high: Float[np.ndarray, "N 3"],
    owners: Int[np.ndarray, "N"],
) -> Bool[np.ndarray, "N"]:
    """Which boxes (m, in ascending order of owner) touch the bounds of another primitive of their part."""
    near = np.zeros(len(low), dtype=bool)
    columns = np.ascontiguousarray(low.T), np.ascontiguousarray(high.T)
    for _, close in _close_rows(solids, *columns, owners):
        near[close] = True
    return near


def _close_rows(
    solids: Solids,
    low: Float[np.ndarray, "3 N"],
    high: Float[np.ndarray, "3 N"],
    owners: Int[np.ndarray, "N"],
) -> Iterator[tuple[int, Int[np.ndarray, "M"]]]:
    """For every primitive the rows of its part, not its own, that touch its bounds."""
    starts = np.searchsorted(solids.part_ids[owners], np.arange(solids.part_ids[-1] + 2))
    for index in np.flatnonzero(_neighbours(solids).any(axis=1)):
        part = solids.part_ids[index]
        rows = slice(starts[part], starts[part + 1])
        near = owners[rows] != index
        for axis in range(3):
            near &= high[axis, rows] >= solids.low[index, axis] - EPSILON
            near &= low[axis, rows] <= solids.high[index, axis] + EPSILON
        yield int(index), starts[part] + np.flatnonzero(near)


def _neighbours(solids: Solids) -> Bool[np.ndarray, "P P"]:
    """Which other primitives of its part each one may touch, by their bounds."""
    low, high = solids.low - EPSILON, solids.high + EPSILON
    meet = np.all((low[:, None] <= high[None]) & (high[:, None] >= low[None]), axis=-1)
    meet &= solids.part_ids[:, None] == solids.part_ids[None]
    np.fill_diagonal(meet, val=False)
    return meet


def _inside(solids: Solids, index: int, points: Float[np.ndarray, "N 3"]) -> Bool[np.ndarray, "N"]:
    if solids.upright[index]:
        return np.all((points > solids.low[index]) & (points < solids.high[index]), axis=1)
    return contains(solids.primitives[index], points)
