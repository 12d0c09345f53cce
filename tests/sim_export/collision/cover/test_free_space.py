"""Space is enclosed unless others pass through it, and boxes cover what is aligned and large enough."""

import numpy as np
import pytest

from sim_export.collision.cover.free_space import (
    FreeSpace,
    cover_with_boxes,
    find_free_space,
    look_up,
    measure_intrusion,
)
from sim_export.geometry.grid import Grid
from sim_export.geometry.hulls import box_hull, hull_planes, hull_width

CUBE = box_hull(np.zeros(3), np.ones(3))


def test_cells_of_a_small_link_are_0_0025_of_the_diagonal_of_the_object():
    small = 0.1 * CUBE.vertices[CUBE.faces]
    assert find_free_space(small, 1.0).grid.cell == pytest.approx(0.0025, rel=0.02)


@pytest.mark.parametrize(("more", "free"), [(0, False), (1, True)])
def test_a_room_is_free_if_others_pass_through_a_tenth_of_it_by_blocks_of_six_cells(more, free):
    """Others are in single cells, eight apart; each of them counts as 6^3 cells."""
    surface = CUBE.vertices[CUBE.faces]
    alone = find_free_space(surface, 10.0)
    room = (alone.depth == 0.0) & (alone.away > 0.0)
    cells = np.argwhere(room[4::8, 4::8, 4::8])[: int(0.1 * room.sum() / 6**3) + more]
    others = alone.grid.low + (4 + 8 * cells + 0.5) * alone.grid.cell
    shared = find_free_space(surface, 10.0, others)
    assert (look_up(np.full((1, 3), 0.48), shared.depth, shared.grid)[0] > 0.0) == free


@pytest.mark.parametrize(("cells", "found"), [(4000, True), (4001, False)])
def test_all_cells_of_a_hull_are_tested_if_they_are_4000_at_most(cells, found):
    """Of a rod with more, every second one is: free space in its second cell goes unseen."""
    depth = np.zeros((cells, 1, 1), dtype=np.float32)
    depth[1] = 0.5
    space = FreeSpace(grid=Grid(low=np.zeros(3), cell=1.0, shape=depth.shape), away=depth, depth=depth)
    bounds = np.array([[0.0, 0.0, 0.0], [cells, 1.0, 1.0]])
    rod = box_hull(*bounds)
    assert (measure_intrusion(hull_planes(rod), bounds, space, 0.1).volume > 0.0) == found


def sheets(*places: tuple[int, int, int, int]):
    """Triangles of level sheets between cells of an edge of 1 m, and space that is enclosed around them only.

    Each is given by its first cell in x and y and by how many cells it has. It is there three times, so that
    every cell of it is seen.
    """
    shape = (*(max(place[axis] + place[axis + 2] for place in places) + 2 for axis in range(2)), 5)
    depth = np.ones(shape, dtype=np.float32)
    triangles = []
    for x, y, length, width in places:
        depth[x : x + length, y : y + width, 2] = 0.0
        a, b, c, d = (
            np.array([x + i * length, y + j * width, 2.5]) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
        )
        triangles += 3 * [[a, b, c], [a, c, d]]
    return np.array(triangles), FreeSpace(
        grid=Grid(low=np.zeros(3), cell=1.0, shape=shape), away=depth, depth=depth
    )


@pytest.mark.parametrize(("length", "boxes"), [(47, 0), (48, 1)])
def test_a_box_covers_48_cells_of_surface(length, boxes):
    assert len(cover_with_boxes(*sheets((1, 1, length, 1)))) == boxes


@pytest.mark.parametrize(("width", "boxes"), [(19, 1), (21, 2)])
def test_a_box_covers_two_thousandths_of_the_surface(width, boxes):
    """Beside a sheet of 30,000 cells."""
    assert len(cover_with_boxes(*sheets((1, 1, 200, 150), (1, 153, 3, width)))) == boxes


@pytest.mark.parametrize(("count", "boxes"), [(64, 64), (65, 64)])
def test_a_link_gets_64_boxes_at_most(count, boxes):
    places = [(1 + 9 * (number % 9), 1 + 9 * (number // 9), 8, 8) for number in range(count)]
    assert len(cover_with_boxes(*sheets(*places))) == boxes


def test_the_box_of_a_sheet_is_two_millimetres_thick():
    (box,) = cover_with_boxes(*sheets((1, 1, 10, 10)))
    assert hull_width(box)[0] == pytest.approx(0.002)
