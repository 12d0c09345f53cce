"""Leaves out tiny hulls that stand for nothing but the skin of a larger hull of their link.

PhysX cannot be trusted with hulls of a few millimetres: its persistent contact manifolds report pairs that
are 4 mm apart as 10 mm inside each other, and doors jam. The fewer of them pass by each other, the better.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from sim_export.checks.surface import triangle_distances
from sim_export.collision.hulls import hull_length, hull_planes
from sim_export.package import Hull

LONGEST = 0.015
"""Hulls up to this long, over the object's diagonal, may be left out."""
NEAR = 0.004
"""How far (m) they may stand out of one hull that stays. Check V107 takes 5 mm for a gap."""
NEAR_SHARE = 0.005
"""The same over the object's diagonal, where that is less; a third of what check V103 allows 99 % of a
surface."""


def drop_specks(hulls: Sequence[Hull], diagonal: float) -> tuple[Hull, ...]:
    """The hulls of a link without those that are tiny and close to one that stays.

    Args:
        hulls: All hulls of the link.
        diagonal: That of the box around the whole object (m).
    """
    reach = min(NEAR, NEAR_SHARE * diagonal)
    kept: list[Hull] = []
    for hull in sorted(hulls, key=lambda hull: -hull_length(hull)[0]):
        tiny = hull_length(hull)[0] <= LONGEST * diagonal
        if not (tiny and any(_holds(other, hull.vertices, reach) for other in kept)):
            kept.append(hull)
    stays = {id(hull) for hull in kept}
    return tuple(hull for hull in hulls if id(hull) in stays)


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
