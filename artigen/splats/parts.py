"""Splits Gaussians by part and joins sets of them."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np
from jaxtyping import Bool, Int

from artigen.types import Gaussians


def select_gaussians(gaussians: Gaussians, rows: Int[np.ndarray, "M"] | Bool[np.ndarray, "N"]) -> Gaussians:
    """Selects the Gaussians of the given rows, in their order."""
    return Gaussians(**{field.name: getattr(gaussians, field.name)[rows] for field in fields(Gaussians)})


def split_gaussians(gaussians: Gaussians, count: int) -> tuple[Gaussians, ...]:
    """One set per part id from 0 to ``count - 1``, each in the order of the rows; sets may be empty.

    Raises:
        ValueError: If there are other part ids.
    """
    ids = gaussians.part_ids
    if len(ids) and (ids.min() < 0 or ids.max() >= count):
        raise ValueError(f"Gaussian part ids span {ids.min()}..{ids.max()}, parts are 0..{count - 1}")
    return tuple(select_gaussians(gaussians, ids == part) for part in range(count))


def merge_gaussians(sets: Sequence[Gaussians]) -> Gaussians:
    """All of them, one set after the other; part ids are kept.

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
