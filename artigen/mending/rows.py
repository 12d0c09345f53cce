"""Cells that say the rows of an outline: which part each belongs to, and fields made of such cells."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int

from artigen.fields import VoxelFields, after_occupancy

Owners = Int[np.ndarray, "X Y Z"]
"""The row of an outline that every cell belongs to; -1 where nothing is."""


def read_owners(found: VoxelFields, rows: Float[np.ndarray, "N C"]) -> Owners:
    """The row whose box every occupied cell says, or says most nearly; -1 where nothing is."""
    layout = found.layout
    box = rows[:, after_occupancy(layout.box)]
    owners = np.full((found.resolution,) * 3, -1)
    if len(found.coords):
        off = np.abs(found.box[:, None] - box[None]).max(axis=2)
        owners[tuple(found.coords.T)] = off.argmin(axis=1)
    return owners


def fields_of_owners(owners: Owners, rows: Float[np.ndarray, "N C"], like: VoxelFields) -> VoxelFields:
    """Fields in which every cell says the row of its owner.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: the channels after occupancy, one row per part.
        like: fields of the same layout and resolution.
    """
    coords, layout = np.argwhere(owners >= 0), like.layout
    said = rows[owners[tuple(coords.T)]]

    def channels(part: slice) -> np.ndarray:
        return said[:, after_occupancy(part)]

    return replace(
        like,
        coords=coords,
        label_probs=channels(layout.label),
        joint_probs=channels(layout.joint_type),
        axis=channels(layout.axis),
        origin=channels(layout.origin),
        ranges=channels(layout.range) * (layout.rotation_unit, layout.length_unit),
        box=channels(layout.box),
        category_probs=channels(layout.category),
    )
