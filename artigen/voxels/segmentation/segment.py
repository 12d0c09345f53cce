"""Segments voxel fields into parts, joints and a tree.

Three steps: a recipe divides the voxels among parts (`partition_paper`, `partition_robust`), every
part's attributes are aggregated over its voxels, and each part is hung from another one
(`artigen.voxels.segmentation.tree`); nearly regular axes are snapped (`regularise`).
"""

import logging
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from artigen.errors import SegmentationError
from artigen.types import PAPER_CATEGORIES, PART_LABELS, Asset, Part, VoxelGrid
from artigen.voxels.fields import VoxelFields
from artigen.voxels.segmentation.aggregate import aggregate_part
from artigen.voxels.segmentation.neighbours import neighbour_pairs
from artigen.voxels.segmentation.partition import Partition
from artigen.voxels.segmentation.regularise import regularise
from artigen.voxels.segmentation.segment_paper import partition_paper
from artigen.voxels.segmentation.segment_robust import partition_robust
from artigen.voxels.segmentation.tree import REACH, find_parents

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class SegmentConfig:
    """Which recipe, and what to do with a part that does not fit."""

    recipe: Literal["robust", "paper"] = "robust"
    """`paper`: semantics, DBSCAN on boxes, mean. `robust`: the default, measured against it in
    docs/explanation/structure.md."""
    detached: Literal["raise", "note"] = "raise"
    """A part without a parent within reach: raise, or hang it from the base and note it."""


def partition(fields: VoxelFields, cfg: SegmentConfig) -> Partition:
    """Divides the voxels among parts by the configured recipe.

    Raises:
        SegmentationError: If there are no voxels, or none of them is base.
    """
    if len(fields.coords) == 0:
        raise SegmentationError("the field has no occupied voxel, expected some; was it decoded from logits?")
    base = PART_LABELS.index("base")
    if not (fields.label_probs.argmax(axis=1) == base).any():
        raise SegmentationError(
            f"none of {len(fields.coords)} voxels is labelled base, "
            "an object needs a part that carries the others"
        )
    if cfg.recipe == "paper":
        return partition_paper(fields)
    return partition_robust(fields)


def segment(
    fields: VoxelFields,
    cfg: SegmentConfig | None = None,
    *,
    name: str,
    scale: float,
    category: str | None = None,
) -> Asset:
    """Finds the parts, their joints and their tree in decoded voxel fields.

    Args:
        scale: Metres per unit-cube length.
        category: Category of the asset; when None, the category most voxels vote for.

    Returns:
        An asset whose voxels carry part ids; parts are called ``label_k`` from top to bottom, the root
        is ``base``.

    Raises:
        SegmentationError: If the voxels do not describe an articulated object.
    """
    cfg = cfg or SegmentConfig()
    divided = partition(fields, cfg)
    found = []
    for index, label in enumerate(divided.labels):
        number = divided.labels[:index].count(label)
        called = "base" if label == "base" else f"{label}_{number}"
        rows = np.flatnonzero(divided.part_ids == index)
        method = "mean" if cfg.recipe == "paper" else "robust"
        found.append(aggregate_part(fields, rows, name=called, label=label, method=method))
    parts, said = _hang([one.part for one in found], fields, divided, cfg)
    asset = Asset(
        name=name,
        category=category or _voted_category(fields),
        scale=scale,
        parts=tuple(parts),
        voxels=VoxelGrid(resolution=fields.resolution, coords=fields.coords, part_ids=divided.part_ids),
        notes=(*(note for one in found for note in one.notes), *said),
    )
    return regularise(asset, [one.errors for one in found])


def _hang(
    parts: list[Part], fields: VoxelFields, divided: Partition, cfg: SegmentConfig
) -> tuple[list[Part], list[str]]:
    """Parts with their parents set, and a note for each part hung by default."""
    coords = fields.coords.astype(np.int64)
    pairs = neighbour_pairs(coords, fields.resolution)
    parents = find_parents(parts, coords, divided.part_ids, pairs)
    lost = [part.name for part, parent in zip(parts, parents, strict=True) if parent is None]
    if lost and cfg.detached == "raise":
        raise SegmentationError(
            f"no part lies within {REACH:g} voxels of {', '.join(lost)}; "
            'set detached="note" to hang them from the base'
        )
    root = divided.labels.index("base")
    notes = [f"{called}: no part within {REACH:g} voxels, hung from the base" for called in lost]
    return [
        replace(part, parent=root if parent is None else parent)
        for part, parent in zip(parts, parents, strict=True)
    ], notes


def _voted_category(fields: VoxelFields) -> str:
    """Category with the largest mean probability, `unknown` where it stays below one half."""
    votes = fields.category_probs.mean(axis=0)
    if len(votes) == 0 or votes.max() < 0.5:
        return "unknown"
    return PAPER_CATEGORIES[int(votes.argmax())]
