"""Who hangs from whom: what only touches a door beside or behind it does not hang from that."""

import numpy as np
import pytest

from artigen.types import FIXED, Part, PartLabel
from artigen.voxels.segmentation.neighbours import neighbour_pairs
from artigen.voxels.segmentation.tree import find_parents

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
    return find_parents(parts, coords, np.concatenate(ids), pairs)[len(CUPBOARD) :]


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


LEVER = ("knob", (slice(22, 24), slice(30, 32), slice(2, 20)))
LID = ("door", (slice(22, 26), slice(30, 32), slice(20, 22)))
TIP = ("door", (slice(26, 30), slice(30, 32), slice(20, 22)))


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_what_no_allowed_part_can_carry_hangs_from_what_it_touches(order):
    """A lid on a lever, and another lever on that lid; in whatever order they come."""
    parts = [(LEVER, LID, TIP)[index] for index in order]
    place = {name: len(CUPBOARD) + parts.index(part) for name, part in (("lever", LEVER), ("lid", LID))}
    wanted = {0: BASE, 1: place["lever"], 2: place["lid"]}
    assert parents_of(*parts) == [wanted[index] for index in order]


def test_what_touches_nothing_hangs_from_the_nearest_within_reach_and_else_from_none():
    def beside(gap: int):
        return parents_of(LEVER, ("door", (slice(24 + gap, 26 + gap), slice(30, 32), slice(18, 20))))[1]

    assert beside(0) == beside(1) == len(CUPBOARD)
    assert beside(2) is None
