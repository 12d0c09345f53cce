"""Surface position within voxels: height of either side and extent across.

A voxel at the rim of a board, or on a wire, is filled in part; Gaussians that covered all of it would make
boards thicker and wires bars. Read off samples of the surface, in the frame of the voxel's outer side: of the
object itself in training, of the meshes that are made of the voxels of a drawn one.
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
"""Cosine from which surface faces as the side does."""
BENEATH = (0.0, 0.5, 1.0)
"""Voxels beneath a sample of surface at which its voxel is sought, where it lies in none of its part."""
HEIGHT = 0.3
"""Voxels that a side lies off the middle of a voxel where no surface faces its way."""
PLACES = 6
"""Numbers that say where the surface of a voxel lies (`describe_places`)."""
HEIGHT_REACH = 0.75
"""Voxels within which heights of sides are told, as the inverse hyperbolic tangent of their share in it."""
MIDDLE_SPREAD = 0.25
"""Voxels that middles are told in."""
FARTHEST = 0.9
"""Share of their reach that Gaussians are moved by at most."""
APART = 0.3
"""Voxels between the two sides of a voxel that are kept where they lie beyond it."""
NARROWEST = 0.1
"""Least width of surface within a voxel: a narrower one would shrink Gaussians to nothing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelPlaces:
    """Surface within voxels, in voxels from their middles."""

    heights: Float[np.ndarray, "N 2"]
    """Of the outer side and of the inner one, outwards."""
    faced: Bool[np.ndarray, "N 2"]
    """Whether there is surface that faces as either does; without, its height is only supposed."""
    lowest: Float[np.ndarray, "N 2"]
    """Where surface begins across, along the frame's +y and +z."""
    highest: Float[np.ndarray, "N 2"]
    """Where it ends."""


@lru_cache(maxsize=1)
def find_voxels(
    surface: SurfaceSamples, voxels: VoxelGrid
) -> tuple[Int[np.ndarray, "K"], Bool[np.ndarray, "S"]]:
    """The voxels of those samples that lie in one of their own part or up to a voxel over it, and which
    samples these are.

    The last answer is kept: facings, places and paint are read off the same samples one after another.
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
    """Heights and reach of the surface in each voxel, as far as it is of the voxel's part.

    A side is as high as the surface that faces its way. A voxel without samples of its part is taken to be
    filled.

    Args:
        surface: Samples, `SAMPLES` or more along a voxel's edge.
        voxels: Cells of the same object.
        facings: Directions of their outer sides.
    """
    count = len(voxels.coords)
    rows, own = find_voxels(surface, voxels)
    frames = facing_frames()[facings][rows]
    points = (surface.points[own].astype(np.float64) + 0.5) * voxels.resolution
    off = np.einsum("kij,ki->kj", frames, points - voxels.coords[rows] - 0.5)
    ahead = np.einsum("ki,ki->k", frames[:, :, 0], surface.normals[own].astype(np.float64))
    heights, faced = np.empty((count, 2)), np.empty((count, 2), dtype=bool)
    for side, sign in enumerate((1.0, -1.0)):
        facing = sign * ahead > AHEAD
        number = np.bincount(rows[facing], minlength=count)
        total = np.bincount(rows[facing], weights=off[facing, 0], minlength=count)
        faced[:, side] = number > 0
        heights[:, side] = np.where(faced[:, side], total / np.maximum(number, 1), sign * HEIGHT)
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    for axis in (0, 1):  # one axis at a time is NumPy's fast way
        np.minimum.at(low[:, axis], rows, off[:, 1 + axis])
        np.maximum.at(high[:, axis], rows, off[:, 1 + axis])
    empty = ~np.isfinite(low[:, 0])
    low[empty], high[empty] = -0.5, 0.5
    missed = 0.5 / SAMPLES  # surface reaches about this far beyond the last sample
    return VoxelPlaces(
        heights=_limit_heights(heights),
        faced=faced,
        lowest=np.maximum(low - missed, -0.5).clip(max=0.5),
        highest=np.minimum(high + missed, 0.5).clip(min=-0.5),
    )


def _limit_heights(heights: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, "N 2"]:
    """Heights as far off as can be told, and sides apart as they were, by `APART` at most: of two sheets in
    one place, one could not tell which is seen."""
    farthest = FARTHEST * HEIGHT_REACH
    limited = heights.clip(-farthest, farthest)
    lack = np.minimum(heights[:, 0] - heights[:, 1], APART) - (limited[:, 0] - limited[:, 1])
    lack = np.maximum(lack, 0.0)
    above = limited[:, 0] >= farthest
    return limited + np.stack([np.where(above, 0.0, lack), np.where(above, -lack, 0.0)], axis=1)


def describe_places(places: VoxelPlaces) -> Float[np.ndarray, "N 6"]:
    """The same, scaled as networks want it: heights of the outer side and of the inner one; of the surface
    across, where its middle lies along +y and +z, and the logarithms of its widths."""
    heights = np.arctanh((places.heights / HEIGHT_REACH).clip(-FARTHEST, FARTHEST))
    middles = (places.lowest + places.highest) / (2.0 * MIDDLE_SPREAD)
    widths = np.log(np.maximum(places.highest - places.lowest, NARROWEST))
    return np.concatenate([heights, middles, widths], axis=1)
