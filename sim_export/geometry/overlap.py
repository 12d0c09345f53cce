"""How much of one link's volume gets into another."""

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from sim_export.geometry.contacts import Distances, HullSet
from sim_export.geometry.hulls import inside_hulls

SAMPLES = 1500
"""Points in a link's volume, about."""
TOUCH = 1e-4
"""Penetration (m) below which the overlapping volume is ignored."""


def swept_overlap(
    mover: HullSet,
    other: HullSet,
    T_mover: Float[np.ndarray, "*P 4 4"],
    T_other: Float[np.ndarray, "*P 4 4"],
    found: Distances,
) -> float:
    """Share of the mover's volume that is inside the other link at some pose but not at rest."""
    points = volume_samples(mover, SAMPLES)
    T = inverse(T_other) @ T_mover
    poses = np.unique(found.pose[found.distance < -TOUCH])
    entered = np.zeros(len(points), dtype=bool)
    for pose in poses:
        touched = np.unique(found.second[(found.pose == pose) & (found.distance < -TOUCH)])
        hulls = tuple(other.hulls[index] for index in touched)
        entered |= inside_hulls(transform_points(T[pose] if T.ndim == 3 else T, points), hulls)
    return float(np.mean(entered & ~inside_hulls(points, other.hulls)))


def volume_samples(hulls: HullSet, count: int) -> Float[np.ndarray, "N 3"]:
    """About ``count`` evenly spread points in the union of hulls; deterministic."""
    low, high = hulls.vertices.min(axis=0), hulls.vertices.max(axis=0)
    from scipy.stats.qmc import Sobol

    trial = low + Sobol(3, scramble=False).random(1024) * (high - low)
    filled = max(float(inside_hulls(trial, hulls.hulls).mean()), 1.0 / 64.0)
    needed = 2 ** int(np.ceil(np.log2(count / filled)))
    points = low + Sobol(3, scramble=False).random(needed) * (high - low)
    return points[inside_hulls(points, hulls.hulls)]
