"""Attributes of every voxel that condition the flow of structured latents.

They are the kind of voxel, the position of the surface in it (`artigen.voxels.surface`), and its paint
(`artigen.appearance.paint`).
"""

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.types import PART_LABELS
from artigen.voxels.fields import ROW
from artigen.voxels.frames import AROUND, FACINGS, SIDES, find_covered, find_joined

KIND = FACINGS + len(PART_LABELS) + SIDES + AROUND
"""Numbers that describe the kind of a voxel (`describe_kinds`)."""


def describe_kinds(
    table: Float[np.ndarray, "P C"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    covered: Bool[np.ndarray, "N 2"],
    joined: Bool[np.ndarray, "N 2 2"],
) -> Float[np.ndarray, "N 20"]:
    """Kind of each voxel as features (float32).

    Direction of its outer side (one of 6), label of its part, whether something stands before its outer and
    its inner side, and whether its part continues around it.
    """
    labels = table[:, ROW.label]
    features = (np.eye(FACINGS)[facings], labels[part_ids], covered, joined.reshape(len(joined), AROUND))
    return np.concatenate(features, axis=1).astype(np.float32)


def read_kinds(
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    table: Float[np.ndarray, "P C"],
    resolution: int,
) -> Float[np.ndarray, "N 20"]:
    """Kind of each voxel of an object (`describe_kinds`), from the voxels alone."""
    covered = find_covered(coords, facings, resolution)
    joined = find_joined(coords, part_ids, facings, resolution)
    return describe_kinds(table, part_ids, facings, covered, joined)


def describe_voxels(
    kinds: Float[np.ndarray, "N 20"], places: Float[np.ndarray, "N 6"], paint: Float[np.ndarray, "N 7"]
) -> Float[np.ndarray, "N A"]:
    """Conditioning features of every voxel for the flow of structured latents (float32)."""
    return np.concatenate([kinds, places, paint], axis=1).astype(np.float32)
