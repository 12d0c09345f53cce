"""Samples of meshes that are made of voxels: so many on an area, and white."""

import numpy as np
import pytest

from artigen.types import FIXED, Asset, Part, VoxelGrid
from sim_export.geometry.surface import sample_surface


def test_a_voxel_has_sixteen_white_samples_on_each_face():
    """A cube of 8 x 8 x 8 voxels."""
    cells = np.argwhere(np.ones((8, 8, 8), dtype=bool)) + 4
    part = Part(name="base", label="base", parent=-1, joint=FIXED, box=np.array([[0.0] * 3, [0.5] * 3]))
    voxels = VoxelGrid(resolution=16, coords=cells, part_ids=np.zeros(len(cells), dtype=int))
    surface = sample_surface(Asset(name="cube", category="Box", scale=1.0, parts=(part,), voxels=voxels))
    assert len(surface.points) == pytest.approx(16 * 6 * 8 * 8, abs=1)
    assert (surface.colors == 255).all()
