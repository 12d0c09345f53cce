"""Laws of neighbours: where a part's box ends at another part, that part's surface is known exactly."""

import numpy as np
import pytest

from artigen.types import VoxelGrid
from sim_export.geometry.face_planes import DIRECTIONS, INSET, JOINT_ROOM, fit_face_planes
from sim_export.geometry.meshing import mesh_occupancy
from sim_export.geometry.neighbours import NeighbourFaces, find_neighbour_faces

BLOCK = np.array([[6.0, 2.0, 2.0], [18.0, 18.0, 18.0]])


def scene(back: float) -> tuple[VoxelGrid, list[np.ndarray]]:
    """A block whose front is at 6 or 7, and a knob in front of it that ends at ``back``.

    A rim of the block, one cell further out, keeps its box from telling where the front is.
    """
    block = np.zeros((20, 20, 20), dtype=bool)
    block[7:18, 2:18, 2:18] = True
    block[6, 2:18, 2:4] = True
    knob = np.zeros_like(block)
    knob[4 : int(np.ceil(back)), 8:12, 8:12] = True
    knob &= ~block
    coords = np.concatenate([np.argwhere(block), np.argwhere(knob)])
    ids = np.repeat([0, 1], [block.sum(), knob.sum()])
    boxes = [BLOCK, np.array([[4.0, 8.0, 8.0], [back, 12.0, 12.0]])]
    return VoxelGrid(resolution=20, coords=coords, part_ids=ids), boxes


def front_of(back: float) -> float:
    voxels, boxes = scene(back)
    block = np.zeros((20, 20, 20), dtype=bool)
    block[tuple(voxels.coords[voxels.part_ids == 0].T)] = True
    planes = fit_face_planes(block, BLOCK, None, find_neighbour_faces(voxels, boxes, 0))
    return float(planes.plane[DIRECTIONS.index((0, -1))][7, 5, 15])


@pytest.mark.parametrize("back", [7.0, 7.1, 7.25, 7.5])
def test_a_front_lies_just_behind_the_knob_on_it(back: float):
    assert front_of(back) == pytest.approx(back + JOINT_ROOM)


def test_a_knob_that_ends_before_the_block_keeps_it_in_its_cells():
    assert front_of(6.6) == pytest.approx(7.0)


def test_a_knob_sunk_into_the_block_says_nothing():
    assert front_of(7.8) == pytest.approx(7.0 + INSET)


def test_every_face_is_the_end_of_the_right_side():
    voxels, boxes = scene(7.0)
    faces = find_neighbour_faces(voxels, boxes, 0)
    for number, (axis, sign) in enumerate(DIRECTIONS):
        ends = faces.coordinate[faces.direction == number]
        assert len(ends)
        assert (ends == boxes[1][0 if sign > 0 else 1, axis]).all()
    toward = faces.cell[faces.direction == DIRECTIONS.index((0, -1))]
    assert set(toward[:, 0]) == {6, 7}


def test_a_part_alone_has_no_neighbours():
    voxels, boxes = scene(7.0)
    alone = voxels.part_ids == 0
    single = VoxelGrid(resolution=20, coords=voxels.coords[alone], part_ids=voxels.part_ids[alone])
    assert len(find_neighbour_faces(single, boxes[:1], 0).direction) == 0


def test_the_mesh_follows_wherever_the_part_lies():
    voxels, boxes = scene(7.2)
    block = np.zeros((20, 20, 20), dtype=bool)
    block[tuple(voxels.coords[voxels.part_ids == 0].T)] = True
    faces = find_neighbour_faces(voxels, boxes, 0)
    vertices, _ = mesh_occupancy(block, BLOCK, None, faces)
    fronts = vertices[(vertices[:, 2] > 17.5) & (vertices[:, 0] < 8.0), 0]
    np.testing.assert_allclose(fronts, 7.2 + JOINT_ROOM)
    none = NeighbourFaces(
        direction=np.zeros(0, dtype=np.int64), cell=np.zeros((0, 3), dtype=np.int64), coordinate=np.zeros(0)
    )
    plain, _ = mesh_occupancy(block, BLOCK)
    same, _ = mesh_occupancy(block, BLOCK, None, none)
    np.testing.assert_array_equal(plain, same)
