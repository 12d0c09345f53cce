"""Agreement of an object with the requested counts and size."""

import numpy as np
from jaxtyping import Float, Int

from artigen.types import PART_LABELS, Asset, PartLabel

SIZE_TOLERANCE = 0.05
"""Largest relative error of an extent that still counts as the requested size."""


def part_counts(asset: Asset) -> Int[np.ndarray, "L"]:
    """Number of parts of each label, in the order of the part labels."""
    labels = [PART_LABELS.index(part.label) for part in asset.parts]
    return np.bincount(labels, minlength=len(PART_LABELS))


def asset_bounds(asset: Asset) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner of the boxes of all parts at rest, in unit-cube lengths."""
    low = np.min([part.box[0] - part.box[1] / 2 for part in asset.parts], axis=0)
    high = np.max([part.box[0] + part.box[1] / 2 for part in asset.parts], axis=0)
    return np.stack([low, high])


def asset_size(asset: Asset) -> Float[np.ndarray, "3"]:
    """Depth, width, height (m): the extent of the boxes of all parts at rest along x, y and z."""
    return np.ptp(asset_bounds(asset), axis=0) * asset.scale


def has_counts(asset: Asset, counts: tuple[tuple[PartLabel, int], ...]) -> bool:
    """Whether every requested count is met exactly; labels that are not named are free."""
    held = part_counts(asset)
    return all(held[PART_LABELS.index(label)] == count for label, count in counts)


def size_error(asset: Asset, size: tuple[float, float, float]) -> float:
    """Largest relative error of depth, width and height from the requested ones (m)."""
    wanted = np.asarray(size)
    return float((np.abs(asset_size(asset) - wanted) / wanted).max())
