"""Agreement of a segmented asset with the true one: parts, joints, tree."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import linear_sum_assignment

from artigen.types import Asset, Part
from artigen.voxels.fields import canonical_origin


@dataclass(frozen=True, kw_only=True)
class PartScore:
    """One true part and what was found of it.

    Angles in degrees, distances in voxels, ranges relative to the true range; None where it does not
    apply: the part was not found, the joint is fixed, of another type, or does not turn.
    """

    name: str
    iou: float
    """Voxels in common over voxels in either, for the found part of the same label matched to it."""
    joint_type_right: bool | None
    axis_degrees: float | None
    line_voxels: float | None
    range_error: float | None
    parent_right: bool | None

    @property
    def found(self) -> bool:
        """Whether more than half of the part was found again."""
        return self.iou > 0.5


@dataclass(frozen=True, kw_only=True)
class SegmentationScore:
    """Scores of all true parts, and the number of found ones."""

    parts: tuple[PartScore, ...]
    found_parts: int

    @property
    def complete(self) -> bool:
        """Whether the part counts agree and every part was found."""
        return self.found_parts == len(self.parts) and all(part.found for part in self.parts)


def part_overlaps(truth: Asset, found: Asset) -> Float[np.ndarray, "P Q"]:
    """Intersection over union of the voxels of every true and every found part.

    Raises:
        ValueError: If an asset has no voxels, or their resolutions differ.
    """
    if truth.voxels is None or found.voxels is None:
        raise ValueError("both assets need voxels to be compared")
    resolution = truth.voxels.resolution
    if found.voxels.resolution != resolution:
        raise ValueError(f"voxel resolutions {resolution} and {found.voxels.resolution} differ")
    rows, columns = len(truth.parts), len(found.parts)
    grid = np.full((resolution,) * 3, -1, dtype=np.int64)
    grid[tuple(truth.voxels.coords.T)] = truth.voxels.part_ids
    met = grid[tuple(found.voxels.coords.T)]
    both = np.zeros((rows, columns))
    np.add.at(both, (met[met >= 0], found.voxels.part_ids[met >= 0]), 1)
    counts = np.bincount(truth.voxels.part_ids, minlength=rows)[:, None]
    union = counts + np.bincount(found.voxels.part_ids, minlength=columns)[None] - both
    return both / np.maximum(union, 1)


def score_segmentation(truth: Asset, found: Asset) -> SegmentationScore:
    """Matches parts of equal label one to one by overlap, best total first, and compares them."""
    overlaps = part_overlaps(truth, found)
    alike = np.array([[a.label == b.label for b in found.parts] for a in truth.parts])
    overlaps = np.where(alike, overlaps, 0.0)
    rows, columns = linear_sum_assignment(-overlaps)
    partner = {int(a): int(b) for a, b in zip(rows, columns, strict=True) if overlaps[a, b] > 0}
    assert truth.voxels is not None
    scores = []
    for index, part in enumerate(truth.parts):
        match = partner.get(index)
        other = None if match is None else found.parts[match]
        parent = None
        if match is not None and part.parent != -1:
            parent = partner.get(part.parent) == found.parts[match].parent
        scores.append(
            _score_part(
                part,
                other,
                iou=0.0 if match is None else float(overlaps[index, match]),
                resolution=truth.voxels.resolution,
                parent_right=parent,
            )
        )
    return SegmentationScore(parts=tuple(scores), found_parts=len(found.parts))


def _score_part(
    true: Part, found: Part | None, *, iou: float, resolution: int, parent_right: bool | None
) -> PartScore:
    """Compares a part with its match; joints are compared only where more than half was found."""
    counted = found is not None and iou > 0.5
    kind = found.joint.type == true.joint.type if counted and found is not None else None
    angle = line = error = None
    if found is not None and kind and true.joint.type != "fixed":
        cross = np.linalg.norm(np.cross(true.joint.axis, found.joint.axis))
        angle = float(np.degrees(np.arctan2(cross, true.joint.axis @ found.joint.axis)))
        if true.joint.type != "prismatic":
            offset = canonical_origin(found) - true.joint.origin
            line = float(np.linalg.norm(np.cross(offset, true.joint.axis)) * resolution)
        if true.joint.upper > 0:
            error = abs(found.joint.upper - true.joint.upper) / true.joint.upper
    return PartScore(
        name=true.name,
        iou=iou,
        joint_type_right=kind,
        axis_degrees=angle,
        line_voxels=line,
        range_error=error,
        parent_right=parent_right,
    )
