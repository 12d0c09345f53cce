"""Neighbouring voxels and connected components."""

import numpy as np
from jaxtyping import Bool, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

HALF_NEIGHBOURHOOD = np.array(
    [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) > (0, 0, 0)]
)
"""One of each pair of opposite directions among the 26 neighbours."""


def neighbour_pairs(coords: Int[np.ndarray, "N 3"], resolution: int) -> Int[np.ndarray, "2 E"]:
    """Index pairs of voxels that share a face, an edge or a corner; every pair once."""
    index = np.full((resolution + 2,) * 3, -1, dtype=np.int32)
    index[tuple((coords + 1).T)] = np.arange(len(coords))
    strides = np.array([(resolution + 2) ** 2, resolution + 2, 1])
    flat = (coords.astype(np.int64) + 1) @ strides
    found = []
    for step in HALF_NEIGHBOURHOOD @ strides:
        other = index.ravel()[flat + step]
        mine = np.flatnonzero(other >= 0)
        found.append(np.stack([mine, other[mine]]))
    return np.concatenate(found, axis=1)


def connected_groups(
    count: int, pairs: Int[np.ndarray, "2 E"], linked: Bool[np.ndarray, "E"]
) -> Int[np.ndarray, "N"]:
    """Component number of each of ``count`` voxels when only the ``linked`` pairs hold together."""
    kept = pairs[:, linked]
    graph = coo_array((np.ones(kept.shape[1], dtype=bool), (kept[0], kept[1])), shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.int64)
