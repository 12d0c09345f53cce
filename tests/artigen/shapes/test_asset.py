"""Exact voxels of shapes: where the surface is, with all parts, large and small."""

import numpy as np
import pytest

from artigen.shapes.asset import shape_to_asset, voxelize_shape
from artigen.shapes.draw import draw_shape
from artigen.shapes.rasterize import rasterize_shape
from artigen.voxels.fields import CHANNELS, encode
from artigen.voxels.voxelize import drop_unresolved


def test_voxels_are_those_that_the_surface_crosses():
    shape = draw_shape("Oven", 0)
    asset = voxelize_shape(shape)
    assert asset.voxels is not None
    cells = np.unique(rasterize_shape(shape, 64).cells, axis=0)
    np.testing.assert_array_equal(asset.voxels.coords[np.lexsort(asset.voxels.coords.T[::-1])], cells)
    field = encode(asset)
    assert field.shape == (CHANNELS, 64, 64, 64)
    assert np.count_nonzero(field[0]) == len(cells)


def test_small_parts_are_kept_and_noted_until_they_are_dropped():
    for seed in range(20):
        shape = draw_shape("WashingMachine", seed)
        asset, known = voxelize_shape(shape, 16), shape_to_asset(shape, 16)
        assert len(asset.parts) == len(shape.parts)
        assert asset.voxels is not None
        assert known.voxels is not None
        resolved = drop_unresolved(asset)
        assert resolved.voxels is not None
        np.testing.assert_array_equal(resolved.voxels.part_ids, known.voxels.part_ids)
        assert [part.name for part in resolved.parts] == [part.name for part in known.parts]
        if len(np.unique(asset.voxels.part_ids)) < len(asset.parts):
            assert "smaller than a voxel" in asset.notes[0]
            break
    else:
        pytest.fail("no part of twenty objects is smaller than a voxel of 16^3")
