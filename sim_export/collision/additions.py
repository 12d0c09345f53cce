"""Adds a hull to a link late in the export, clear of every sweep."""

from collections.abc import Sequence

import numpy as np

from sim_export.collision.contacts import HullSet, signed_distances
from sim_export.collision.hull_limits import MAX_ASPECT, MAX_VERTICES, MOST_OF_LINK, hull_aspect
from sim_export.collision.hulls import convex_hull
from sim_export.collision.sweeps import Sweep
from sim_export.package import Hull

GAP = 2e-4
"""What stays free (m) around an added hull; engines push apart what touches, however little."""
TOLERANCE = 2e-5
"""Depth (m) to which a stretched hull may enter another link; it may have touched that before."""


def add_hull(
    sets: Sequence[HullSet],
    sweeps: Sequence[Sweep],
    slot: int,
    addition: Hull,
    stand: Hull,
) -> HullSet | None:
    """The hulls of link ``slot`` with one more, or ``None`` if that is in some link's way.

    ``stand`` is the hull that is stretched over ``addition`` where the link has `MOST_OF_LINK`.
    """
    hulls, least = [*sets[slot].hulls, addition], GAP
    if len(hulls) > MOST_OF_LINK:
        addition = convex_hull(np.concatenate([stand.vertices, addition.vertices]))
        hulls, least = [addition if hull is stand else hull for hull in sets[slot].hulls], -TOLERANCE
    fits = len(addition.vertices) <= MAX_VERTICES and hull_aspect(addition) <= MAX_ASPECT
    if not fits or not is_free(addition, slot, sets, sweeps, least):
        return None
    return HullSet(hulls=tuple(hulls))


def is_free(hull: Hull, slot: int, sets: Sequence[HullSet], sweeps: Sequence[Sweep], least: float) -> bool:
    """Whether a hull of link ``slot`` stays ``least`` (m) from all others, at rest and in every sweep."""
    alone, still = HullSet(hulls=(hull,)), np.eye(4)
    others = [index for index in range(len(sets)) if index != slot and sets[index].hulls]
    poses = [(other, still, still) for other in others]
    for sweep in sweeps:
        apart = [other for other in others if (slot in sweep.moved) != (other in sweep.moved)]
        poses += [(other, sweep.T[:, slot], sweep.T[:, other]) for other in apart]
    for other, T_hull, T_other in poses:
        found = signed_distances(alone, sets[other], T_hull, T_other, max(least, 0.0))
        if len(found.distance) and found.distance.min() < least:
            return False
    return True
