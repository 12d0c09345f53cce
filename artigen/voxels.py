"""Surfaces to voxels: labels by area majority."""

import numpy as np

from artigen.types import SurfaceSamples, VoxelGrid


def voxelize(surface: SurfaceSamples, resolution: int = 64) -> VoxelGrid:
    """Marks every cell that holds a sample; the part with the most samples (area) owns it.

    Points on the far faces of the unit cube count to the last cell. Ties go to the lower part id.
    """
    cells = np.floor((surface.points.astype(np.float64) + 0.5) * resolution).astype(np.int64)
    cells = np.clip(cells, 0, resolution - 1)
    flat = np.ravel_multi_index(tuple(cells.T), (resolution,) * 3)
    pairs, areas = np.unique(np.stack([flat, surface.part_ids]), axis=1, return_counts=True)
    order = np.lexsort((pairs[1], -areas, pairs[0]))
    owners, first = np.unique(pairs[0][order], return_index=True)
    coords = np.stack(np.unravel_index(owners, (resolution,) * 3), axis=1)
    return VoxelGrid(resolution=resolution, coords=coords, part_ids=pairs[1][order][first])
