"""The paper's recipe: part semantics, then DBSCAN on the box attributes (paper section 3.3)."""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from artigen.types import PART_LABELS
from artigen.voxels.fields import VoxelFields
from artigen.voxels.segmentation.partition import Partition, canonical_partition

EPS = 0.08
"""Neighbourhood radius in the six box attributes, unit lengths. Larger merges neighbouring
drawers, smaller splits parts with noisy votes."""
MIN_SAMPLES = 5
"""Voxels within ``eps`` that make a dense core (scikit-learn's default)."""
MAX_ROWS = 3000
"""Most distinct box votes clustered per label; of more, an even selection is clustered and the
others join the nearest. Bounds time and memory, which grow with the square."""


def partition_paper(fields: VoxelFields) -> Partition:
    """Semantic label by the largest probability, instances by DBSCAN; the base is one part.

    DBSCAN's outliers join the cluster with the nearest vote (the paper does not say); a label with
    outliers only is one part.
    """
    labels = fields.label_probs.argmax(axis=1)
    instances = np.zeros(len(labels), dtype=np.int64)
    base = PART_LABELS.index("base")
    for label in np.unique(labels):
        if label != base:
            rows = np.flatnonzero(labels == label)
            instances[rows] = _cluster_boxes(fields.box[rows])
    (kinds, _), groups = np.unique([labels, instances], axis=1, return_inverse=True)
    return canonical_partition(fields, groups.ravel(), kinds)


def _cluster_boxes(boxes: Float[np.ndarray, "n 6"]) -> Int[np.ndarray, "n"]:
    """DBSCAN cluster of each row, counting equal rows with their multiplicity."""
    from sklearn.cluster import DBSCAN

    votes, which, weights = np.unique(boxes, axis=0, return_inverse=True, return_counts=True)
    step = max(1, -(-len(votes) // MAX_ROWS))
    chosen = np.arange(0, len(votes), step)
    clusters = DBSCAN(eps=EPS, min_samples=max(1, MIN_SAMPLES)).fit_predict(
        votes[chosen], sample_weight=weights[chosen] * step
    )
    dense = chosen[clusters >= 0]
    if len(dense) == 0:
        return np.zeros(len(boxes), dtype=np.int64)
    nearest = KDTree(votes[dense]).query(votes)[1]
    return clusters[clusters >= 0][nearest][which.ravel()].astype(np.int64)
