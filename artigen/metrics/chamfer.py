"""Chamfer distance between point clouds: the mean squared distance there plus the one back."""

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree


def chamfer(first: Float[np.ndarray, "N 3"], second: Float[np.ndarray, "M 3"]) -> float:
    """``mean_a min_b |a - b|^2 + mean_b min_a |a - b|^2``, in squared units of the points.

    Sum and squares are as in pytorch3d, with which the published numbers were computed (SINGAPO
    ``metrics/cd.py``, Particulate ``evaluation_utils.py``).

    Raises:
        ValueError: If a cloud is empty.
    """
    if not len(first) or not len(second):
        raise ValueError(f"clouds of {len(first)} and {len(second)} points, expected some in both")
    there = KDTree(second).query(first)[0]
    back = KDTree(first).query(second)[0]
    return float(np.mean(there**2) + np.mean(back**2))
