"""Faults of drawn objects: procedural ones have none; what cannot stand or is full of holes is found."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.mending.faults import find_asset_faults
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import PAPER_CATEGORIES, Asset, VoxelGrid


@pytest.fixture(scope="module")
def table() -> Asset:
    return shape_to_asset(draw_shape("Table", 0), 64)


def without(asset: Asset, gone: np.ndarray) -> Asset:
    voxels = asset.voxels
    assert voxels is not None
    kept = VoxelGrid(
        resolution=voxels.resolution, coords=voxels.coords[~gone], part_ids=voxels.part_ids[~gone]
    )
    return replace(asset, voxels=kept)


@pytest.mark.parametrize("category", PAPER_CATEGORIES)
def test_procedural_objects_have_none(category: str):
    for seed in range(3):
        assert find_asset_faults(shape_to_asset(draw_shape(category, seed), 64)) == ()


def test_a_table_without_the_legs_of_one_side_does_not_stand(table: Asset):
    assert table.voxels is not None
    coords = table.voxels.coords
    beside = coords[:, 1] < coords[:, 1].mean() + 4
    below = coords[:, 2] < np.quantile(coords[:, 2], 0.5)
    (fault,) = find_asset_faults(without(table, beside & below))
    assert fault.startswith("its middle lies -")  # outside of the legs that are left
    assert fault.endswith("cells within what it stands on")


def test_a_drawer_with_a_hole_in_its_front_is_found(table: Asset):
    assert table.voxels is not None
    number, drawer = next((k, part) for k, part in enumerate(table.parts) if part.label == "drawer")
    coords, own = table.voxels.coords, table.voxels.part_ids == number
    left = coords[:, 1] < coords[own][:, 1].mean()
    (fault,) = find_asset_faults(without(table, own & left))
    share = float(fault.removeprefix(f"{drawer.name} shows ").removesuffix(" % of its front"))
    assert 40 <= share <= 60


def test_an_object_without_voxels_is_not_judged(table: Asset):
    with pytest.raises(ValueError, match="no voxels"):
        find_asset_faults(replace(table, voxels=None))
