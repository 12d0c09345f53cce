"""The surface of a box as samples in voxels."""

import numpy as np

from artigen.types import SurfaceSamples
from artigen.voxels.surface import SAMPLES

EDGE = 16
MISSED = 1.0 / SAMPLES


def sample_box(low: np.ndarray, high: np.ndarray, part: int = 0) -> SurfaceSamples:
    """The surface of a box (voxels), `SAMPLES` samples along a voxel's edge."""
    points, normals = [], []
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        lines = [np.arange(low[other] + MISSED / 2, high[other], MISSED) for other in others]
        face = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
        for sign, level in ((-1.0, low[axis]), (1.0, high[axis])):
            points.append(np.insert(face, axis, level, axis=1))
            normals.append(np.tile(sign * np.eye(3)[axis], (len(face), 1)))
    where = np.concatenate(points)
    return SurfaceSamples(
        points=where / EDGE - 0.5,
        normals=np.concatenate(normals),
        colors=np.zeros(where.shape, dtype=np.uint8),
        part_ids=np.full(len(where), part),
    )
