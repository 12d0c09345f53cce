"""Who hangs from whom: what only touches a door beside or behind it does not hang from that."""

import numpy as np
import pytest

from artigen.types import FIXED, Part, PartLabel
from artigen.voxels.segmentation.neighbours import neighbour_pairs
from artigen.voxels.segmentation.tree import TreeConfig, find_parents

BASE, DOOR, DRAWER = 0, 1, 2
Box = tuple[slice, slice, slice]
CUPBOARD: tuple[tuple[PartLabel, Box], ...] = (
    ("base", (slice(8, 24), slice(0, 32), slice(0, 2))),
    ("door", (slice(4, 8), slice(0, 16), slice(14, 32))),
    ("drawer", (slice(4, 20), slice(0, 32), slice(2, 14))),
)


def parents_of(*more: tuple[PartLabel, Box]) -> list[int | None]:
    """Of a floor, a deep door, a drawer below it, and other parts."""
    parts, cells, ids = [], [], []
    for index, (label, place) in enumerate((*CUPBOARD, *more)):
        owned = np.argwhere(np.ones((32, 32, 32), bool)[place]) + [one.start for one in place]
        low, high = np.array([(one.start, one.stop) for one in place]).T
        box = np.stack([(low + high) / 2, high - low]) / 32 - [[0.5], [0.0]]
        parts.append(Part(name=f"part_{index}", label=label, parent=index and 0, joint=FIXED, box=box))
        cells.append(owned)
        ids.append(np.full(len(owned), index))
    coords = np.concatenate(cells)
    pairs = neighbour_pairs(coords, 32)
    return find_parents(parts, coords, np.concatenate(ids), pairs, TreeConfig())[len(CUPBOARD) :]


def test_a_shelf_that_meets_a_door_more_than_the_body_rests_in_the_body():
    body = ("base", (slice(12, 13), slice(31, 32), slice(20, 22)))
    shelf = ("shelf", (slice(8, 24), slice(0, 31), slice(20, 22)))
    assert parents_of(body, shelf)[1] == len(CUPBOARD)


def test_a_bin_hangs_from_the_door_that_it_is_in():
    assert parents_of(("shelf", (slice(6, 8), slice(2, 14), slice(20, 22)))) == [DOOR]


@pytest.mark.parametrize(("z", "panel"), [(13, DRAWER), (15, DOOR)])
def test_a_handle_across_an_edge_sits_on_what_its_middle_lies_before(z: int, panel: int):
    handle = ("handle", (slice(3, 4), slice(2, 14), slice(z - 1, z + 2)))
    assert parents_of(handle) == [panel]


def test_a_handle_that_touches_one_panel_only_sits_on_that():
    """However far it reaches over: the nearest guess where there is no better one."""
    assert parents_of(("handle", (slice(3, 4), slice(12, 32), slice(20, 22)))) == [DOOR]
