"""Leaves out tiny hulls that stand for nothing but the skin of a larger hull of their link.

PhysX cannot be trusted with hulls of a few millimetres: its persistent contact manifolds report pairs that
are 4 mm apart as 10 mm inside each other, and doors jam. The fewer of them pass by each other, the better.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from sim_export.geometry.contacts import HullSet
from sim_export.geometry.distances import triangle_distances
from sim_export.geometry.hulls import hull_length, hull_planes
from sim_export.geometry.islands import find_islands, nearest_points
from sim_export.package import Hull

LONGEST = 0.015
"""Hulls up to this long, over the object's diagonal, may be left out."""
NEAR = 0.004
"""How far (m) they may stand out of one hull that stays."""
NEAR_SHARE = 0.005
"""The same over the object's diagonal, where that is less; a third of what check V103 allows 99 % of a
surface."""
JOINED = 0.005
"""Hulls within this distance (m) hold together, as in check V107."""


def drop_specks(hulls: Sequence[Hull], diagonal: float) -> tuple[Hull, ...]:
    """The hulls of a link without those that are tiny and close to one that stays.

    What holds other hulls of the link together stays, too.

    Args:
        diagonal: That of the box around the whole object (m).
    """
    reach = min(NEAR, NEAR_SHARE * diagonal)
    lengths = np.array([hull_length(hull)[0] for hull in hulls])
    kept: list[int] = []
    specks: list[int] = []
    for index in np.argsort(-lengths, kind="stable").tolist():
        tiny = lengths[index] <= LONGEST * diagonal
        speck = tiny and any(_holds(hulls[other], hulls[index].vertices, reach) for other in kept)
        (specks if speck else kept).append(index)
    if not specks:
        return tuple(hulls)
    kept += _find_bridges(HullSet(hulls=tuple(hulls)), kept, specks)
    return tuple(hulls[index] for index in sorted(kept))


def _find_bridges(hulls: HullSet, kept: Sequence[int], specks: Sequence[int]) -> list[int]:
    """Those of the ``specks`` without which some of the other hulls would be apart."""

    def distance(one: int, other: int) -> float:
        return nearest_points(hulls.shapes[one], hulls.shapes[other])[0]

    bounds = hulls.rest_bounds[list(kept)]
    extents = np.linalg.norm(bounds[:, 1] - bounds[:, 0], axis=1)
    islands = find_islands(bounds, lambda i, j: distance(kept[i], kept[j]), extents, JOINED)
    if not islands:
        return []
    group = np.zeros(len(kept), dtype=int)
    for number, island in enumerate(islands):
        group[island.members] = number + 1
    bridges = []
    for speck in specks:
        touched = [group[k] for k, other in enumerate(kept) if distance(speck, other) <= JOINED]
        if len(set(touched)) > 1:
            bridges.append(speck)
            group[np.isin(group, touched)] = touched[0]
    return bridges


def _holds(hull: Hull, points: Float[np.ndarray, "N 3"], reach: float) -> bool:
    """Whether all points lie in a hull, or within ``reach`` (m) of it."""
    low, high = hull.vertices.min(axis=0) - reach, hull.vertices.max(axis=0) + reach
    if (points < low).any() or (points > high).any():
        return False
    planes = hull_planes(hull)
    outside = points[(points @ planes[:, :3].T > planes[:, 3]).any(axis=1)]
    triangles = hull.vertices[hull.faces]
    pairs = np.repeat(outside, len(triangles), axis=0), np.tile(triangles, (len(outside), 1, 1))
    return bool((triangle_distances(*pairs).reshape(-1, len(triangles)).min(axis=1) <= reach).all())
