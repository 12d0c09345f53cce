"""Selects Gaussians and joins sets of them."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np
from jaxtyping import Bool, Int

from artigen.types import Gaussians


def select_gaussians(gaussians: Gaussians, rows: Int[np.ndarray, "M"] | Bool[np.ndarray, "N"]) -> Gaussians:
    """Selects the Gaussians of the given rows, in their order."""
    return Gaussians(**{field.name: getattr(gaussians, field.name)[rows] for field in fields(Gaussians)})


def merge_gaussians(sets: Sequence[Gaussians]) -> Gaussians:
    """Concatenates sets of Gaussians; part ids are kept.

    Raises:
        ValueError: If there is no set.
    """
    if not sets:
        raise ValueError("merging Gaussians: no sets, expected at least 1")
    return Gaussians(
        **{
            field.name: np.concatenate([getattr(one, field.name) for one in sets])
            for field in fields(Gaussians)
        }
    )
