"""The articulated voxel field: its channels, encoding and decoding.

A field is a dense ``C x X x Y x Z`` array (`encode`, float32) in which every occupied cell carries
the attributes of the part that owns it, constant within the part (paper section 3.1.1). The paper states 35
channels and enumerates 28; the other seven are read here as the one-hot object category.
"""

from dataclasses import dataclass
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from artigen.kind import paper_kinds
from artigen.types import (
    FULL_TURN,
    JOINT_TYPES,
    PART_LABELS,
    Asset,
    JointType,
    Part,
    PartLabel,
    frozen_array,
)


class Channels(NamedTuple):
    """Slices of the attributes, in the order of the channels.

    Axes are unit vectors (zero for fixed joints), origins are in the gauge of `canonical_origin`, boxes are
    centre and size; lengths are unit-cube lengths, unscaled. The ranges are rotation in full turns and
    signed translation: a screw has both, a continuous joint a full turn. Label, joint type and category are
    one-hot; an object of another category has zeros there.
    """

    label: slice
    joint_type: slice
    axis: slice
    origin: slice
    range: slice
    box: slice
    category: slice


PAPER_KINDS = 7
"""Number of `artigen.kind.paper_kinds`."""
WIDTHS = (len(PART_LABELS), len(JOINT_TYPES), 3, 3, 2, 6, PAPER_KINDS)
"""Numbers of channels of the attributes."""


def _slices(first: int) -> Channels:
    ends = tuple(accumulate(WIDTHS, initial=first))
    return Channels(*map(slice, ends[:-1], ends[1:]))


FIELD = _slices(1)
"""Channels of a field; the first, before these, is occupancy."""
ROW = _slices(0)
"""Channels of rows that omit occupancy."""
CHANNELS = FIELD.category.stop


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelFields:
    """Values of the occupied cells in meaningful units: radians and unit-cube lengths.

    Probabilities are non-negative and sum to one per voxel, except that category rows may be zero
    (an object of another category).
    """

    resolution: int
    coords: Int[np.ndarray, "N 3"]
    label_probs: Float[np.ndarray, "N L"]
    joint_probs: Float[np.ndarray, "N T"]
    axis: Float[np.ndarray, "N 3"]
    origin: Float[np.ndarray, "N 3"]
    ranges: Float[np.ndarray, "N 2"]
    box: Float[np.ndarray, "N 6"]
    category_probs: Float[np.ndarray, "N K"]

    def __post_init__(self) -> None:
        coords = frozen_array(self.coords, np.int16, (None, 3), "field coords")
        if len(coords) and (coords.min() < 0 or coords.max() >= self.resolution):
            raise ValueError(
                f"field coords span {coords.min()}..{coords.max()}, grid is 0..{self.resolution - 1}"
            )
        object.__setattr__(self, "coords", coords)
        names = ("label_probs", "joint_probs", "axis", "origin", "ranges", "box", "category_probs")
        for name, width in zip(names, WIDTHS, strict=True):
            value = frozen_array(getattr(self, name), np.float32, (len(coords), width), f"field {name}")
            object.__setattr__(self, name, value)


def canonical_origin(part: Part) -> Float[np.ndarray, "3"]:
    """The origin that a field states for a part's joint.

    A joint determines only the line of its axis (for a translation, only the direction). The field
    fixes the rest: for rotating joints the point of the axis line nearest to the centre of the part's
    own box, for prismatic and fixed joints the box centre itself.
    """
    center = part.box[0]
    joint = part.joint
    if joint.type in ("fixed", "prismatic"):
        return center
    return joint.origin + ((center - joint.origin) @ joint.axis) * joint.axis


def joint_ranges(part: Part) -> Float[np.ndarray, "2"]:
    """Rotation range (radians) and translation range (unit lengths) of a part's joint.

    Raises:
        ValueError: If the rest pose is not the lower limit, which a field cannot express.
    """
    joint = part.joint
    if joint.lower != 0.0:
        raise ValueError(
            f"part {part.name!r}: joint limits [{joint.lower:.6g}, {joint.upper:.6g}] do not start at the "
            "rest pose, but a field states ranges from 0; move the rest pose to the lower limit first"
        )
    match joint.type:
        case "fixed":
            return np.zeros(2)
        case "prismatic":
            return np.array([0.0, joint.upper])
        case "screw":
            return np.array([joint.upper, joint.upper * joint.pitch])
        case _:
            return np.array([joint.upper, 0.0])


def part_attributes(part: Part, category: str) -> Float[np.ndarray, "C"]:
    """The channel values of every voxel of a part.

    A part states its own joint only: a handle on a drawer is fixed here, and moves because its parent
    is the drawer.
    """
    row = np.zeros(CHANNELS)
    row[0] = 1.0
    row[FIELD.label.start + PART_LABELS.index(part.label)] = 1.0
    row[FIELD.joint_type.start + JOINT_TYPES.index(part.joint.type)] = 1.0
    if part.joint.type != "fixed":
        row[FIELD.axis] = part.joint.axis
    row[FIELD.origin] = canonical_origin(part)
    row[FIELD.range] = joint_ranges(part) / (FULL_TURN, 1.0)
    row[FIELD.box] = part.box.ravel()
    if category in paper_kinds():
        row[FIELD.category.start + paper_kinds().index(category)] = 1.0
    return row


def tabulate_parts(asset: Asset) -> Float[np.ndarray, "P C"]:
    """The channels after occupancy of every part, a row each (float32)."""
    rows = [part_attributes(part, asset.category) for part in asset.parts]
    return np.stack(rows)[:, 1:].astype(np.float32)


def name_rows(table: Float[np.ndarray, "P C"]) -> tuple[PartLabel, ...]:
    """Labels of the rows of `tabulate_parts`."""
    return tuple(PART_LABELS[row.argmax()] for row in table[:, ROW.label])


def name_joints(table: Float[np.ndarray, "P C"]) -> tuple[JointType, ...]:
    """Joint types of the rows of `tabulate_parts`."""
    return tuple(JOINT_TYPES[row.argmax()] for row in table[:, ROW.joint_type])


def name_category(table: Float[np.ndarray, "P C"]) -> str | None:
    """Category of the object whose parts are the rows of `tabulate_parts`; None if it has no channel."""
    one_hot = table[0, ROW.category]
    return paper_kinds()[one_hot.argmax()] if one_hot.any() else None


def encode(asset: Asset) -> Float[np.ndarray, "C X Y Z"]:
    """Writes an asset's voxels and parts into a dense float32 field; empty cells are zero.

    Raises:
        ValueError: If the asset has no voxels.
    """
    if asset.voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels to encode; voxelize its surface first")
    voxels = asset.voxels
    table = np.stack([part_attributes(part, asset.category) for part in asset.parts])
    field = np.zeros((CHANNELS, *(voxels.resolution,) * 3), dtype=np.float32)
    flat = np.ravel_multi_index(tuple(voxels.coords.T.astype(np.int64)), (voxels.resolution,) * 3)
    columns = table.astype(np.float32).T
    for channel, values in zip(field.reshape(CHANNELS, -1), columns, strict=True):
        channel[flat] = values[voxels.part_ids]
    return field


def _probabilities(values: np.ndarray) -> np.ndarray:
    """Clips to non-negative and normalises rows; rows without any mass become uniform."""
    clipped = np.maximum(values, 0.0)
    total = clipped.sum(axis=1, keepdims=True)
    return np.where(total > 0, clipped / np.where(total > 0, total, 1.0), 1.0 / max(1, values.shape[1]))


def decode(field: Float[np.ndarray, "C X Y Z"], threshold: float = 0.5) -> VoxelFields:
    """Reads the cells whose occupancy is above ``threshold``.

    Class channels are probabilities (apply a softmax to logits first); label and joint rows are
    normalised, category rows are only clipped at zero.

    Raises:
        ValueError: If the array is not cubic, has another channel count, or holds NaN.
    """
    channels, *sides = field.shape
    if channels != CHANNELS or len(set(sides)) != 1:
        raise ValueError(f"field has shape {field.shape}, expected {CHANNELS} x R x R x R with one R")
    flat = np.flatnonzero(field[0].ravel() > threshold)
    values = field.reshape(channels, -1)[:, flat].T.astype(np.float32)  # N C
    return VoxelFields(
        resolution=sides[0],
        coords=np.stack(np.unravel_index(flat, sides), axis=1),
        label_probs=_probabilities(values[:, FIELD.label]),
        joint_probs=_probabilities(values[:, FIELD.joint_type]),
        axis=values[:, FIELD.axis],
        origin=values[:, FIELD.origin],
        ranges=values[:, FIELD.range] * (FULL_TURN, 1.0),
        box=values[:, FIELD.box],
        category_probs=np.maximum(values[:, FIELD.category], 0.0),
    )
