"""Roughness of occupied cells: bends of their surface per face."""

from itertools import combinations

import numpy as np
from jaxtyping import Bool


def measure_roughness(occupied: Bool[np.ndarray, "X Y Z"]) -> float:
    """Number of edges at which the surface of the cells bends, divided by its number of faces; 0 if empty.

    A cabinet has about 0.1, an object of many small or round parts 0.2 to 0.3.
    """
    padded = np.pad(occupied, 1).astype(np.int8)
    faces = sum(int(np.abs(np.diff(padded, axis=axis)).sum()) for axis in range(3))
    bends = sum(
        np.count_nonzero(np.diff(np.diff(padded, axis=one), axis=other))
        for one, other in combinations(range(3), 2)
    )
    return bends / max(faces, 1)
