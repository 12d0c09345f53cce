"""Samples of the meshes that voxels become: evenly on them, outwards, near the surface of the object."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from drawer_chest import make_chest

from artigen.examples.appearance import sample_parts
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import Asset
from artigen.voxels.frames import find_facings
from artigen.voxels.surface import measure_places
from sim_export.geometry.meshing import mesh_parts
from sim_export.geometry.surface import SAMPLES, sample_surface


@pytest.fixture(scope="module")
def chest() -> Asset:
    return shape_to_asset(make_chest(), 32)


def test_samples_lie_on_the_meshes_of_their_parts_and_face_outwards(chest: Asset):
    surface = sample_surface(chest)
    for part, mesh in enumerate(mesh_parts(chest)):
        own = surface.part_ids == part
        solid = trimesh.Trimesh(mesh.vertices / chest.scale, mesh.faces, process=False)
        points, normals = surface.points[own].astype(float), surface.normals[own].astype(float)
        assert np.count_nonzero(own) == pytest.approx(solid.area * (SAMPLES * 32) ** 2, abs=1)
        some = slice(None, None, 97)
        _, distance, _ = trimesh.proximity.closest_point(solid, points[some])
        assert distance.max() < 1e-6
        beyond = points[some] + 0.1 / 32 * normals[some]
        assert not solid.contains(beyond).any()
        assert solid.contains(points[some] - 0.1 / 32 * normals[some]).all()


def test_samples_do_not_depend_on_the_scale(chest: Asset):
    one, twice = sample_surface(chest), sample_surface(replace(chest, scale=2.0 * chest.scale))
    np.testing.assert_allclose(one.points, twice.points, atol=1e-6)
    np.testing.assert_array_equal(one.part_ids, twice.part_ids)


@pytest.mark.slow
@pytest.mark.parametrize("category", ["StorageFurniture", "Microwave"])
def test_surface_made_of_voxels_lies_near_the_objects_own(category: str):
    """Within a third of a voxel, which is what one knows of a wall from the cells that it crosses."""
    shape = draw_shape(category, 3)
    asset = shape_to_asset(shape, 64)
    assert asset.voxels is not None
    facings = find_facings(asset.voxels.coords, asset.voxels.part_ids, 64)
    made, true = (
        measure_places(surface, asset.voxels, facings)
        for surface in (sample_surface(asset), sample_parts(shape, asset, 1 / (SAMPLES * 64)))
    )
    assert np.median(np.abs(made.heights - true.heights)) < 1 / 3
    assert np.median(np.abs(made.highest - true.highest)) < 0.1
    assert np.median(np.abs(made.lowest - true.lowest)) < 0.1
