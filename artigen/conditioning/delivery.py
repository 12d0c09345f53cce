"""Agreement of an object with the requested counts and size."""

import numpy as np
from jaxtyping import Float, Int

from artigen.types import PART_LABELS, Asset, PartLabel

SIZE_TOLERANCE = 0.05
"""Largest relative error of an extent that still counts as the size asked for."""


def part_counts(asset: Asset) -> Int[np.ndarray, "L"]:
    """Parts of each label, in the order of the part labels."""
    labels = [PART_LABELS.index(part.label) for part in asset.parts]
    return np.bincount(labels, minlength=len(PART_LABELS))


def asset_size(asset: Asset) -> Float[np.ndarray, "3"]:
    """Depth, width, height (m): the extent along x, y and z of the boxes of all parts at rest."""
    low = np.min([part.box[0] - part.box[1] / 2 for part in asset.parts], axis=0)
    high = np.max([part.box[0] + part.box[1] / 2 for part in asset.parts], axis=0)
    return (high - low) * asset.scale


def has_counts(asset: Asset, counts: tuple[tuple[PartLabel, int], ...]) -> bool:
    """Whether every count asked for is delivered exactly; labels that are not named are free."""
    held = part_counts(asset)
    return all(held[PART_LABELS.index(label)] == count for label, count in counts)


def size_error(asset: Asset, size: tuple[float, float, float]) -> float:
    """Largest relative error of depth, width and height against those asked for (m)."""
    wanted = np.asarray(size)
    return float((np.abs(asset_size(asset) - wanted) / wanted).max())
