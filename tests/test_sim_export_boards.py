"""Boards are solid, compartments stay free."""

import numpy as np
import pytest

from artigen.types import VoxelGrid
from sim_export.boards import fill_boards


def shell(low, high) -> set:
    """Surface cells of a block."""
    cells = np.argwhere(np.ones(np.array(high) - low, dtype=bool))
    on_face = (cells == 0) | (cells == np.array(high) - low - 1)
    return {tuple(cell) for cell in cells[on_face.any(axis=1)] + low}


def grid_of(*parts: set) -> VoxelGrid:
    """Cells of several parts; the first owner keeps a cell."""
    owner: dict = {}
    for index, cells in enumerate(parts):
        for cell in sorted(cells):
            owner.setdefault(cell, index)
    coords = np.array(sorted(owner))
    part_ids = np.array([owner[tuple(cell)] for cell in coords], dtype=np.int16)
    return VoxelGrid(resolution=32, coords=coords, part_ids=part_ids)


@pytest.mark.parametrize("thickness", [3, 4, 5])
def test_a_board_whose_edge_another_part_owns_becomes_solid(thickness):
    board = shell([8, 4, 10], [20, 28, 10 + thickness])
    front = shell([7, 4, 4], [9, 28, 26])  # takes the board's front cells
    filled, count = fill_boards(grid_of(front, board))
    assert count == 10 * 22 * (thickness - 2)
    inside = (filled.coords[:, 0] > 8) & (filled.coords[:, 0] < 19) & (filled.coords[:, 2] == 11)
    assert (filled.part_ids[inside] == 1).all()


def test_a_closed_compartment_stays_free():
    grid = grid_of(shell([4, 4, 4], [20, 20, 12]))
    filled, count = fill_boards(grid)
    assert count == 0
    assert filled is grid


def test_an_open_slot_stays_free():
    left, right = shell([4, 4, 4], [20, 6, 20]), shell([4, 8, 4], [20, 10, 20])
    assert fill_boards(grid_of(left | right))[1] == 0
