"""What is found in the voxels of an object keeps the names and the tree of that object."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.datasets.relabel import restore_tree
from artigen.types import Asset
from artigen.voxels.fields import decode, encode
from artigen.voxels.segmentation.segment import segment


@pytest.fixture(scope="module")
def found(cabinet: Asset) -> Asset:
    return segment(decode(encode(cabinet)), name="x", scale=cabinet.scale)


def tree(asset: Asset) -> dict[str, str | None]:
    return {part.name: None if part.parent == -1 else asset.parts[part.parent].name for part in asset.parts}


def test_any_tree_becomes_that_of_the_source(cabinet, found):
    flat = replace(found, parts=tuple(replace(p, parent=min(p.parent, 0)) for p in found.parts))
    assert found.root == 0
    for given in (found, flat):
        restored = restore_tree(cabinet, given)
        assert tree(restored) == tree(cabinet)
        assert [part.box.tolist() for part in restored.parts] == [part.box.tolist() for part in given.parts]
    moved = [note for note in restore_tree(cabinet, flat).notes if "as in the source" in note]
    assert len(moved) == sum(p.parent not in (-1, cabinet.root) for p in cabinet.parts)


def test_parts_that_only_the_voxels_have_stay_and_children_of_lost_parts_go_up(cabinet, found):
    assert found.voxels is not None
    by_name = {part.name: index for index, part in enumerate(restore_tree(cabinet, found).parts)}
    door, lock = by_name["door"], by_name["lock"]
    # The door's cells are divided: neither half is the door, so the lock hangs from the body.
    cells = np.flatnonzero(found.voxels.part_ids == door)
    low = found.voxels.coords[cells, 2] < np.median(found.voxels.coords[cells, 2])
    ids = found.voxels.part_ids.copy()
    ids[cells[low]] = len(found.parts)
    half = replace(found.parts[door], name="other_half")
    split = replace(found, parts=(*found.parts, half), voxels=replace(found.voxels, part_ids=ids))
    restored = restore_tree(cabinet, split)
    names = [part.name for part in restored.parts]
    assert len(set(names)) == len(names)
    assert restored.parts[lock].name == "lock"
    assert "other_half" in names or "door" in names
