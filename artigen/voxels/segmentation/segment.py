"""Segments voxel fields into parts, joints and a tree.

Three steps: a recipe divides the voxels among parts (`partition_paper`, `partition_robust`), every
part's attributes are aggregated over its voxels, and each part is hung from another one
(`artigen.voxels.segmentation.tree`); axes that are a degree or two off are snapped (`regularise`), because
furniture is built square.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from artigen.errors import SegmentationError
from artigen.kind import paper_kinds
from artigen.types import PART_LABELS, Asset, Joint, Part, VoxelGrid
from artigen.voxels.fields import VoxelFields, canonical_origin
from artigen.voxels.segmentation.aggregate import aggregate_part
from artigen.voxels.segmentation.neighbours import Partition, canonical_partition, neighbour_pairs
from artigen.voxels.segmentation.segment_robust import partition_robust
from artigen.voxels.segmentation.tree import REACH, find_parents

EPS = 0.08
"""Neighbourhood radius in the six box attributes, unit lengths. Larger merges neighbouring
drawers, smaller splits parts with noisy votes."""
MIN_SAMPLES = 5
"""Voxels within `EPS` that make a dense core (scikit-learn's default)."""
MAX_ROWS = 3000
"""Most distinct box votes clustered per label; of more, an even selection is clustered and the
others join the nearest. Bounds time and memory, which grow with the square."""
AXIS_DEGREES = 1.0
"""An axis closer than this to a principal direction becomes that direction."""
CENTER_OFFSET = 0.25 / 64.0
"""The axis of a continuous joint that passes its part's box centre within this many unit lengths
is moved through the centre."""
SIGMAS = 3.0
"""Where the standard error of a vote is known, the tolerance is at least this multiple of it."""
MOST_DEGREES = 8.0
"""Largest angle by which an axis is turned, however uncertain it is."""
MOST_OFFSET = 1.5 / 64.0
"""Largest distance, in unit lengths, by which an axis is moved, however uncertain it is."""


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
    return paper_kinds()[int(votes.argmax())]


def partition_paper(fields: VoxelFields) -> Partition:
    """Semantic label by the largest probability, instances by DBSCAN; the base is one part.

    DBSCAN's outliers join the cluster with the nearest vote (the paper does not say); a label with
    outliers only is one part.
    """
    labels = fields.label_probs.argmax(axis=1)
    instances = np.zeros(len(labels), dtype=np.int64)
    base = PART_LABELS.index("base")
    for label in np.unique(labels):
        if label != base:
            rows = np.flatnonzero(labels == label)
            instances[rows] = _cluster_boxes(fields.box[rows])
    (kinds, _), groups = np.unique([labels, instances], axis=1, return_inverse=True)
    return canonical_partition(fields, groups.ravel(), kinds)


def _cluster_boxes(boxes: Float[np.ndarray, "n 6"]) -> Int[np.ndarray, "n"]:
    """DBSCAN cluster of each row, counting equal rows with their multiplicity."""
    from sklearn.cluster import DBSCAN

    votes, which, weights = np.unique(boxes, axis=0, return_inverse=True, return_counts=True)
    step = max(1, -(-len(votes) // MAX_ROWS))
    chosen = np.arange(0, len(votes), step)
    clusters = DBSCAN(eps=EPS, min_samples=MIN_SAMPLES).fit_predict(
        votes[chosen], sample_weight=weights[chosen] * step
    )
    dense = chosen[clusters >= 0]
    if len(dense) == 0:
        return np.zeros(len(boxes), dtype=np.int64)
    nearest = KDTree(votes[dense]).query(votes)[1]
    return clusters[clusters >= 0][nearest][which.ravel()].astype(np.int64)


def regularise(asset: Asset, errors: Sequence[tuple[float, float]] | None = None) -> Asset:
    """Snaps axes to principal directions and continuous axes to box centres; one note per change.

    Args:
        errors: Standard errors of each part's axis (radians) and axis line (unit lengths), where known.
    """
    errors = errors if errors is not None else [(0.0, 0.0)] * len(asset.parts)
    parts, notes = [], []
    for part, (axis_error, line_error) in zip(asset.parts, errors, strict=True):
        degrees = min(max(AXIS_DEGREES, SIGMAS * float(np.degrees(axis_error))), MOST_DEGREES)
        offset = min(max(CENTER_OFFSET, SIGMAS * line_error), MOST_OFFSET)
        part, new = _regular_part(part, degrees, offset)
        parts.append(part)
        notes += new
    return replace(asset, parts=tuple(parts), notes=asset.notes + tuple(notes))


def _regular_part(part: Part, degrees: float, offset: float) -> tuple[Part, list[str]]:
    if part.joint.type == "fixed":
        return part, []
    notes = []
    axis, turned = _snapped_axis(part.joint, degrees)
    if turned > 1e-6:
        notes.append(
            f"{part.name}: axis turned by {np.degrees(turned):.2f} degrees onto a principal direction"
        )
    joint = replace(part.joint, axis=axis)
    origin = canonical_origin(replace(part, joint=joint))
    if joint.type == "continuous":
        moved = np.linalg.norm(origin - part.box[0])
        if 1e-9 < moved <= offset:
            notes.append(f"{part.name}: axis moved by {moved:.4f} units through the box centre")
            origin = part.box[0]
    return replace(part, joint=replace(joint, origin=origin)), notes


def _snapped_axis(joint: Joint, degrees: float) -> tuple[np.ndarray, float]:
    """The axis or its principal direction, and the angle between them in radians."""
    nearest = int(np.abs(joint.axis).argmax())
    principal = np.eye(3)[nearest] * np.sign(joint.axis[nearest])
    angle = float(np.arctan2(np.linalg.norm(np.delete(joint.axis, nearest)), abs(joint.axis[nearest])))
    return (principal, angle) if angle <= np.radians(degrees) else (joint.axis, 0.0)
