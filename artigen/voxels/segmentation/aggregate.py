"""Joint, range and box of a group of voxels, by vote."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from artigen.errors import SegmentationError
from artigen.types import FIXED, FULL_TURN, JOINT_TYPES, Joint, JointType, Part, PartLabel
from artigen.voxels.fields import VoxelFields, canonical_origin

Aggregation = Literal["mean", "robust"]

SLACK_VOXELS = 1.0
"""Distance in voxels that a voted face may lie outside the span that the voxels allow."""


def dominant_axis(axes: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "3"]:
    """Unit axis nearest to all ``axes`` up to their signs, pointing where most of their length points.

    The eigenvector of the largest eigenvalue of ``sum a a^T``: votes of opposite sign agree instead of
    cancelling, and the zero vectors of fixed voxels count for nothing.
    """
    values, vectors = np.linalg.eigh(axes.T.astype(np.float64) @ axes)
    if values[-1] <= 0:
        return np.zeros(3)
    axis = vectors[:, -1]
    return axis if (axes @ axis).sum() >= 0 else -axis


def nearest_point_to_lines(
    origins: Float[np.ndarray, "N 3"], axes: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "3"]:
    """Least-squares point of the lines ``origins + t axes``; along a common direction, their mean."""
    axes = axes.astype(np.float64)
    lengths = np.linalg.norm(axes, axis=1, keepdims=True)
    units = axes / np.where(lengths > 0, lengths, 1.0)
    center = origins.mean(axis=0, dtype=np.float64)
    across = np.eye(3) - units[:, :, None] * units[:, None, :]  # N 3 3
    offset = (across @ (origins - center)[:, :, None]).sum(axis=0)[:, 0]
    # Nearly parallel lines leave the position along them open; the ridge puts it at the mean origin.
    return center + np.linalg.solve(across.sum(axis=0) + 0.05 * len(origins) * np.eye(3), offset)


def _inliers(values: np.ndarray) -> np.ndarray:
    """Rows within three robust standard deviations of the median in every column."""
    deviation = np.abs(values - np.median(values, axis=0))
    return np.all(deviation <= 3 * 1.4826 * np.median(deviation, axis=0) + 1e-4, axis=1)


def _joint(
    kind: JointType, axis: np.ndarray, origin: np.ndarray, ranges: np.ndarray
) -> tuple[Joint, str | None]:
    """A joint from aggregated votes, and a note where the votes contradict its type."""
    if kind == "fixed":
        return FIXED, None
    length = np.linalg.norm(axis)
    if length < 1e-3:
        raise SegmentationError(
            f"a part voted {kind} has no axis: mean length {length:.2g}, expected about 1"
        )
    rotation, travel = float(ranges[0]), float(ranges[1])
    upper = {"revolute": rotation, "continuous": FULL_TURN, "prismatic": travel, "screw": rotation}[kind]
    note = None
    if upper <= 0:
        note = f"range {upper:.3g} of a {kind} joint raised to 0"
        upper = 0.0
    pitch = travel / upper if kind == "screw" and upper > 0 else 0.0
    return Joint(type=kind, axis=axis / length, origin=origin, upper=upper, pitch=pitch), note


def voxel_extent(coords: Int[np.ndarray, "N 3"], resolution: int) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner of the cells."""
    return np.stack([coords.min(axis=0), coords.max(axis=0) + 1]) / resolution - 0.5


def fuse_box(
    voted: Float[np.ndarray, "6"], coords: Int[np.ndarray, "N 3"], resolution: int
) -> Float[np.ndarray, "2 3"]:
    """The voted box, with every face clamped to the span that the voxels allow.

    The lowest cell of a part holds its lowest face, so that face lies inside this cell. `SLACK_VOXELS`
    are added on both sides, because a cell shared by two parts goes to one of them.
    """
    center, size = voted[:3].astype(np.float64), np.maximum(voted[3:].astype(np.float64), 0.0)
    low_cell, high_cell = voxel_extent(coords, resolution)
    slack = SLACK_VOXELS / resolution
    cell = 1.0 / resolution
    low = np.clip(center - size / 2, low_cell - slack, low_cell + cell + slack)
    high = np.clip(center + size / 2, high_cell - cell - slack, high_cell + slack)
    low, high = np.minimum(low, high), np.maximum(low, high)
    return np.stack([(low + high) / 2, high - low])


def box_faces(box: Float[np.ndarray, "2 3"]) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner of a box given by centre and size."""
    return np.stack([box[0] - box[1] / 2, box[0] + box[1] / 2])


def mean_votes(fields: VoxelFields, rows: Int[np.ndarray, "n"]) -> tuple[np.ndarray, ...]:
    """The paper's aggregation: axis, origin, ranges and box by plain averaging."""
    return tuple(
        values[rows].mean(axis=0, dtype=np.float64)
        for values in (fields.axis, fields.origin, fields.ranges, fields.box)
    )


def robust_votes(fields: VoxelFields, rows: Int[np.ndarray, "n"]) -> tuple[np.ndarray, ...]:
    """Axis by dominant eigenvector, origin nearest to all lines, ranges and box by median."""
    axis = dominant_axis(fields.axis[rows])
    used = rows[_inliers(fields.origin[rows])]
    used = used if len(used) else rows
    origin = nearest_point_to_lines(fields.origin[used], fields.axis[used])
    return axis, origin, np.median(fields.ranges[rows], axis=0), np.median(fields.box[rows], axis=0)


VOTES: dict[Aggregation, Callable[[VoxelFields, np.ndarray], tuple[np.ndarray, ...]]] = {
    "mean": mean_votes,
    "robust": robust_votes,
}


def standard_errors(
    fields: VoxelFields, rows: Int[np.ndarray, "n"], axis: Float[np.ndarray, "3"]
) -> tuple[float, float]:
    """Standard errors of a part's axis (radians) and of its origin across the axis (unit lengths).

    Votes count as independent; the errors are zero where votes agree exactly.
    """
    sides = np.linalg.svd(axis[None])[2][1:]  # 2 3, across the axis
    spread = [
        np.sqrt((values[rows] @ sides.T).var(axis=0).mean() / len(rows))
        for values in (fields.axis, fields.origin)
    ]
    return float(spread[0]), float(spread[1])


@dataclass(frozen=True, kw_only=True)
class AggregatedPart:
    """A part that is not yet in a tree, with the standard errors of its votes and notes of repairs."""

    part: Part
    errors: tuple[float, float] = (0.0, 0.0)
    """Of the axis (radians) and of the position of its line (unit lengths); none of a fixed part."""
    notes: tuple[str, ...] = ()


def aggregate_part(
    fields: VoxelFields, rows: Int[np.ndarray, "n"], *, name: str, label: PartLabel, method: Aggregation
) -> AggregatedPart:
    """Aggregates the votes of the voxels in ``rows``.

    The part labelled base carries the object, so it is fixed whatever its voxels vote.

    Raises:
        SegmentationError: If a movable part has no axis.
    """
    axis, origin, ranges, voted = VOTES[method](fields, rows)
    kind = JOINT_TYPES[int(fields.joint_probs[rows].sum(axis=0).argmax())]
    notes = []
    if label == "base" and kind != "fixed":
        notes.append(f"{name}: voted {kind}, held fixed because it carries the object")
        kind = "fixed"
    box = _plain_box(voted)
    if method == "robust":
        box = fuse_box(voted, fields.coords[rows], fields.resolution)
        moved = np.abs(box_faces(box) - box_faces(_plain_box(voted))).max() * fields.resolution
        if moved > 1:
            notes.append(f"{name}: box face moved by {moved:.1f} voxels to the extent of the voxels")
    try:
        joint, note = _joint(kind, axis, origin, ranges)
    except SegmentationError as err:
        raise SegmentationError(f"{name} ({len(rows)} voxels): {err}") from err
    if note:
        notes.append(f"{name}: {note}")
    part = Part(name=name, label=label, parent=-1, joint=joint, box=box)
    if kind == "fixed":
        return AggregatedPart(part=part, notes=tuple(notes))
    gauged = replace(joint, origin=canonical_origin(part))
    return AggregatedPart(
        part=replace(part, joint=gauged),
        errors=standard_errors(fields, rows, joint.axis),
        notes=tuple(notes),
    )


def _plain_box(voted: np.ndarray) -> np.ndarray:
    return np.stack([voted[:3], np.maximum(voted[3:], 0.0)])
