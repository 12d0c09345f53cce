"""Both sides of what counts as the inside of a part, as its foot, and as a layer that it shares."""

from collections.abc import Callable

import numpy as np
import pytest

from artigen.types import VoxelGrid
from sim_export.geometry.occupancy import PartOccupancy, part_occupancy

EDGE = 40


def solid_of(
    mine: np.ndarray, others: np.ndarray, box: np.ndarray | None = None, *, leaf: bool = False
) -> PartOccupancy:
    """The first part's solid beside another part."""
    cells = np.concatenate([np.argwhere(mine), np.argwhere(others)])
    ids = np.repeat([0, 1], [np.count_nonzero(mine), np.count_nonzero(others)])
    return part_occupancy(VoxelGrid(resolution=EDGE, coords=cells, part_ids=ids), 0, box, leaf=leaf)


def shell(depth: int) -> tuple[np.ndarray, np.ndarray]:
    """A closed hollow leaf with so many free layers inside, and no cells of others."""
    mine, others = np.zeros((2, EDGE, EDGE, EDGE), dtype=bool)
    mine[2 : depth + 4, 2:32, 2:32] = True
    mine[3 : depth + 3, 3:31, 3:31] = False
    return mine, others


def inside(depth: int, *, slots: int = 0, wide: int = 1, long: int = 24, lodgers: int = 0) -> bool:
    """Whether a hollow leaf becomes solid in whose front others stand in slots, or that holds something."""
    mine, others = shell(depth)
    for slot in range(slots):
        start = 4 + 3 * slot
        others[1:4, start : start + wide, 4 : 4 + long] = True
    others[6, 20, 10 : 10 + lodgers] = True
    return bool(solid_of(mine & ~others, others).occupancy[depth + 2, 30, 30])


def is_foot(cells: int) -> bool:
    """Whether a board is whole beneath what another part stands on, of so many cells."""
    mine, others = np.zeros((2, EDGE, EDGE, EDGE), dtype=bool)
    mine[10:13, 2:38, 2:38] = True
    others[12, 4 : 4 + cells // 4, 4:8] = True
    others[12, 4 + cells // 4, 4 : 4 + cells % 4] = True
    others[13] = others[12]
    return bool(solid_of(mine & ~others, others).occupancy[12, 5, 5])


def closed_by(*, knob: bool) -> bool:
    """Whether a hollow box with an opening of 100 cells becomes solid behind what fills the opening."""
    mine, others = shell(10)
    others[2, 5:15, 5:15] = True
    cells = np.concatenate([np.argwhere(mine & ~others), np.argwhere(others)])
    ids = np.repeat([0, 1], [np.count_nonzero(mine & ~others), np.count_nonzero(others)])
    grid = VoxelGrid(resolution=EDGE, coords=cells, part_ids=ids)
    solid = part_occupancy(grid, 0, fittings=(1,) if knob else ())
    assert not (solid.occupancy & others).any()
    return bool(solid.occupancy[8, 20, 20])


def is_closed_by_what_it_lies_on(reach: float, *, leaf: bool = True) -> bool:
    """Whether a hollow leaf is solid whose back is another part's, in a box that reaches so far behind."""
    mine, others = shell(3)
    others[6, 4:28, 4:28] = True
    box = np.array([[2.0, 2.0, 2.0], [6.0 + reach, 32.0, 32.0]])
    solid = solid_of(mine & ~others, others, box, leaf=leaf)
    assert not (solid.occupancy & others).any()
    return bool(solid.occupancy[4, 20, 20])


def is_shared(share: float) -> bool:
    """Whether a layer at the face of a part's box is its own, of a tenth of which it has a share."""
    mine, others = np.zeros((2, EDGE, EDGE, EDGE), dtype=bool)
    mine[10:13, 10:30, 10:30] = True
    others[13, 10:30, 10:30] = True
    others[13, 10 : 10 + round(20 * share), 10:30] = False
    mine[13] = mine[12] & ~others[13]
    box = np.array([[10.0, 10.0, 10.0], [14.0, 30.0, 30.0]])
    return bool(solid_of(mine, others, box).occupancy[13, 29, 29])


ROWS: dict[str, tuple[Callable[[], bool], Callable[[], bool]]] = {
    "a leaf of six cells": (lambda: inside(6, slots=1), lambda: inside(7, slots=1)),
    "openings of three by three": (
        lambda: inside(3, slots=1, wide=2),
        lambda: inside(3, slots=1, wide=3, long=3),
    ),
    "seams of a tenth of the wall": (lambda: inside(2, slots=8), lambda: inside(2, slots=9)),
    "lodgers of eight cells": (lambda: inside(8, lodgers=7), lambda: inside(8, lodgers=8)),
    "what a knob closes": (lambda: closed_by(knob=True), lambda: closed_by(knob=False)),
    "what a leaf lies on, as far as its box reaches": (
        lambda: is_closed_by_what_it_lies_on(1.0),
        lambda: is_closed_by_what_it_lies_on(0.99),
    ),
    "what a leaf lies on, and not a drawer": (
        lambda: is_closed_by_what_it_lies_on(1.0),
        lambda: is_closed_by_what_it_lies_on(1.0, leaf=False),
    ),
    "a foot of sixteen cells": (lambda: is_foot(16), lambda: is_foot(17)),
    "a share of 0.15": (lambda: is_shared(0.15), lambda: is_shared(0.10)),
}


@pytest.mark.parametrize("name", ROWS)
def test_what_is_solid_and_what_is_not_any_more(name: str):
    solid, free = ROWS[name]
    assert (solid(), free()) == (True, False)
