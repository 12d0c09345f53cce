"""Pieces side by side: gaps, fronts in one line, and what counts as contact."""

import numpy as np
import pytest
from sample_packages import SAMPLE_PARTS, build_package

from envs.rooms.catalogue import Entry
from envs.rooms.fittings import make_fitting
from envs.rooms.pieces import Boxes, Piece, conflict, line_up, make_piece, overlap
from sim_export.files.write import write_package

NONE = np.zeros((0, 2, 3))


def piece(depth: float) -> Piece:
    bodies = np.array([[[-depth, 0.0, 0.0], [0.0, 0.6, 0.8]]])
    return Piece(role="box", entry=None, boxes=Boxes(bodies=bodies, sweeps=NONE, stands=NONE), face=-depth)


def test_neighbours_are_three_millimetres_apart():
    bodies = line_up("run", [piece(0.6), piece(0.6)]).boxes.bodies
    assert bodies[1, 0, 1] - bodies[0, 1, 1] == pytest.approx(0.003)


@pytest.mark.parametrize(("shallower", "aligned"), [(0.14, True), (0.16, False)])
def test_a_piece_stands_up_to_fifteen_centimetres_from_the_wall_to_align_its_front(
    shallower: float, aligned: object
):
    deep, shallow = line_up("run", [piece(0.6), piece(0.6 - shallower)]).boxes.bodies
    assert (shallow[0, 0] == pytest.approx(deep[0, 0])) == aligned
    assert (shallow[1, 0] == pytest.approx(deep[1, 0])) != aligned


@pytest.mark.parametrize(("deep", "found"), [(1.9e-4, False), (2.1e-4, True)])
def test_boxes_overlap_from_a_fifth_of_a_millimetre_on(deep: float, found: object):
    box = np.array([[[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]])
    for axis in range(3):
        assert overlap(box, box + (1.0 - deep) * np.eye(3)[axis]) == found


def test_a_double_bed_is_a_metre_and_sixty_wide():
    low, high = make_fitting("bed").boxes.bodies[0]
    assert high[1] - low[1] == pytest.approx(1.6)


@pytest.mark.parametrize(("height", "free"), [(1.09, False), (1.11, True)])
def test_a_robot_stands_below_what_hangs_a_metre_and_ten_above_the_floor(
    tmp_path_factory: pytest.TempPathFactory, height: float, free: object
):
    folder = write_package(build_package(SAMPLE_PARTS), tmp_path_factory.mktemp("package") / "cabinet")
    entry = Entry(
        folder=folder, name="cabinet", category="StorageFurniture", size=(0.5, 0.5, 0.5), kinds=(),
        provenance=(),
    )  # fmt: skip
    made = make_piece(entry, "base cabinet", 0.3, elevation=0.05)
    floor = made.box[0, 2] - 0.05
    (x0, y0, _), (x1, y1, _) = made.boxes.stands[0]
    lamp = np.array([[[x0 - 0.1, y0, floor + height], [x1 - 0.1, y1, floor + height + 0.2]]])
    stands = Boxes(bodies=NONE, sweeps=NONE, stands=made.boxes.stands)
    assert conflict(stands, Boxes(bodies=lamp, sweeps=NONE, stands=NONE)) != free
