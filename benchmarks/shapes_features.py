"""Simple numerical features of an articulated object, procedural or real."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from artigen.errors import SourceError
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import JOINT_TYPES, PART_LABELS, Asset

PROFILE = 6
"""Slices of the occupancy profile along each axis."""


@dataclass(frozen=True, kw_only=True)
class Features:
    """Features of one object; lengths in the unit cube, angles in degrees."""

    name: str
    category: str
    counts: dict[str, int]
    """Number of parts by label."""
    joints: dict[str, int]
    """Number of parts by joint type."""
    ranges: dict[str, list[float]]
    """Ranges of revolute (degrees) and prismatic joints (lengths), by label and type."""
    boxes: dict[str, list[list[float]]]
    """Sizes of part boxes by label: depth, width, height."""
    size: tuple[float, float, float]
    """Depth, width and height."""
    occupied: int
    """Number of cells of 64^3 that the surface passes through."""
    profile: tuple[float, ...]
    """Share of the occupied cells in slices along x, y, z, and per part of the shell or inside."""


def describe_asset(asset: Asset) -> Features:
    """Features of an asset with voxels."""
    if asset.voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels")
    ranges: dict[str, list[float]] = {}
    boxes: dict[str, list[list[float]]] = {}
    for part in asset.parts:
        boxes.setdefault(part.label, []).append([float(v) for v in part.box[1]])
        if part.joint.type in ("revolute", "prismatic"):
            reach = part.joint.upper - part.joint.lower
            value = np.degrees(reach) if part.joint.type == "revolute" else reach
            ranges.setdefault(f"{part.label} {part.joint.type}", []).append(float(value))
    coords = asset.voxels.coords.astype(int)
    low, high = coords.min(axis=0), coords.max(axis=0) + 1
    share = (coords - low + 0.5) / (high - low)
    slices = [np.bincount((share[:, k] * PROFILE).astype(int), minlength=PROFILE) for k in range(3)]
    inner = np.all((share > 0.15) & (share < 0.85), axis=1).mean()
    size = (high - low) / asset.voxels.resolution
    return Features(
        name=asset.name,
        category=asset.category,
        counts=dict(Counter(part.label for part in asset.parts)),
        joints=dict(Counter(part.joint.type for part in asset.parts)),
        ranges=ranges,
        boxes=boxes,
        size=(float(size[0]), float(size[1]), float(size[2])),
        occupied=len(coords),
        profile=(*(float(v) / len(coords) for chosen in slices for v in chosen), float(inner)),
    )


def describe_drawn(category: str, seed: int) -> Features:
    """Features of a procedural object."""
    return describe_asset(shape_to_asset(draw_shape(category, seed)))


def describe_real(folder: Path) -> Features | None:
    """Features of a real object; None if it cannot be read."""
    from artigen.api.convert import voxelize_object
    from artigen.datasets.partnet_mobility import ReaderConfig, read_object

    try:
        return describe_asset(voxelize_object(read_object(folder, ReaderConfig()).asset))
    except SourceError:
        return None


def feature_names() -> list[str]:
    """Names of the columns of `feature_row`."""
    names = [f"parts: {label}" for label in PART_LABELS] + [f"joints: {kind}" for kind in JOINT_TYPES]
    names += ["depth", "width", "height", "occupied cells"]
    names += [f"cells in slice {k} along {axis}" for axis in "xyz" for k in range(PROFILE)] + ["cells inside"]
    for label in PART_LABELS[1:]:
        names += [f"{label} box, mean {what}" for what in ("depth", "width", "height")]
    return [*names, "door range", "drawer range", "tray range"]


def feature_row(features: Features) -> list[float]:
    """The features as one row; 0 for absent parts."""
    row: list[float] = [features.counts.get(label, 0) for label in PART_LABELS]
    row += [features.joints.get(kind, 0) for kind in JOINT_TYPES]
    row += [*features.size, features.occupied, *features.profile]
    for label in PART_LABELS[1:]:
        sizes = np.array(features.boxes.get(label, [[0.0, 0.0, 0.0]]))
        row += [float(v) for v in sizes.mean(axis=0)]
    for key in ("door revolute", "drawer prismatic", "tray prismatic"):
        row.append(float(np.mean(features.ranges.get(key, [0.0]))))
    return row
