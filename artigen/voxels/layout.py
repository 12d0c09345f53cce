"""Voxels for Gaussians and the direction of their sides, from the surface inside them.

A cell of a grid belongs to one part. Where two parts touch, one of them may be left without cells, and its
surface would be bare once the object opens: the inside of a door where it lies on the rim of its body. And a
voxel has two sides, so the axis that most of its surface faces along is the one that shows most of it.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.types import SurfaceSamples, VoxelGrid
from artigen.voxels.frames import find_facings, find_outward, mark_voxels
from artigen.voxels.surface import SAMPLES, VoxelPlaces, find_voxels

DEPTHS = (0.5, 1.0)
"""Voxels beneath surface that lies in no voxel of its part at which a free cell is taken for it."""
MORE = 1.5
"""Times as much surface that must face along another axis for a voxel to turn, so that rims do not waver."""
ENOUGH = SAMPLES**2 // 4
"""Samples for which a cell is taken: of a quarter of a voxel's side."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Canvas:
    """The voxels of a structure, which Gaussians are drawn for."""

    coords: Int[np.ndarray, "N 3"]
    """In the model's resolution."""
    part_ids: Int[np.ndarray, "N"]
    """Part of each."""
    facings: Int[np.ndarray, "N"]
    """Direction of the outer side of each (`artigen.voxels.frames`)."""
    table: Float[np.ndarray, "P C"]
    """Channels after occupancy of each part (`artigen.voxels.fields.tabulate_parts`)."""
    places: VoxelPlaces | None = None
    """Where the surface of each lies, for models that are told."""


def lay_out(surface: SurfaceSamples, voxels: VoxelGrid) -> tuple[VoxelGrid, Int[np.ndarray, "N"]]:
    """Voxels for all of a surface, and the direction (0 to 5) that the outer side of each faces.

    Args:
        surface: Samples, `artigen.voxels.surface.SAMPLES` along a voxel's edge.
        voxels: Cells that it passes through.
    """
    covered = cover_surface(surface, voxels)
    facings = find_facings(covered.coords, covered.part_ids, covered.resolution)
    return covered, turn_facings(surface, covered, facings)


def cover_surface(surface: SurfaceSamples, voxels: VoxelGrid) -> VoxelGrid:
    """The voxels, and free cells beneath surface that lies in cells of other parts alone.

    Args:
        surface: Samples, `artigen.voxels.surface.SAMPLES` along a voxel's edge.
        voxels: Cells that it passes through, each of one part.
    """
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
    coords = np.argwhere(owners >= 0)
    return VoxelGrid(resolution=edge, coords=coords, part_ids=owners[tuple(coords.T)])


def turn_facings(
    surface: SurfaceSamples, voxels: VoxelGrid, facings: Int[np.ndarray, "N"]
) -> Int[np.ndarray, "N"]:
    """Facings along the axis that most of the surface in each voxel faces along, where it is `MORE`.

    Args:
        surface: Samples, each of the same area.
        voxels: Cells of the same object.
        facings: Directions of their outer sides as the voxels alone tell them (`artigen.voxels.frames`).
    """
    rows, own = find_voxels(surface, voxels)
    squares = surface.normals[own].astype(np.float64) ** 2
    areas = np.stack([np.bincount(rows, weights=one, minlength=len(facings)) for one in squares.T], axis=1)
    more = areas.max(axis=1) > MORE * areas[np.arange(len(facings)), facings // 2] + 1e-6
    axes = np.where(more, areas.argmax(axis=1), facings // 2)
    return np.where(more, find_outward(voxels.coords, voxels.part_ids, axes), facings)
