"""Samples the exported meshes of an object that has voxels only."""

import numpy as np

from artigen.types import Asset, SurfaceSamples
from sim_export.geometry.meshing import mesh_parts
from sim_export.geometry.occupancy import require_voxels
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import area_normals, triangle_areas

SAMPLES = 4
"""Samples along the edge of a voxel."""
UNPAINTED = 255
"""Colour of samples; the meshes have no colour."""


def sample_surface(asset: Asset) -> SurfaceSamples:
    """White sample points of equal area on the meshes of all parts, in the unit cube.

    Args:
        asset: Asset with voxels; of the parts only the boxes are used.

    Raises:
        DegeneratePart: If a part has no voxels.
        ValueError: If the asset has no voxels.
    """
    triangles = [mesh.vertices[mesh.faces] / asset.scale for mesh in mesh_parts(asset)]
    per_area = (SAMPLES * require_voxels(asset).resolution) ** 2
    points, normals, part_ids = [], [], []
    for part, corners in enumerate(triangles):
        count = int(np.ceil(triangle_areas(corners).sum() * per_area))
        found, rows = sample_triangles(corners, count)
        across = area_normals(corners)[rows]
        points.append(found)
        normals.append(across / np.linalg.norm(across, axis=1, keepdims=True))
        part_ids.append(np.full(count, part))
    where = np.concatenate(points)
    return SurfaceSamples(
        points=where,
        normals=np.concatenate(normals),
        colors=np.full(where.shape, UNPAINTED, dtype=np.uint8),
        part_ids=np.concatenate(part_ids),
    )
