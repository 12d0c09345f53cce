"""Roughness of cells: how often their surface bends."""

from itertools import combinations

import numpy as np
from jaxtyping import Bool


def measure_roughness(occupied: Bool[np.ndarray, "X Y Z"]) -> float:
    """Edges at which the surface of the cells bends, over its faces; 0 where there is none.

    A cabinet has 0.1, a thing of many small parts or round ones 0.2 to 0.3.
    """
    padded = np.pad(occupied, 1).astype(np.int8)
    faces = sum(int(np.abs(np.diff(padded, axis=axis)).sum()) for axis in range(3))
    bends = sum(
        np.count_nonzero(np.diff(np.diff(padded, axis=one), axis=other))
        for one, other in combinations(range(3), 2)
    )
    return bends / max(faces, 1)
