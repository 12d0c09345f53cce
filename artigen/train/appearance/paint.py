"""What colour the two sides of voxels have, and how clear they are: read off samples of the surface.

No picture is taken for it, so there may be many more of these examples than of photographed objects.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.facings import SIDES, facing_frames
from artigen.places import AHEAD, find_voxels
from artigen.shapes.asset import part_owners
from artigen.shapes.sampling import paint_points, place_points, read_clear
from artigen.shapes.shape import Shape
from artigen.types import Asset, SurfaceSamples, VoxelGrid

SAMPLES = 3
"""Samples of the surface along a voxel's edge."""


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelPaint:
    """Own colours (sRGB) of the outer side and of the inner one of every voxel."""

    colors: Float[np.ndarray, "N 2 3"]
    known: Int[np.ndarray, "N 2"]
    """Samples that say so; where there is none, a side has the colour of the other one, or of its part."""
    clear: Float[np.ndarray, "N"]
    """Share of what is behind that its surface lets through."""

    def packed(self) -> UInt8[np.ndarray, "N 7"]:
        """Colours and clearness in steps of 8 bits, a row for every voxel."""
        values = np.concatenate([self.colors.reshape(len(self.clear), -1), self.clear[:, None]], axis=1)
        return np.rint(255.0 * values).astype(np.uint8)


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
    spacing = asset.scale / (SAMPLES * asset.voxels.resolution)
    found = place_points(shape, spacing)
    surface = paint_points(shape, found, footprint=spacing)
    owned = replace(surface, part_ids=part_owners(shape, asset)[surface.part_ids])
    return gather_paint(owned, read_clear(shape, found), asset.voxels, facings)


def gather_paint(
    surface: SurfaceSamples,
    clear: Float[np.ndarray, "S"],
    voxels: VoxelGrid,
    facings: Int[np.ndarray, "N"],
) -> VoxelPaint:
    """Means of the samples that lie in a voxel, are of its part, and face as one of its sides does.

    Args:
        surface: Samples; a part without any is black.
        clear: Share of what is behind that the surface lets through at each.
        voxels: Cells of the same object.
        facings: Directions of their outer sides.
    """
    count = len(voxels.coords)
    rows, own = find_voxels(surface, voxels)
    normals, colors = surface.normals[own], surface.colors[own] / 255.0
    ahead = np.einsum("ki,ki->k", facing_frames()[facings][rows][:, :, 0], normals)
    known, means = np.empty((count, SIDES), dtype=np.int64), np.empty((count, SIDES, 3))
    for side, sign in enumerate((1.0, -1.0)):
        facing = sign * ahead > AHEAD
        known[:, side] = np.bincount(rows[facing], minlength=count)
        means[:, side] = _average(rows[facing], colors[facing], known[:, side])
    whole = np.bincount(rows, minlength=count)
    parts = np.bincount(surface.part_ids, minlength=int(voxels.part_ids.max()) + 1)
    of_part = _average(surface.part_ids, surface.colors / 255.0, parts)[voxels.part_ids]
    every = np.where(whole[:, None] > 0, _average(rows, colors, whole), of_part)
    for side in range(SIDES):
        lost, shown = known[:, side] == 0, known[:, 1 - side] > 0
        means[lost, side] = np.where(shown[:, None], means[:, 1 - side], every)[lost]
    return VoxelPaint(colors=means, known=known, clear=_average(rows, clear[own][:, None], whole)[:, 0])


def _average(
    rows: Int[np.ndarray, "S"], values: Float[np.ndarray, "S C"], number: Int[np.ndarray, "N"]
) -> Float[np.ndarray, "N C"]:
    """Means of values by row; 0 where a row has none."""
    sums = [np.bincount(rows, weights=one, minlength=len(number)) for one in values.T]
    return np.stack(sums, axis=1) / np.maximum(number, 1)[:, None]
