"""Distances between two sets of objects, from pairwise distances: MMD, COV and 1-NNA.

After PointFlow (and NAP's ``compute_metrics.ipynb``); the distance is `artigen.metrics.instantiation`'s.
"""

import numpy as np
from jaxtyping import Float


def minimum_matching_distance(cross: Float[np.ndarray, "G R"]) -> float:
    """MMD: mean over reference objects of the distance to the nearest generated one; lower is better."""
    return float(_filled(cross).min(axis=0).mean())


def coverage(cross: Float[np.ndarray, "G R"]) -> float:
    """COV: share of reference objects that are nearest to some generated one; 1 is best."""
    return len(np.unique(_filled(cross).argmin(axis=1))) / cross.shape[1]


def nearest_neighbour_accuracy(
    cross: Float[np.ndarray, "G R"],
    generated: Float[np.ndarray, "G G"],
    reference: Float[np.ndarray, "R R"],
) -> float:
    """1-NNA: share of objects whose nearest neighbour among all others is of their own set.

    0.5 is perfect for sets of equal size (they cannot be told apart), 1 means disjoint sets; below 0.5,
    generated objects sit on reference objects. Equal distances count half.

    Args:
        cross: Distances of generated to reference objects.
        generated: Among generated objects; the diagonal is not read.
        reference: Among reference objects; the diagonal is not read.
    """
    _filled(cross)
    if min(cross.shape) < 2:
        raise ValueError(f"sets of {cross.shape[0]} and {cross.shape[1]} objects, expected two in each")
    hits = []
    for own, other in ((generated, cross), (reference, cross.T)):
        away = own + np.diag(np.full(len(own), np.inf))
        near, far = away.min(axis=1), other.min(axis=1)
        hits.append(np.where(near < far, 1.0, np.where(near == far, 0.5, 0.0)))
    return float(np.concatenate(hits).mean())


def _filled(cross: Float[np.ndarray, "G R"]) -> Float[np.ndarray, "G R"]:
    if not cross.size:
        raise ValueError(f"sets of {cross.shape[0]} and {cross.shape[1]} objects, expected some in both")
    return cross
