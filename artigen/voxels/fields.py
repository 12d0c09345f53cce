"""The articulated voxel field: layout of its channels, encoding and decoding.

A field is a dense ``C x X x Y x Z`` array (`encode`, float32) in which every occupied cell carries
the attributes of the part that owns it, constant within the part (paper section 3.1.1). The channel
layout is a value, `FieldLayout`. The paper states 35 channels and enumerates 28; that the other
seven are the one-hot object category is our reading.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.types import (
    FULL_TURN,
    JOINT_TYPES,
    PAPER_CATEGORIES,
    PART_LABELS,
    Asset,
    JointType,
    Part,
    PartLabel,
    frozen_array,
)


@dataclass(frozen=True, kw_only=True)
class FieldLayout:
    """Names and order of the channels; the default is the 35-channel layout.

    Order: occupancy, part label, joint type, axis, origin, range, box, category, extra.

    Units in the field: axis unit vectors (zero for fixed joints); origin, box centre and box size in
    unit-cube lengths, unscaled; range[0] is the rotation range divided by ``rotation_unit``, range[1]
    the signed translation range divided by ``length_unit``. A screw uses both, its pitch is their
    ratio; a continuous joint states a full turn.
    """

    labels: tuple[PartLabel, ...] = PART_LABELS
    """Part labels, one channel each; a part with another label cannot be encoded."""
    joint_types: tuple[JointType, ...] = JOINT_TYPES
    """Joint types, one channel each."""
    categories: tuple[str, ...] = PAPER_CATEGORIES
    """Object categories, one channel each; an object of another category has zeros here."""
    rotation_unit: float = FULL_TURN
    """Radians that read 1.0 in the rotation range channel."""
    length_unit: float = 1.0
    """Unit-cube lengths that read 1.0 in the translation range channel."""
    extra: int = 0
    """Channels left zero at the end, for what a caller adds (a parent vote, a signed distance)."""

    def __post_init__(self) -> None:
        for name in ("labels", "joint_types", "categories"):
            values = getattr(self, name)
            if len(set(values)) != len(values):
                raise ValueError(f"layout {name} {values} hold a name twice")
        if not self.labels or not self.joint_types:
            raise ValueError("a layout needs at least one label and one joint type")
        if self.rotation_unit <= 0 or self.length_unit <= 0:
            raise ValueError(
                f"layout units are {self.rotation_unit} rad and {self.length_unit}, expected above 0"
            )
        if self.extra < 0:
            raise ValueError(f"layout extra is {self.extra}, expected 0 or more")

    @property
    def widths(self) -> tuple[int, ...]:
        """Channels per attribute, in order."""
        return (1, len(self.labels), len(self.joint_types), 3, 3, 2, 6, len(self.categories), self.extra)

    @property
    def channels(self) -> int:
        """Total number of channels, 35 by default."""
        return sum(self.widths)

    def _slice(self, index: int) -> slice:
        start = sum(self.widths[:index])
        return slice(start, start + self.widths[index])

    @property
    def occupancy(self) -> slice:
        """1 where the surface passes through the cell."""
        return self._slice(0)

    @property
    def label(self) -> slice:
        """One-hot part label."""
        return self._slice(1)

    @property
    def joint_type(self) -> slice:
        """One-hot joint type."""
        return self._slice(2)

    @property
    def axis(self) -> slice:
        """Joint axis."""
        return self._slice(3)

    @property
    def origin(self) -> slice:
        """Joint origin in the gauge of `canonical_origin`."""
        return self._slice(4)

    @property
    def range(self) -> slice:
        """Rotation range, translation range."""
        return self._slice(5)

    @property
    def box(self) -> slice:
        """Box centre, box size."""
        return self._slice(6)

    @property
    def category(self) -> slice:
        """One-hot object category."""
        return self._slice(7)


DEFAULT_LAYOUT = FieldLayout()


def after_occupancy(channels: slice) -> slice:
    """Where channels of a layout lie in rows and tables that leave occupancy out."""
    return slice(channels.start - 1, channels.stop - 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelFields:
    """Values of the occupied cells in meaningful units: radians and unit-cube lengths.

    Probabilities are non-negative and sum to one per voxel, except that category rows may be zero
    (an object outside the layout's categories).
    """

    resolution: int
    layout: FieldLayout
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
        widths = {
            "label_probs": len(self.layout.labels),
            "joint_probs": len(self.layout.joint_types),
            "axis": 3,
            "origin": 3,
            "ranges": 2,
            "box": 6,
            "category_probs": len(self.layout.categories),
        }
        for name, width in widths.items():
            value = frozen_array(getattr(self, name), np.float32, (len(coords), width), f"field {name}")
            object.__setattr__(self, name, value)

    def centers(self) -> Float[np.ndarray, "N 3"]:
        """Cell centres in the unit cube."""
        return (self.coords + 0.5) / self.resolution - 0.5


def canonical_origin(part: Part) -> Float[np.ndarray, "3"]:
    """The origin that a field states for a part's joint.

    Only the line (or, for a translation, only the direction) of an axis has a meaning; the field
    fixes the rest: for turning joints the point of the axis line nearest to the centre of the part's
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
        ValueError: If the rest pose is not the lower limit; a field cannot say so.
    """
    joint = part.joint
    if joint.lower != 0.0:
        raise ValueError(
            f"part {part.name!r}: joint limits [{joint.lower:.6g}, {joint.upper:.6g}] do not start at the "
            "rest pose, a field states ranges from 0; move the rest pose to the lower limit first"
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


def part_attributes(
    part: Part, category: str, layout: FieldLayout = DEFAULT_LAYOUT
) -> Float[np.ndarray, "C"]:
    """The channel values of every voxel of a part.

    A part states its own joint only: a fixed handle on a drawer is fixed here, and moves because the
    tree hangs it from the drawer.

    Raises:
        ValueError: If the layout has no channel for the label or the joint type.
    """
    for value, known in ((part.label, layout.labels), (part.joint.type, layout.joint_types)):
        if value not in known:
            raise ValueError(f"part {part.name!r}: {value!r} is not in the layout's {', '.join(known)}")
    row = np.zeros(layout.channels)
    row[layout.occupancy] = 1.0
    row[layout.label.start + layout.labels.index(part.label)] = 1.0
    row[layout.joint_type.start + layout.joint_types.index(part.joint.type)] = 1.0
    if part.joint.type != "fixed":
        row[layout.axis] = part.joint.axis
    row[layout.origin] = canonical_origin(part)
    row[layout.range] = joint_ranges(part) / (layout.rotation_unit, layout.length_unit)
    row[layout.box] = part.box.ravel()
    if category in layout.categories:
        row[layout.category.start + layout.categories.index(category)] = 1.0
    return row


def tabulate_parts(asset: Asset, layout: FieldLayout = DEFAULT_LAYOUT) -> Float[np.ndarray, "P C"]:
    """The channels after occupancy of every part, a row each (float32)."""
    rows = [part_attributes(part, asset.category, layout) for part in asset.parts]
    return np.stack(rows)[:, layout.occupancy.stop :].astype(np.float32)


def name_rows(table: Float[np.ndarray, "P C"], layout: FieldLayout = DEFAULT_LAYOUT) -> tuple[PartLabel, ...]:
    """Labels of the rows of `tabulate_parts`."""
    return tuple(layout.labels[row.argmax()] for row in table[:, after_occupancy(layout.label)])


def name_joints(
    table: Float[np.ndarray, "P C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[JointType, ...]:
    """Joint types of the rows of `tabulate_parts`."""
    return tuple(layout.joint_types[row.argmax()] for row in table[:, after_occupancy(layout.joint_type)])


def name_category(table: Float[np.ndarray, "P C"], layout: FieldLayout = DEFAULT_LAYOUT) -> str | None:
    """Category of the object whose parts are the rows of `tabulate_parts`; None where they say none."""
    said = table[0, after_occupancy(layout.category)]
    return layout.categories[said.argmax()] if said.any() else None


def encode(asset: Asset, layout: FieldLayout = DEFAULT_LAYOUT) -> Float[np.ndarray, "C X Y Z"]:
    """Writes an asset's voxels and parts into a dense float32 field; empty cells are zero.

    Raises:
        ValueError: If the asset has no voxels, or a part does not fit the layout.
    """
    if asset.voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels to encode; voxelize its surface first")
    voxels = asset.voxels
    table = np.stack([part_attributes(part, asset.category, layout) for part in asset.parts])
    field = np.zeros((layout.channels, *(voxels.resolution,) * 3), dtype=np.float32)
    flat = np.ravel_multi_index(tuple(voxels.coords.T.astype(np.int64)), (voxels.resolution,) * 3)
    columns = table.astype(np.float32).T
    for channel, values in zip(field.reshape(layout.channels, -1), columns, strict=True):
        channel[flat] = values[voxels.part_ids]
    return field


def _probabilities(values: np.ndarray) -> np.ndarray:
    """Clips to non-negative and normalises rows; rows without any mass become uniform."""
    clipped = np.maximum(values, 0.0)
    total = clipped.sum(axis=1, keepdims=True)
    return np.where(total > 0, clipped / np.where(total > 0, total, 1.0), 1.0 / max(1, values.shape[1]))


def decode(
    field: Float[np.ndarray, "C X Y Z"], layout: FieldLayout = DEFAULT_LAYOUT, threshold: float = 0.5
) -> VoxelFields:
    """Reads the cells whose occupancy is above ``threshold``.

    Class channels are probabilities (apply a softmax to logits first); label and joint rows are
    normalised, category rows are only clipped at zero.

    Raises:
        ValueError: If the array is not cubic, has another channel count, or holds NaN.
    """
    channels, *sides = field.shape
    if channels != layout.channels or len(set(sides)) != 1:
        raise ValueError(
            f"field has shape {field.shape}, the layout needs {layout.channels} x R x R x R with one R"
        )
    flat = np.flatnonzero(field[layout.occupancy.start].ravel() > threshold)
    values = field.reshape(channels, -1)[:, flat].T.astype(np.float32)  # N C
    return VoxelFields(
        resolution=sides[0],
        layout=layout,
        coords=np.stack(np.unravel_index(flat, sides), axis=1),
        label_probs=_probabilities(values[:, layout.label]),
        joint_probs=_probabilities(values[:, layout.joint_type]),
        axis=values[:, layout.axis],
        origin=values[:, layout.origin],
        ranges=values[:, layout.range] * (layout.rotation_unit, layout.length_unit),
        box=values[:, layout.box],
        category_probs=np.maximum(values[:, layout.category], 0.0),
    )
