"""Pieces of a surface, or hulls, that are apart from the rest of their link: distances by single linkage."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float, Int

from sim_export.geometry.contacts import HullSet
from sim_export.geometry.grid import Grid, find_outside, make_grid, mark_surface
from sim_export.geometry.rows import connect_rows, number_rows
from sim_export.geometry.triangles import bounds_of, meet_box

if TYPE_CHECKING:
    import coal

# coal is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

Distance = Callable[[int, int], float]
CELLS = 128
"""Cells along the longest edge of a link, to find out what it encloses."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SurfaceIsland:
    """A piece of a surface, ``gap`` (m) from what is nearer to the largest piece."""

    gap: float
    triangles: Float[np.ndarray, "F 3 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Island:
    """Things that hold together, ``gap`` (m) from the rest."""

    gap: float
    members: Int[np.ndarray, "M"]


def visual_islands(
    triangles: Float[np.ndarray, "F 3 3"], reach: float, floor: float = -np.inf
) -> list[tuple[float, int]]:
    """Pieces of a surface farther than ``reach`` (m) from the rest: distance (m) and count of faces of each.

    Posts do not count: pieces that reach from the height ``floor`` (m) up to half of the surface or more.
    """
    islands = find_surface_islands(triangles, reach)[1]
    return [
        (island.gap, len(island.triangles))
        for island in islands
        if island.triangles[..., 2].min() > floor
        or 2.0 * island.triangles[..., 2].max() < floor + triangles[..., 2].max()
    ]


def find_surface_islands(
    triangles: Float[np.ndarray, "F 3 3"], reach: float
) -> tuple[Float[np.ndarray, "G 3 3"], list[SurfaceIsland]]:
    """The largest piece of a surface, and those farther than ``reach`` (m) from it and each other.

    Pieces that the largest encloses, such as the walls of a void, are not seen and do not count.
    """
    if not len(triangles):
        return triangles, []
    piece = join_near(triangles, connected_pieces(triangles), reach)
    pieces = split_groups(triangles, piece)
    bounds = np.array([_bounds(piece) for piece in pieces])
    shapes = cache(lambda index: surface_shape(pieces[index]))
    extents = np.linalg.norm(bounds[:, 1] - bounds[:, 0], axis=1)
    found = find_islands(bounds, lambda one, other: _distance(shapes(one), shapes(other)), extents, reach)
    if not found:
        return triangles, []
    apart = np.concatenate([island.members for island in found])
    main = np.concatenate([pieces[k] for k in range(len(pieces)) if k not in apart])
    grid = make_grid(_bounds(triangles), CELLS)
    outside = find_outside(mark_surface(main, grid))
    islands = [
        SurfaceIsland(gap=island.gap, triangles=np.concatenate([pieces[k] for k in island.members]))
        for island in found
    ]
    return main, [island for island in islands if is_reached(island.triangles, outside, grid)]


def is_reached(triangles: Float[np.ndarray, "F 3 3"], free: Bool[np.ndarray, "X Y Z"], grid: Grid) -> bool:
    """Whether the middle or a corner of some triangle lies in a free cell."""
    points = np.concatenate([triangles.mean(axis=1), triangles.reshape(-1, 3)])
    return bool(free[tuple(grid.cells_of(points).T)].any())


def hull_islands(
    hulls: HullSet, triangles: Float[np.ndarray, "F 3 3"], reach: float
) -> list[tuple[float, int]]:
    """Hulls farther than ``reach`` from all that is seen of a link and from its other hulls.

    A hull at the surface that it stands for does not float, though the next one may be far: how well hulls
    cover a surface is not judged here.

    Args:
        triangles: What is seen of it.
        reach: Farthest that a hull may be from the rest (m).
    """
    count = len(hulls.hulls)
    if not count:
        return []
    shown = cache(lambda: surface_shape(triangles))

    def distance(one: int, other: int) -> float:
        if other < count:
            return _distance(hulls.shapes[one], hulls.shapes[other])
        low, high = hulls.rest_bounds[one, 0] - reach, hulls.rest_bounds[one, 1] + reach
        near = meet_box(triangles, low, high)
        found = _distance(hulls.shapes[one], surface_shape(triangles[near])) if near.any() else np.inf
        return found if found <= reach else _distance(hulls.shapes[one], shown())

    bounds = hulls.rest_bounds
    ranks = np.linalg.norm(bounds[:, 1] - bounds[:, 0], axis=1)
    if len(triangles):  # what is seen comes before all hulls
        bounds, ranks = np.concatenate([bounds, _bounds(triangles)[None]]), np.append(ranks, np.inf)
    return [(island.gap, len(island.members)) for island in find_islands(bounds, distance, ranks, reach)]


def _bounds(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "2 3"]:
    return bounds_of(triangles.reshape(-1, 3))


def _distance(first: object, second: object) -> float:
    """Distance (m) of two coal shapes, 0 where they overlap."""
    return _measure(first, second)[0]


def nearest_points(first: object, second: object) -> tuple[float, Float[np.ndarray, "2 3"]]:
    """Distance (m) of two surfaces (`surface_shape`), 0 where they meet, and the nearest point of each."""
    gap, result = _measure(first, second)
    return gap, np.stack([np.ravel(result.getNearestPoint1()), np.ravel(result.getNearestPoint2())])


def _measure(first: object, second: object) -> "tuple[float, coal.DistanceResult]":
    import coal

    request, still, result = coal.DistanceRequest(), coal.Transform3s(), coal.DistanceResult()
    request.enable_signed_distance = False
    return max(0.0, float(coal.distance(first, still, second, still, request, result))), result


def find_islands(
    bounds: Float[np.ndarray, "N 2 3"], distance: Distance, ranks: Float[np.ndarray, "N"], reach: float
) -> list[Island]:
    """Groups of things that nothing within ``reach`` connects to the main group, that of the highest rank.

    Things hold together by single linkage; the gap of a group is the width that the shortest bridges to the
    main group ask for.

    Args:
        bounds: Lowest and highest corner of every thing.
        distance: Exact distance of two of them (m).
        reach: Farthest that things may be apart and still hold together (m).
    """
    groups = np.arange(len(bounds))
    for first, second, _ in _near_pairs(bounds, reach):
        if groups[first] != groups[second] and distance(first, second) <= reach:
            groups[groups == groups[second]] = groups[first]
    names = np.unique(groups)
    if len(names) == 1:
        return []
    members = [np.flatnonzero(groups == name) for name in names]
    main = next(index for index, own in enumerate(members) if ranks.argmax() in own)
    gaps = np.full((len(names), len(names)), np.inf)
    row = {name: index for index, name in enumerate(names.tolist())}
    for first, second, apart in _near_pairs(bounds, np.inf):
        a, b = row[int(groups[first])], row[int(groups[second])]
        if a != b and apart < gaps[a, b]:
            gaps[a, b] = gaps[b, a] = min(gaps[a, b], distance(first, second))
    return [Island(gap=gap, members=members[index]) for gap, index in _bridge(gaps, main)]


def _bridge(gaps: Float[np.ndarray, "G G"], main: int) -> list[tuple[float, int]]:
    """Bridges of groups to the main one, shortest first (Prim): width, and which group."""
    joined = np.arange(len(gaps)) == main
    out = []
    while not joined.all():
        rest = np.where(joined[:, None] & ~joined[None], gaps, np.inf)
        _, column = np.unravel_index(int(rest.argmin()), rest.shape)
        out.append((float(rest[:, column].min()), int(column)))
        joined[column] = True
    return out


def _near_pairs(bounds: Float[np.ndarray, "N 2 3"], reach: float) -> Iterator[tuple[int, int, float]]:
    """Pairs of boxes within ``reach``, nearest first, with the distance of the boxes."""
    low, high = bounds[:, 0], bounds[:, 1]
    between = np.maximum(0.0, np.maximum(low[:, None] - high[None], low[None] - high[:, None]))
    apart = np.linalg.norm(between, axis=2)
    first, second = np.nonzero(np.triu(apart <= reach, k=1))
    for index in np.argsort(apart[first, second], kind="stable"):
        yield int(first[index]), int(second[index]), float(apart[first[index], second[index]])


def connected_pieces(triangles: Float[np.ndarray, "F 3 3"]) -> Int[np.ndarray, "F"]:
    """Number of the connected piece of every face; corners in the same place, to a micrometre, are one."""
    return connect_corners(np.round(triangles.reshape(-1, 3) * 1e6).astype(np.int64))


def connect_corners(places: Int[np.ndarray, "C 3"]) -> Int[np.ndarray, "F"]:
    """Number of the connected piece of every face; its corners are three rows, and equal rows are one."""
    first, corner = number_rows(places)
    faces = corner.reshape(-1, 3)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    return connect_rows(edges.T, len(first))[faces[:, 0]]


def split_groups(
    triangles: Float[np.ndarray, "F 3 3"], group: Int[np.ndarray, "F"]
) -> list[Float[np.ndarray, "G 3 3"]]:
    """The triangles of every group, in the order of their numbers."""
    order = np.argsort(group, kind="stable")
    return np.split(triangles[order], np.flatnonzero(np.diff(group[order])) + 1)


def join_near(
    triangles: Float[np.ndarray, "F 3 3"], piece: Int[np.ndarray, "F"], reach: float
) -> Int[np.ndarray, "F"]:
    """Pieces that have corners in one cell with a diagonal of ``reach`` as one: quick, and never too many."""
    if not reach > 0.0:
        return piece
    cells = np.floor(triangles.reshape(-1, 3) * (np.sqrt(3.0) / reach)).astype(np.int64)
    _, cell = number_rows(cells)
    count = int(piece.max()) + 1
    pairs = np.stack([np.repeat(piece, 3), count + cell])
    return connect_rows(pairs, count + int(cell.max()) + 1)[piece]


def surface_shape(triangles: Float[np.ndarray, "F 3 3"]) -> object:
    """A tree of triangles, for exact distances between surfaces."""
    import coal

    shape = coal.BVHModelOBBRSS()
    shape.beginModel(len(triangles), 3 * len(triangles))
    shape.addVertices(triangles.reshape(-1, 3))
    shape.addTriangles(np.arange(3 * len(triangles)).reshape(-1, 3))
    shape.endModel()
    return shape
