"""Voxels for Gaussians and the direction of their sides, from the surface inside them.

A cell belongs to one part. Where two parts touch, one of them may be left without cells, and its surface
would be bare once the object opens, like the inside of a door that lies on the rim of its body. Such surface
gets a free cell beneath it. A voxel's sides face along the axis that most of its surface faces along.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.types import SurfaceSamples, VoxelGrid
from artigen.voxels.frames import find_facings, find_outward, gather_voxels, mark_voxels
from artigen.voxels.surface import SAMPLES, VoxelPlaces, find_voxels

DEPTHS = (0.5, 1.0)
"""Depths in voxels, below surface in no voxel of its part, at which that part may take a free cell."""
MORE = 1.5
"""Factor by which more surface must face along another axis before a voxel turns; it steadies rims."""
ENOUGH = SAMPLES**2 // 4
"""Least number of samples for which a cell is taken: those of a quarter of a voxel's side."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Canvas:
    """The voxels of a structure, for which Gaussians are predicted."""

    coords: Int[np.ndarray, "N 3"]
    """Cells (x, y, z) at the model's resolution."""
    part_ids: Int[np.ndarray, "N"]
    """Part of each voxel."""
    facings: Int[np.ndarray, "N"]
    """Direction of the outer side of each voxel (`artigen.voxels.frames`)."""
    table: Float[np.ndarray, "P C"]
    """Channels after occupancy of each part (`artigen.voxels.fields.tabulate_parts`)."""
    places: VoxelPlaces | None = None
    """Position of the surface within each voxel, for models that take it."""


def lay_out(surface: SurfaceSamples, voxels: VoxelGrid) -> tuple[VoxelGrid, Int[np.ndarray, "N"]]:
    """Voxels that cover all of a surface, and the direction (0 to 5) that the outer side of each faces.

    Args:
        surface: Samples, `artigen.voxels.surface.SAMPLES` along a voxel's edge.
    """
    covered = cover_surface(surface, voxels)
    facings = find_facings(covered.coords, covered.part_ids, covered.resolution)
    return covered, turn_facings(surface, covered, facings)


def cover_surface(surface: SurfaceSamples, voxels: VoxelGrid) -> VoxelGrid:
    """Adds free cells beneath surface that lies only in cells of other parts."""
    edge = voxels.resolution
    lost = ~find_voxels(surface, voxels)[1]
    owners = mark_voxels(voxels.coords, voxels.part_ids, edge)
    points, normals = ((values[lost].astype(np.float64)) for values in (surface.points, surface.normals))
    part_ids = surface.part_ids[lost].astype(np.int64)
    parts = int(max(surface.part_ids.max(), voxels.part_ids.max())) + 1
    waiting = np.ones(len(points), dtype=bool)
    for depth in DEPTHS:
        rows = np.flatnonzero(waiting)
        cells = np.floor((points[rows] + 0.5) * edge - depth * normals[rows]).astype(np.int64)
        inside = np.flatnonzero(((cells >= 0) & (cells < edge)).all(axis=1))
        free = inside[owners[tuple(cells[inside].T)] < 0]
        rows, flat = rows[free], np.ravel_multi_index(tuple(cells[free].T), owners.shape)
        pairs, count = np.unique(flat * parts + part_ids[rows], return_counts=True)
        taken, part = np.divmod(pairs[count >= ENOUGH], parts)
        most = np.lexsort((part, -count[count >= ENOUGH], taken))
        taken, first = np.unique(taken[most], return_index=True)
        owners.ravel()[taken] = part[most][first]
        waiting[rows] = owners.ravel()[flat] != part_ids[rows]
    return gather_voxels(owners)


def turn_facings(
    surface: SurfaceSamples, voxels: VoxelGrid, facings: Int[np.ndarray, "N"]
) -> Int[np.ndarray, "N"]:
    """Turns facings to the axis that most of the surface in each voxel faces along, by a factor of `MORE`.

    Args:
        surface: Samples, each of the same area.
    """
    rows, own = find_voxels(surface, voxels)
    squares = surface.normals[own].astype(np.float64) ** 2
    areas = np.stack([np.bincount(rows, weights=one, minlength=len(facings)) for one in squares.T], axis=1)
    more = areas.max(axis=1) > MORE * areas[np.arange(len(facings)), facings // 2] + 1e-6
    axes = np.where(more, areas.argmax(axis=1), facings // 2)
    return np.where(more, find_outward(voxels.coords, voxels.part_ids, axes), facings)
