"""Corrects Gaussians that stray into a neighbouring part: reassigns or shrinks them.

A Gaussian moves with its part. One that lies in another part's cells, or reaches far beyond its own, hardly
shows while the object is closed. When the object opens, it floats in the air or leaves a spot.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from artigen.splats.parts import select_gaussians
from artigen.transforms import matrix_from_quat
from artigen.types import Asset, Gaussians, VoxelGrid

DEPTH = 0.2
"""A Gaussian in another part's cell, farther than this (cells) from every cell of its own, goes to that part.
Surface may lie up to 0.18 cells outside its cell (`artigen.voxels.surface`)."""
REACH = 1.0
"""Distance (cells) by which a Gaussian may reach beyond the cells of its part."""
DEVIATIONS = 2.0
"""Standard deviations at which a Gaussian counts as ended."""


def settle_seams(asset: Asset) -> Asset:
    """The asset with every Gaussian in or near the cells of its own part, with notes of what changed.

    Gaussians keep their order, position, rotation and colour. Strays get another part; wide ones are shrunk
    along the axes that reach too far. An asset without either is returned unchanged.

    Raises:
        ValueError: If the asset has no voxels or no Gaussians, or Gaussians of a part that has no cell.
    """
    gaussians, voxels = asset.gaussians, asset.voxels
    if gaussians is None or voxels is None:
        raise ValueError(f"asset {asset.name!r}: Gaussians and voxels are both needed to settle seams")
    owners = _find_owners(gaussians, voxels)
    strays = int(np.count_nonzero(owners != gaussians.part_ids))
    settled = replace(gaussians, part_ids=owners) if strays else gaussians
    shrink = _find_shrink(settled, voxels)
    wide = int(np.count_nonzero((shrink < 1.0).any(axis=1)))
    if not strays and not wide:
        return asset
    if wide:
        settled = replace(settled, scales=settled.scales * shrink)
    notes = []
    if strays:
        notes.append(f"{strays} of {len(owners)} Gaussians lay in another part's cells and now belong to it")
    if wide:
        notes.append(
            f"{wide} of {len(owners)} Gaussians stood over the cells of their part by more than "
            f"{REACH:g} cells and were made smaller"
        )
    return replace(asset, gaussians=settled, notes=(*asset.notes, *notes))


def _find_owners(gaussians: Gaussians, voxels: VoxelGrid) -> Int[np.ndarray, "N"]:
    """The part of each Gaussian: its own, unless it lies in a cell of another part and far from its own."""
    grid = np.full((voxels.resolution,) * 3, -1)
    grid[tuple(voxels.coords.T)] = voxels.part_ids
    cells = np.floor((gaussians.means.astype(np.float64) + 0.5) * voxels.resolution).astype(np.int64)
    inside = ((cells >= 0) & (cells < voxels.resolution)).all(axis=1)
    here = np.full(len(cells), -1)
    here[inside] = grid[tuple(cells[inside].T)]
    foreign = np.flatnonzero((here >= 0) & (here != gaussians.part_ids))
    owners = gaussians.part_ids.copy()
    away = distance_outside(select_gaussians(gaussians, foreign), voxels, np.zeros((len(foreign), 1, 3)))
    strays = foreign[away[:, 0] > DEPTH]
    owners[strays] = here[strays]
    return owners


def _find_shrink(gaussians: Gaussians, voxels: VoxelGrid) -> Float[np.ndarray, "N 3"]:
    """Factors on the scales that bring both ends of every axis within reach of the part's own cells."""
    shrink = np.ones((len(gaussians.means), 3))
    # Most Gaussians are small; only those that could exceed the reach are tested.
    large = np.flatnonzero(DEVIATIONS * gaussians.scales.max(axis=1) * voxels.resolution > 0.5 * REACH)
    if not len(large):
        return shrink
    some = select_gaussians(gaussians, large)
    axes = matrix_from_quat(some.quats) * (DEVIATIONS * some.scales[:, None, :].astype(np.float64))
    columns = np.swapaxes(axes, 1, 2)
    ends = np.concatenate([columns, -columns], axis=1)
    factors = np.ones((len(large), 3))
    for _ in range(32):  # bounded, because a mean beyond the reach of its part never comes within it
        beyond = distance_outside(some, voxels, ends * np.tile(factors, 2)[:, :, None]) > REACH
        too_far: Bool[np.ndarray, "M 3"] = beyond[:, :3] | beyond[:, 3:]
        if not too_far.any():
            break
        factors = np.where(too_far, 0.75 * factors, factors)
    shrink[large] = factors
    return shrink


def distance_outside(
    gaussians: Gaussians, voxels: VoxelGrid, offsets: Float[np.ndarray, "N K 3"]
) -> Float[np.ndarray, "N K"]:
    """Distance in cells from points at ``offsets`` to the means to the nearest cell of the part; 0 inside.

    It is the maximum over the axes, because cells are cubes.

    Raises:
        ValueError: If a part has Gaussians and no cell.
    """
    places = (gaussians.means[:, None].astype(np.float64) + offsets + 0.5) * voxels.resolution
    away = np.zeros(places.shape[:2])
    for part in np.unique(gaussians.part_ids):
        cells = voxels.coords[voxels.part_ids == part]
        rows = gaussians.part_ids == part
        if not len(cells):
            raise ValueError(f"part {part} has {int(rows.sum())} Gaussians and no cell")
        nearest = KDTree(cells + 0.5).query(places[rows].reshape(-1, 3), p=np.inf)[0]
        away[rows] = np.maximum(np.asarray(nearest).reshape(-1, places.shape[1]) - 0.5, 0.0)
    return away
