"""Connected regions of voxels: faces (one part, one direction) and the shapes on them.

Windows, trims and panels are rectangles, or discs on round doors.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_fill_holes
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from artigen.voxels.cleanup.boxes import fill_boxes, find_boxes
from artigen.voxels.frames import mark_voxels

ROUND = 8
"""Least width in cells of a face that can count as round."""


def find_edges(
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    resolution: int,
) -> Int[np.ndarray, "2 E"]:
    """Pairs of voxels that share a face, a part, and the direction of their outer sides."""
    grid = np.pad(mark_voxels(coords, np.arange(len(coords)), resolution), (0, 1), constant_values=-1)
    pairs = []
    for axis in range(3):
        step = np.eye(3, dtype=np.int64)[axis]
        other = grid[tuple((coords.astype(np.int64) + step).T)]
        (one,) = np.nonzero(other >= 0)
        other = other[one]
        alike = (part_ids[one] == part_ids[other]) & (facings[one] == facings[other])
        pairs.append(np.stack([one[alike], other[alike]]))
    return np.concatenate(pairs, axis=1)


def connected_groups(count: int, pairs: Int[np.ndarray, "2 E"]) -> Int[np.ndarray, "N"]:
    """Number of the connected component of each of ``count`` things, of which pairs hold together."""
    graph = coo_array((np.ones(pairs.shape[1], dtype=bool), (pairs[0], pairs[1])), shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def is_round(face: Bool[np.ndarray, "H W"]) -> bool:
    """Whether the inscribed ellipse matches the outline of a face better than its rectangle does."""
    whole, disc = np.asarray(binary_fill_holes(face)), draw_ellipse(*face.shape)
    alike = (whole & disc).sum() / (whole | disc).sum()
    return min(face.shape) >= ROUND and alike > whole.mean()


def draw_ellipse(height: int, width: int) -> Bool[np.ndarray, "H W"]:
    """The cells of a rectangle whose centres lie in the inscribed ellipse."""
    y, z = (np.linspace(-1, 1, 2 * count + 1)[1::2] for count in (height, width))
    return y[:, None] ** 2 + z[None] ** 2 <= 1.0


def find_rectangles(evidence: Float[np.ndarray, "H W"], least: float) -> Bool[np.ndarray, "H W"]:
    """The cells of the rectangles that hold enough evidence."""
    return fill_boxes((*evidence.shape, 1), find_boxes(evidence[..., None], least))[..., 0]
