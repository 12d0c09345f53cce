"""Surface position within voxels: height of either side and extent across.

A voxel at the rim of a board, or on a wire, is only partly filled; Gaussians that covered all of it would
thicken boards and turn wires into bars. Positions are measured on surface samples, in the frame of the
voxel's outer side: samples of the object itself in training, of the meshes made from the voxels of a
generated one.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.types import SurfaceSamples, VoxelGrid
from artigen.voxels.frames import facing_frames, mark_voxels

SAMPLES = 3
"""Samples of the surface along a voxel's edge."""
AHEAD = 0.5
"""Least cosine between normal and side for surface to face the side's way."""
BENEATH = (0.0, 0.5, 1.0)
"""Depths in voxels beneath a sample at which a voxel of its part is sought, in this order."""
HEIGHT = 0.3
"""Distance in voxels of a side from the voxel's centre, assumed where no surface faces its way."""
PLACES = 6
"""Numbers per voxel that describe the position of its surface (`describe_places`)."""
HEIGHT_REACH = 0.75
"""Range of heights in voxels; they are encoded as the inverse hyperbolic tangent of their share of it."""
MIDDLE_SPREAD = 0.25
"""Unit of encoded middles, in voxels."""
FARTHEST = 0.9
"""Largest displacement of Gaussians, as a share of their reach."""
APART = 0.3
"""Distance in voxels, at most, that the two sides of a voxel keep when their heights are clipped."""
NARROWEST = 0.1
"""Least encoded width in voxels of the surface in a voxel: less would shrink Gaussians to nothing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelPlaces:
    """Position of the surface within voxels, in voxels from their centres."""

    heights: Float[np.ndarray, "N 2"]
    """Heights of the outer and the inner side, positive outwards; `HEIGHT` if no surface faces that way."""
    lowest: Float[np.ndarray, "N 2"]
    """Start of the surface along the frame's +y and +z."""
    highest: Float[np.ndarray, "N 2"]
    """End of the surface along the frame's +y and +z."""


@lru_cache(maxsize=1)
def find_voxels(
    surface: SurfaceSamples, voxels: VoxelGrid
) -> tuple[Int[np.ndarray, "K"], Bool[np.ndarray, "S"]]:
    """Voxel of every sample that lies in, or up to a voxel above, one of its own part; and a mask of these.

    The last result is cached, because facings, places and paint use the same samples one after another.
    """
    edge = voxels.resolution
    grid = mark_voxels(voxels.coords, np.arange(len(voxels.coords)), edge)
    points = (surface.points.astype(np.float64) + 0.5) * edge
    rows, own = np.full(len(points), -1), np.zeros(len(points), dtype=bool)
    for depth in BENEATH:
        left = np.flatnonzero(~own)
        cells = np.floor(points[left] - depth * surface.normals[left]).astype(np.int64).clip(0, edge - 1)
        rows[left] = grid[tuple(cells.T)]
        own[left] = (rows[left] >= 0) & (voxels.part_ids[rows[left]] == surface.part_ids[left])
    return rows[own], own


def measure_places(surface: SurfaceSamples, voxels: VoxelGrid, facings: Int[np.ndarray, "N"]) -> VoxelPlaces:
    """Heights and extent, within each voxel, of the surface of the voxel's own part.

    The height of a side is the mean over the surface that faces its way. A voxel without samples of its part
    counts as filled.

    Args:
        surface: Samples, `SAMPLES` or more along a voxel's edge.
    """
    count = len(voxels.coords)
    rows, own = find_voxels(surface, voxels)
    frames = facing_frames()[facings][rows]
    points = (surface.points[own].astype(np.float64) + 0.5) * voxels.resolution
    off = np.einsum("kij,ki->kj", frames, points - voxels.coords[rows] - 0.5)
    ahead = np.einsum("ki,ki->k", frames[:, :, 0], surface.normals[own].astype(np.float64))
    heights = np.empty((count, 2))
    for side, sign in enumerate((1.0, -1.0)):
        facing = sign * ahead > AHEAD
        number = np.bincount(rows[facing], minlength=count)
        total = np.bincount(rows[facing], weights=off[facing, 0], minlength=count)
        heights[:, side] = np.where(number > 0, total / np.maximum(number, 1), sign * HEIGHT)
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    for axis in (0, 1):  # NumPy is faster with one axis at a time
        np.minimum.at(low[:, axis], rows, off[:, 1 + axis])
        np.maximum.at(high[:, axis], rows, off[:, 1 + axis])
    empty = ~np.isfinite(low[:, 0])
    low[empty], high[empty] = -0.5, 0.5
    missed = 0.5 / SAMPLES  # surface reaches about this far beyond the last sample
    return VoxelPlaces(
        heights=_limit_heights(heights),
        lowest=np.maximum(low - missed, -0.5).clip(max=0.5),
        highest=np.minimum(high + missed, 0.5).clip(min=-0.5),
    )


def _limit_heights(heights: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, "N 2"]:
    """Clips heights to the encodable range; sides keep their distance up to `APART`.

    Of two coincident sheets it would be undefined which one is visible.
    """
    farthest = FARTHEST * HEIGHT_REACH
    limited = heights.clip(-farthest, farthest)
    lack = np.minimum(heights[:, 0] - heights[:, 1], APART) - (limited[:, 0] - limited[:, 1])
    lack = np.maximum(lack, 0.0)
    above = limited[:, 0] >= farthest
    return limited + np.stack([np.where(above, 0.0, lack), np.where(above, -lack, 0.0)], axis=1)


def describe_places(places: VoxelPlaces) -> Float[np.ndarray, "N 6"]:
    """Places encoded for networks, six numbers per voxel.

    Heights of the outer and the inner side, then the middle of the surface along +y and +z, then the
    logarithms of its widths.
    """
    heights = np.arctanh((places.heights / HEIGHT_REACH).clip(-FARTHEST, FARTHEST))
    middles = (places.lowest + places.highest) / (2.0 * MIDDLE_SPREAD)
    widths = np.log(np.maximum(places.highest - places.lowest, NARROWEST))
    return np.concatenate([heights, middles, widths], axis=1)
