"""Boxes in pictures: left, top, right, bottom."""

import numpy as np
from jaxtyping import Float


def overlap_boxes(
    first: Float[np.ndarray, "N 4"], last: Float[np.ndarray, "M 4"]
) -> Float[np.ndarray, "N M"]:
    """Intersection over union of every pair of boxes."""
    low = np.maximum(first[:, None, :2], last[None, :, :2])
    high = np.minimum(first[:, None, 2:], last[None, :, 2:])
    shared = np.clip(high - low, 0.0, None).prod(axis=-1)
    areas = [np.clip(boxes[:, 2:] - boxes[:, :2], 0.0, None).prod(axis=-1) for boxes in (first, last)]
    return shared / np.maximum(areas[0][:, None] + areas[1][None] - shared, 1e-12)
