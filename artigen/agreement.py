"""Voxels of one surface agree on what they are: those that are unsure follow the sure ones around them.

Choices made voxel by voxel fray where two are as good as each other: half of a door would be blue. Seen
logits are kept where they are clear, and filled in between as heat would spread (the random walker of Grady,
"Random Walks for Image Segmentation", 2006, with a datum at every voxel).
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array, diags_array
from scipy.sparse.linalg import splu

from artigen.facings import mark_voxels

HOLD, LEAST = 10.0, 1e-3
"""How much a voxel that is certain holds on to that beside a neighbour's say, and one that knows nothing."""
CERTAIN = 6
"""Power of the margin between its two best classes that a voxel's hold grows with."""
TEMPER = 4.0
"""What logits are divided by before they say how sure a voxel is: on drawn voxels, networks are too sure."""


def find_edges(
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    resolution: int,
) -> Int[np.ndarray, "E 2"]:
    """Pairs of voxels that share a face, a part, and the direction of their outer sides.

    Args:
        coords: Cells (x, y, z) of the grid, each at most once.
        part_ids: Part of each.
        facings: Directions of their outer sides (`artigen.facings`).
        resolution: Edge of the grid.
    """
    grid = np.pad(mark_voxels(coords, np.arange(len(coords)), resolution), (0, 1), constant_values=-1)
    pairs = []
    for axis in range(3):
        step = np.eye(3, dtype=np.int64)[axis]
        other = grid[tuple((coords.astype(np.int64) + step).T)]
        (one,) = np.nonzero(other >= 0)
        other = other[one]
        alike = (part_ids[one] == part_ids[other]) & (facings[one] == facings[other])
        pairs.append(np.stack([one[alike], other[alike]], axis=1))
    return np.concatenate(pairs)


def spread_sureness(
    logits: Float[np.ndarray, "N K"], edges: Int[np.ndarray, "E 2"]
) -> Float[np.ndarray, "N K"]:
    """Logits of classes after neighbours have agreed: least squares of what each voxel says, weighted by how
    sure it is, and of the differences of neighbours.

    Args:
        logits: Of two classes or more.
        edges: Pairs of neighbours.
    """
    logits = logits - logits.mean(axis=1, keepdims=True)
    chances = np.exp((logits - logits.max(axis=1, keepdims=True)) / TEMPER)
    best = np.sort(chances / chances.sum(axis=1, keepdims=True), axis=1)
    sure = HOLD * (best[:, -1] - best[:, -2]) ** CERTAIN + LEAST
    count = len(logits)
    ones = np.ones(len(edges))
    links = coo_array((ones, (edges[:, 0], edges[:, 1])), shape=(count, count)).tocsc()
    links = links + links.T
    system = diags_array(sure + links.sum(axis=1)) - links
    return splu(system.tocsc()).solve(sure[:, None] * logits)
