"""Owners and fields say the same: whichever way they are read, every cell belongs to its part."""

import numpy as np

from artigen.fields import VoxelFields
from artigen.mending.rows import Owners, fields_of_owners, read_owners
from artigen.types import Asset


def test_cells_belong_to_the_parts_of_their_object(cabinet: Asset, cabinet_owners: Owners):
    voxels = cabinet.voxels
    assert voxels is not None
    assert (cabinet_owners[tuple(voxels.coords.T)] == voxels.part_ids).all()
    assert (cabinet_owners >= 0).sum() == len(voxels.coords)


def test_owners_are_read_back_from_their_fields(
    cabinet_fields: VoxelFields, cabinet_owners: Owners, cabinet_rows: np.ndarray
):
    fewer = np.where(
        np.arange(cabinet_owners.size).reshape(cabinet_owners.shape) % 3 == 0, -1, cabinet_owners
    )
    again = read_owners(fields_of_owners(fewer, cabinet_rows, cabinet_fields), cabinet_rows)
    assert (again == fewer).all()
