"""Selects Gaussians and joins sets of them."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Int

from artigen.types import Gaussians


def select_gaussians(gaussians: Gaussians, rows: Int[np.ndarray, "M"] | Bool[np.ndarray, "N"]) -> Gaussians:
    """Selects the Gaussians of the given rows, in their order."""
    return Gaussians(**{name: value[rows] for name, value in vars(gaussians).items()})


def merge_gaussians(sets: Sequence[Gaussians]) -> Gaussians:
    """Concatenates sets of Gaussians; part ids are kept.

    Raises:
        ValueError: If there is no set.
    """
    if not sets:
        raise ValueError("merging Gaussians: no sets, expected at least 1")
    return Gaussians(**{name: np.concatenate([getattr(one, name) for one in sets]) for name in vars(sets[0])})
