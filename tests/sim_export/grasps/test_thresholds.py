"""Both sides of the limits of grasps: room on arrival, how far a grip is carried, what is tried."""

import numpy as np
import pytest
from pulled_drawer import pulled_drawer

from sim_export.geometry.hulls import box_hull
from sim_export.grasps import find, poses
from sim_export.grasps.boxes import TOUCH, arriving_boxes, carried_boxes
from sim_export.grasps.carry import CLEAR, Way, carried_to
from sim_export.grasps.find import find_on
from sim_export.grasps.gripper import FRANKA
from sim_export.grasps.poses import Hands, nearby
from sim_export.grasps.room import Solids, meet
from sim_export.grasps.targets import find_targets

AT = np.eye(4)[None]
LOW, HIGH = FRANKA.palm.min(axis=(0, 1)), FRANKA.palm.max(axis=(0, 1))


def meets(boxes: np.ndarray, low: tuple[float, ...], high: tuple[float, ...]) -> bool:
    solid = box_hull(np.array(low), np.array(high))
    return bool(meet(AT, boxes, Solids(hulls=(solid,), T=AT))[0])


@pytest.mark.parametrize(("away", "met"), [(0.079, True), (0.081, False)])
def test_a_gripper_comes_straight_for_eighty_millimetres(away: float, met: bool):  # noqa: FBT001
    boxes = arriving_boxes(FRANKA, np.array([0.02]), 0.0)
    behind = float(LOW[2]) - away
    assert meets(boxes, (-0.01, -0.01, behind - 0.05), (0.01, 0.01, behind)) == met


@pytest.mark.parametrize(("width", "spare"), [(0.01, 0.012), (0.055, 0.012), (0.057, 0.0115), (0.07, 0.005)])
def test_pads_arrive_up_to_twelve_millimetres_open(width: float, spare: float):
    """The gripper opens to 80 mm."""
    boxes = arriving_boxes(FRANKA, np.array([width]), 0.0)
    outside, tip = width / 2 + TOUCH + spare + float(FRANKA.pad[1, 1]), float(FRANKA.pad[1, 2])
    for more, met in ((-2e-4, True), (2e-4, False)):
        wall = outside + more
        assert meets(boxes, (-0.5, wall, tip - 0.002), (0.5, wall + 0.1, tip)) == met


@pytest.mark.parametrize(("apart", "met"), [(0.0019, True), (0.0021, False)])
def test_a_gripper_keeps_two_millimetres_clear(apart: float, met: bool):  # noqa: FBT001
    boxes = carried_boxes(FRANKA, np.array([0.02]), CLEAR)
    side = float(HIGH[0]) + apart
    assert meets(boxes, (side, -1.0, float(LOW[2])), (side + 0.1, 1.0, float(HIGH[2]))) == met


@pytest.mark.parametrize(("end", "to"), [(0.99, 0.99), (1.0, 0.96)])
def test_a_joint_is_carried_to_95_percent_of_the_last_stroke_and_to_the_end_of_others(end: float, to: float):
    assert carried_to(0.2, end) == pytest.approx(to)


def test_poses_nearby_are_24_within_four_millimetres_and_fifteen_degrees(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(poses, "_settle", lambda hands, *_: hands)
    hands = Hands(T=np.tile(np.eye(4), (50, 1, 1)), width=np.zeros(50), angle=np.zeros(50))
    near = nearby(hands, None, FRANKA, ())  # type: ignore[arg-type]
    assert len(near) == 24 * 50
    moved, turned = near.T[:, :3, 3], np.degrees(np.arccos(near.T[:, [1, 2], [1, 2]]))
    assert 0.0039 < np.abs(moved).max() < 0.004
    assert np.all(moved[:, 1] == 0.0)
    assert 14.9 < turned.max() < 15.0


def test_poses_nearby_are_tried_three_times_where_a_handle_has_no_room(monkeypatch: pytest.MonkeyPatch):
    tried: list[int] = []
    starts: list[float] = []
    look = find._find_room

    def count(way: Way, hands: Hands, rounds: int, begin: float) -> tuple[Hands, np.ndarray]:
        starts.extend([begin] * (rounds > 0))
        return look(way, hands, rounds, begin)

    def none(hands: Hands, *_: object) -> Hands:
        tried.append(len(hands))
        return hands.some(np.zeros(0, dtype=int))

    monkeypatch.setattr(find, "_find_room", count)
    monkeypatch.setattr(find, "nearby", none)
    package = pulled_drawer(0.012, box_hull(np.array([-0.28, -1.0, -0.5]), np.array([-0.27, 1.0, 0.5])))
    assert not find_on(package, find_targets(package)[0], FRANKA)[0].grasps
    assert len(tried) == 3 * len(starts) > 0
    assert max(tried) == 24
