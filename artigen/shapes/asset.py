"""A procedural object as an `Asset`, with exact voxels and coloured surface samples."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int

from artigen.shapes.poses import make_joint
from artigen.shapes.rasterize import rasterize_shape
from artigen.shapes.sampling import sample_shape
from artigen.shapes.shape import Shape
from artigen.types import Asset, Part, VoxelGrid
from artigen.voxels.voxelize import assign_cells, drop_unresolved, find_heirs


def shape_parts(shape: Shape, center: Float[np.ndarray, "3"], scale: float) -> tuple[Part, ...]:
    """Parts with joints and boxes, relative to ``center`` (m) and in units of ``scale`` metres."""
    names = [part.name for part in shape.parts]
    out = []
    for part in shape.parts:
        low, high = part.bounds()
        out.append(
            Part(
                name=part.name,
                label=part.label,
                parent=-1 if part.parent is None else names.index(part.parent),
                joint=make_joint(part.joint, center, scale),
                box=np.stack([((low + high) / 2 - center) / scale, (high - low) / scale]),
            )
        )
    return tuple(out)


def frame_shape(shape: Shape) -> tuple[Float[np.ndarray, "3"], float]:
    """Centre (m) and longest edge (m) of the closed object: origin and scale of the unit cube."""
    low, high = shape.bounds()
    return (low + high) / 2, float((high - low).max())


def shape_to_asset(shape: Shape, resolution: int | None = 64, spacing: float | None = None) -> Asset:
    """Samples a shape as an asset. Parts too small to own a cell are merged into their parents, with a note.

    Args:
        shape: The object.
        resolution: Cells along the longest edge; None omits voxels.
        spacing: Mean distance (m) of coloured surface samples; None omits them.
    """
    center, scale = frame_shape(shape)
    voxels = None if resolution is None else _voxelize(shape, resolution)
    asset = Asset(
        name=shape.name,
        category=shape.category,
        scale=scale,
        parts=shape_parts(shape, center, scale),
        voxels=voxels,
        surface=None if spacing is None else sample_shape(shape, spacing),
    )
    return asset if voxels is None else drop_unresolved(asset)


def voxelize_shape(shape: Shape, resolution: int = 64) -> Asset:
    """The asset of a shape with exact voxels and all of its parts, including those too small to own a voxel.

    `artigen.voxels.fields.encode` turns it into 35 channels; `artigen.voxels.voxelize.drop_unresolved`
    merges parts without a voxel into their parents.
    """
    voxels = _voxelize(shape, resolution)
    asset = replace(shape_to_asset(shape, resolution=None), voxels=voxels)
    lost = np.setdiff1d(np.arange(len(asset.parts)), voxels.part_ids)
    notes = tuple(f"{asset.parts[index].name} is smaller than a voxel and owns none" for index in lost)
    return replace(asset, notes=notes)


def part_owners(shape: Shape, asset: Asset) -> Int[np.ndarray, "P"]:
    """Asset part of each part of the shape: itself, or the ancestor that it was merged into."""
    return find_heirs({part.name: part.parent for part in shape.parts}, asset)


def _voxelize(shape: Shape, resolution: int) -> VoxelGrid:
    found = rasterize_shape(shape, resolution)
    return assign_cells(found.cells, found.part_ids, found.areas, resolution)
