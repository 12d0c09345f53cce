"""The paint of procedural objects: of samples of their surface, and of the two sides of their voxels."""

from dataclasses import replace

import numpy as np
from jaxtyping import Int

from artigen.paint import PaintedSurface, VoxelPaint, gather_paint
from artigen.shapes.asset import part_owners
from artigen.shapes.sampling import paint_points, place_points, read_clear
from artigen.shapes.shape import Shape
from artigen.types import Asset

SAMPLES = 3
"""Samples of the surface along a voxel's edge."""


def read_paint(shape: Shape, asset: Asset, facings: Int[np.ndarray, "N"]) -> VoxelPaint:
    """Reads both sides of every voxel of a procedural object off samples of its surface.

    Args:
        shape: The object.
        asset: The same object, with voxels.
        facings: Directions of their outer sides.

    Raises:
        ValueError: If the asset has no voxels.
    """
    if asset.voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels; voxelize its surface first")
    surface = paint_surface(shape, asset, 1.0 / (SAMPLES * asset.voxels.resolution))
    return gather_paint(surface, asset.voxels, facings)


def paint_surface(shape: Shape, asset: Asset, spacing: float) -> PaintedSurface:
    """Painted samples of the surface, ``spacing`` apart (unit-cube length), with their parts of the asset."""
    found = place_points(shape, spacing * asset.scale)
    surface = paint_points(shape, found, footprint=spacing * asset.scale)
    owned = replace(surface, part_ids=part_owners(shape, asset)[surface.part_ids])
    return PaintedSurface(samples=owned, clear=read_clear(shape, found))
