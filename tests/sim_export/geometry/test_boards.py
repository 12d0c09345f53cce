"""Boards are solid, compartments stay free."""

import numpy as np
import pytest

from artigen.types import VoxelGrid
from sim_export.geometry.boards import fill_boards


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


def test_the_room_in_a_flat_drawer_is_no_board():
    """A tray three cells high right under a table top: a closed flat space, but between two links."""
    top = shell([2, 2, 14], [26, 26, 17])
    drawer = {
        (x, y, z)
        for x in range(6, 20) for y in range(8, 22) for z in range(11, 14)
        if z == 11 or x in (6, 19) or y in (8, 21)
    }  # fmt: skip
    grid = grid_of(top, drawer)
    board = 22 * 22  # the middle layer of the top itself
    filled, count = fill_boards(grid, owners=[0, 1])
    assert count == board
    assert not ((filled.coords[:, 2] < 14) & (filled.part_ids == 0)).any()
    assert fill_boards(grid, owners=[0, 0])[1] == fill_boards(grid)[1] == board + 12 * 12 * 2


@pytest.mark.parametrize(("gap", "filled"), [(3, 10 * 22 * 3), (4, 0)])
def test_a_space_of_more_than_three_cells_is_a_compartment(gap: int, filled: int):
    board = shell([8, 4, 10], [20, 28, 12 + gap])
    assert fill_boards(grid_of(board))[1] == filled


@pytest.mark.parametrize(("foreign", "filled"), [(59, 100), (60, 0)])
def test_a_space_is_no_board_if_a_quarter_of_its_walls_are_anothers(foreign: int, filled: int):
    """Of 240 sides of cells around a gap of 10 x 10 cells, some are those of a lid."""
    lid = {(10 + n // 10, 10 + n % 10, 12) for n in range(foreign)}
    grid = grid_of(lid, shell([9, 9, 10], [21, 21, 13]))
    assert fill_boards(grid, owners=[0, 1])[1] == filled
