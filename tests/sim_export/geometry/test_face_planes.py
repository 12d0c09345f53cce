"""Laws of fitted face planes: boxes exact, walls half a cell in, round and slanted things not locked."""

import numpy as np
import pytest
from cell_grid import grid, tight_box

from sim_export.geometry import face_planes
from sim_export.geometry.face_planes import DIRECTIONS, fit_face_planes


def flat_fraction(occupancy: np.ndarray, direction: int) -> float:
    planes = fit_face_planes(occupancy, tight_box(occupancy))
    exposed = planes.patch[direction] >= 0
    return float(planes.flat[direction][exposed].mean())


def open_box() -> np.ndarray:
    """A tray with walls and bottom one cell thick, outer cells 4..15 x 3..20 x 5..12."""
    occupancy = np.zeros((24, 24, 24), dtype=bool)
    occupancy[4:16, 3:21, 5:13] = True
    occupancy[5:15, 4:20, 6:13] = False
    return occupancy


def test_a_solid_box_gets_its_box():
    occupancy = np.zeros((12, 14, 16), dtype=bool)
    occupancy[2:9, 3:12, 4:5] = True
    box = np.array([[2.3, 3.9, 4.1], [8.2, 11.5, 4.8]])
    planes = fit_face_planes(occupancy, box)
    for number, (axis, sign) in enumerate(DIRECTIONS):
        exposed = planes.patch[number] >= 0
        assert exposed.any()
        assert planes.flat[number][exposed].all()
        np.testing.assert_array_equal(planes.plane[number][exposed], box[(sign + 1) // 2, axis])
        assert np.isnan(planes.plane[number][~exposed]).all()


def test_inner_walls_move_toward_the_solid():
    occupancy = open_box()
    planes = fit_face_planes(occupancy, tight_box(occupancy))
    # The tray's floor seen from above, one cell thick, its lower face on the box.
    assert planes.plane[5][10, 10, 5] == pytest.approx(6 - 0.1)
    solid = occupancy.copy()
    solid[5:15, 4:20, 6:8] = True
    planes = fit_face_planes(solid, tight_box(solid))
    assert planes.plane[5][10, 10, 7] == pytest.approx(8 - 0.5)
    assert planes.flat[5][10, 10, 7]


def test_walls_keep_their_least_thickness_and_the_box_wins(monkeypatch):
    monkeypatch.setattr(face_planes, "MIN_THICKNESS", 0.4)
    occupancy = open_box()
    box = tight_box(occupancy)
    box[0, 2] += 0.9  # the floor's lower face almost at the top of its cell
    planes = fit_face_planes(occupancy, box)
    assert planes.plane[4][10, 10, 5] == pytest.approx(5.9)
    assert planes.plane[5][10, 10, 5] == pytest.approx(6.3)


def test_a_far_box_is_ignored():
    occupancy = open_box()
    box = tight_box(occupancy)
    box[0, 2] += 3.0
    planes = fit_face_planes(occupancy, box)
    assert planes.plane[4][10, 10, 5] == pytest.approx(5.1)


@pytest.mark.parametrize("radius", [2, 3, 4, 6, 9, 12])
def test_balls_are_round_and_cylinders_round_with_flat_ends(radius: int):
    x = grid()
    ball = (x**2).sum(axis=0) < radius**2
    cylinder = ((x[:2] ** 2).sum(axis=0) < radius**2) & (np.abs(x[2]) < 7)
    for number in range(6):
        assert flat_fraction(ball, number) == 0.0
        assert flat_fraction(cylinder, number) == (1.0 if number >= 4 else 0.0)


@pytest.mark.parametrize("run", [1, 2, 3, 5])
def test_slanted_plates_are_not_locked_but_their_sides_are(run: int):
    x = grid()
    plate = (np.abs(x[2] - x[0] / run) < 1.5) & (np.abs(x[1]) < 8)
    assert flat_fraction(plate, 4) < 0.15
    assert flat_fraction(plate, 5) < 0.15
    assert flat_fraction(plate, 2) == flat_fraction(plate, 3) == 1.0


def test_raised_panels_stay_flat():
    door = np.zeros((6, 24, 30), dtype=bool)
    door[2:4] = True
    door[4, 4:20, 4:26] = True
    assert flat_fraction(door, 1) == 1.0
    assert flat_fraction(door, 0) == 1.0


def test_specks_do_not_unlock_a_panel():
    rng = np.random.default_rng(3)
    door = np.zeros((6, 40, 40), dtype=bool)
    door[2:4] = True
    door[4] = rng.random((40, 40)) < 0.1
    planes = fit_face_planes(door, tight_box(door))
    assert planes.flat[1][3].mean() > 0.8


def test_axis_permutations_and_translations_commute():
    x = grid(16)
    occupancy = open_box()[:16, :22, :16] | np.pad(((x**2).sum(axis=0) < 9), ((0, 0), (6, 0), (0, 0)))
    box = tight_box(occupancy)
    planes = fit_face_planes(occupancy, box)
    turned = fit_face_planes(np.transpose(occupancy, (2, 0, 1)), box[:, [2, 0, 1]])
    moved = fit_face_planes(np.pad(occupancy, ((3, 0), (1, 0), (2, 0))), box + np.array([3, 1, 2]))
    for number, (axis, sign) in enumerate(DIRECTIONS):
        other = DIRECTIONS.index(((axis + 1) % 3, sign))
        np.testing.assert_allclose(
            np.transpose(planes.plane[number], (2, 0, 1)), turned.plane[other], atol=1e-5
        )
        np.testing.assert_array_equal(np.transpose(planes.flat[number], (2, 0, 1)), turned.flat[other])
        np.testing.assert_allclose(moved.plane[number][3:, 1:, 2:], planes.plane[number] + (3, 1, 2)[axis])
        np.testing.assert_array_equal(moved.flat[number][3:, 1:, 2:], planes.flat[number])


def test_nothing_occupied_is_an_error():
    with pytest.raises(ValueError, match="no occupied cell"):
        fit_face_planes(np.zeros((4, 4, 4), dtype=bool), np.zeros((2, 3)))


@pytest.mark.parametrize("thick", [2, 3, 6])
def test_the_crest_of_a_disc_is_curved_however_thin_it_is(thick: int):
    across = np.arange(30) - 14.5
    disc = np.hypot(across[:, None], across[None]) <= 15.0
    planes = fit_face_planes(np.repeat(disc[None], thick, axis=0), np.array([[0, 0, 0], [thick, 30, 30]]))
    for direction in range(2, 6):
        rim = planes.patch[direction] >= 0
        assert not planes.flat[direction][rim].any()
    assert planes.flat[0][planes.patch[0] >= 0].all()


def plate_faces(low: float, high: float) -> list[float]:
    """Faces of a plate one cell thick, from 4 to 5, whose box is between these heights."""
    plate = np.zeros((12, 12, 12), dtype=bool)
    plate[2:10, 2:10, 4] = True
    planes = fit_face_planes(plate, np.array([[2.0, 2.0, low], [10.0, 10.0, high]]))
    return [float(planes.plane[number][5, 5, 4]) for number in (4, 5)]


@pytest.mark.parametrize(("thickness", "made"), [(0.5, 0.5), (0.41, 0.41), (0.39, 0.4), (0.2, 0.4)])
def test_the_box_makes_a_plate_as_thin_as_two_fifths_of_a_cell(thickness: float, made: float):
    assert plate_faces(4.5 - thickness / 2, 4.5 + thickness / 2) == pytest.approx(
        [4.5 - made / 2, 4.5 + made / 2]
    )


@pytest.mark.parametrize(("beyond", "inset"), [(1.24, -1.24), (1.26, 0.1)])
def test_faces_are_those_of_a_box_within_a_cell_and_a_quarter(beyond: float, inset: float):
    assert plate_faces(4.0 - beyond, 5.0)[0] == pytest.approx(4.0 + inset)


@pytest.mark.parametrize(("low", "top"), [(0.0, 5.9), (0.2, 6.0), (0.9, 6.7)])
def test_a_wall_keeps_four_fifths_of_a_cell_above_its_box(low: float, top: float):
    """The floor of a tray: its lower face is that of the box, its upper one lies inside."""
    occupancy = open_box()
    box = tight_box(occupancy)
    box[0, 2] += low
    assert fit_face_planes(occupancy, box).plane[5][10, 10, 5] == pytest.approx(top)


@pytest.mark.parametrize(("cells", "inset"), [(41, 0.1), (40, 0.5)])
def test_a_face_of_which_others_touch_more_than_a_tenth_lies_at_their_border(cells: int, inset: float):
    """A face of 400 cells lies half a cell inside, or a tenth where others touch it."""
    block = np.zeros((24, 24, 12), dtype=bool)
    block[2:22, 2:22, 4:7] = True
    others = np.zeros((30, 30, 18), dtype=bool)
    row, column = np.divmod(np.arange(cells), 20)
    others[5 + row, 5 + column, 3 + 7] = True
    far = np.array([[2.0, 2.0, 4.0], [22.0, 22.0, 11.0]])
    assert fit_face_planes(block, far, others).plane[5][15, 15, 6] == pytest.approx(7.0 - inset)


def is_terrace(edge: int, *, higher: int, wide: int) -> bool:
    """Whether a square between a strip that is higher along part of a side and a lower one is no panel."""
    block = np.zeros((12, edge + 2 * wide + 4, edge + 4), dtype=bool)
    block[2:8, 2 : 2 + edge + 2 * wide, 2 : 2 + edge] = True
    block[7, 2 + edge + wide :] = False
    block[8, 2 : 2 + wide, 2 : 2 + higher] = True
    planes = fit_face_planes(block, tight_box(block))
    return not planes.flat[1][7, 2 + wide + edge // 2, 2 + edge // 2]


@pytest.mark.parametrize(("edge", "terrace"), [(33, True), (34, False)])
def test_strips_of_less_than_three_hundredths_of_a_face_do_not_make_it_a_terrace(edge: int, terrace: object):
    assert is_terrace(edge, higher=edge, wide=1) == terrace


@pytest.mark.parametrize(("higher", "terrace"), [(17, True), (16, False)])
def test_a_terrace_has_steps_along_three_twentieths_of_its_rim_either_way(higher: int, terrace: object):
    assert is_terrace(30, higher=higher, wide=2) == terrace
