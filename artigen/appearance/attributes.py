"""Attributes of every voxel that condition the flow of structured latents.

Kind of voxel, where surface lies in it (`artigen.voxels.surface`), its paint (`artigen.appearance.paint`).
"""

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.types import PART_LABELS
from artigen.voxels.fields import DEFAULT_LAYOUT, after_occupancy
from artigen.voxels.frames import AROUND, FACINGS, SIDES, find_covered, find_joined

KIND = FACINGS + len(PART_LABELS) + SIDES + AROUND
"""Numbers that say what kind of voxel one is."""


def describe_kinds(
    table: Float[np.ndarray, "P C"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    covered: Bool[np.ndarray, "N 2"],
    joined: Bool[np.ndarray, "N 2 2"],
) -> Float[np.ndarray, "N 20"]:
    """Kind of each voxel as features (float32).

    Which way its outer side faces (one of 6), the label of its part, whether something stands before its
    outer side and its inner one, and whether its part goes on around it.

    Args:
        table: Channels after occupancy of each part, in the default layout.
        part_ids: Part of each voxel.
        facings: Direction of each voxel's outer side.
        covered: Whether something stands before either side (`artigen.voxels.frames.find_covered`).
        joined: Whether the part goes on across them (`artigen.voxels.frames.find_joined`).
    """
    labels = table[:, after_occupancy(DEFAULT_LAYOUT.label)]
    told = (np.eye(FACINGS)[facings], labels[part_ids], covered, joined.reshape(len(joined), AROUND))
    return np.concatenate(told, axis=1).astype(np.float32)


def read_kinds(
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    table: Float[np.ndarray, "P C"],
    resolution: int,
) -> Float[np.ndarray, "N 20"]:
    """Kind of each voxel of an object (`describe_kinds`), from the voxels alone.

    Args:
        coords: Cells (x, y, z) of the grid.
        part_ids: Part of each.
        facings: Directions of their outer sides.
        table: Channels after occupancy of each part, in the default layout.
        resolution: Edge of the grid.
    """
    covered = find_covered(coords, facings, resolution)
    joined = find_joined(coords, part_ids, facings, resolution)
    return describe_kinds(table, part_ids, facings, covered, joined)


def describe_voxels(
    kinds: Float[np.ndarray, "N 20"],
    places: Float[np.ndarray, "N 6"],
    paint: Float[np.ndarray, "N 7"],
) -> Float[np.ndarray, "N A"]:
    """Conditioning features of every voxel for the flow of structured latents (float32).

    Args:
        kinds: Of the voxels (`describe_kinds`).
        places: Where their surface lies (`artigen.voxels.surface.describe_places`).
        paint: Colours of both sides of each voxel, and how clear it is (`artigen.appearance.paint`).
    """
    return np.concatenate([kinds, places, paint], axis=1).astype(np.float32)
