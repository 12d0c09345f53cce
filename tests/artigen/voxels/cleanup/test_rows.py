"""Fields are read back as the parts that their cells belong to."""

from artigen.types import Asset
from artigen.voxels.cleanup.rows import Owners


def test_cells_belong_to_the_parts_of_their_object(cabinet: Asset, cabinet_owners: Owners):
    voxels = cabinet.voxels
    assert voxels is not None
    assert (cabinet_owners[tuple(voxels.coords.T)] == voxels.part_ids).all()
    assert (cabinet_owners >= 0).sum() == len(voxels.coords)
