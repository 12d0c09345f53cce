"""Where a robot stands in front of a path: how near and far, how high, and how clear of the object."""

from pathlib import Path

import numpy as np
import pytest

from artigen.types import Joint
from envs.maniskill.objects import TaskObject, TaskPart
from envs.maniskill.placement import Stand, find_stand, outward
from envs.maniskill.robots import ROBOTS
from sim_export.package import SimPackage

PANDA, FETCH = ROBOTS["panda"], ROBOTS["fetch"]
FRONT, UP = np.array([-1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
FAR = np.array([[9.0, -9.0, -9.0], [9.1, 9.0, 9.0]])


def block(low: list[float], high: list[float]) -> TaskObject:
    """An object that fills a box; its ground is at the lower end."""
    package = SimPackage(name="a", category="Table", visual="voxels", links=(), joints=())
    return TaskObject(
        folder=Path(), package=package, parts=(), left_out=(), bounds=np.array([low, high], dtype=float)
    )


def drawer(axis: np.ndarray = FRONT, moved: np.ndarray = FAR) -> TaskPart:
    joint = Joint(
        name="j", type="prismatic", parent="a", child="b", origin=np.zeros(3), axis=axis,
        upper=0.1,
    )  # fmt: skip
    return TaskPart(
        kind="drawer", verb="open", joint=joint, handle=None, grip=np.zeros(3), moved=moved, own=(), held=(),
        needs=(),
    )  # fmt: skip


def stand(path: list[list[float]], reach: str = "panda forward", **changes) -> Stand:
    """The place of a robot for a path in front of nothing, or of an object and a part."""
    name, way = reach.split()
    robot = ROBOTS[name]
    given = {"entry": block([9.0, -9.0, 0.0], [9.1, 9.0, 9.0]), "part": drawer()} | changes
    return find_stand(
        given["entry"], given["part"], robot, np.zeros(1), np.array(path, dtype=float), getattr(robot, way)
    )


@pytest.mark.parametrize(
    ("reach", "beyond", "ahead", "aside"),
    [
        ("panda forward", 0.0, 0.6, 0.0),
        ("panda forward", 0.1395, 0.6, 0.0),  # the farthest is 72 cm away, or 71.95 cm from 10 cm nearer
        ("panda forward", 0.1405, 0.5, 0.0),
        ("panda forward", -0.1995, 0.6, 0.0),  # the nearest is 40 cm away
        ("panda forward", -0.2005, 0.7, 0.0),
        ("panda down", 0.0695, 0.5, 0.0),
        ("panda down", 0.0705, 0.4, 0.0),
        ("panda down", -0.1408, 0.5, 0.0),
        ("panda down", -0.1417, 0.5, 0.1),
        ("fetch forward", -0.0695, 0.6, 0.0),
        ("fetch forward", -0.0705, 0.7, 0.0),
        ("fetch forward", 0.3355, 0.6, 0.0),
        ("fetch forward", 0.3370, 0.5, 0.2),
        ("fetch down", -0.1195, 0.6, 0.0),
        ("fetch down", -0.1205, 0.7, 0.0),
        ("fetch down", 0.1695, 0.6, 0.0),
        ("fetch down", 0.1705, 0.5, 0.0),
        ("panda forward", 2.0, 0.4, 0.0),  # as near as can be
    ],
)
def test_a_robot_stands_where_all_of_a_path_is_at_a_comfortable_distance(reach, beyond, ahead, aside):
    """Ten centimetres off 60 cm, or aside, cost as much as being 2 cm out of reach at one of two points."""
    found = stand([[0.0, 0.0, 0.5], [beyond, 0.0, 0.5]], reach)
    assert -found.x == pytest.approx(ahead)
    assert abs(found.y) == pytest.approx(aside)


def test_a_robot_stands_up_to_130_centimetres_ahead():
    """The object takes all that is nearer, and there is not enough room even there."""
    entry = block([-1.2, -9.0, 0.0], [0.0, 9.0, 9.0])
    assert -stand([[0.0, 0.0, 0.5]], entry=entry).x == pytest.approx(1.3)


def test_a_robot_stands_aside_by_eighty_centimetres_at_most():
    assert stand([[0.0, 0.0, 0.5], [0.0, 5.0, 0.5]]).y == pytest.approx(0.8)


@pytest.mark.parametrize(
    ("way", "heights", "base"),
    [
        ("forward", [0.7297], 0.0),
        ("forward", [0.7303], 0.1),  # 10 cm of height cost as much as 1 cm out of reach
        ("forward", [0.405], 0.0),
        ("forward", [0.395], 0.3),
        ("forward", [0.105], 0.0),
        ("forward", [0.115], 0.1),
        ("forward", [0.0, 0.279], 0.1),  # 12 cm below, and 10 cm above a stand
        ("forward", [0.0, 0.284], 0.2),
        ("down", [0.505], 0.0),
        ("down", [0.515], 0.1),
        ("forward", [3.0], 1.0),
    ],
)
def test_a_robot_stands_on_the_lowest_stand_from_which_a_path_is_at_a_comfortable_height(way, heights, base):
    assert stand([[0.0, 0.0, z] for z in heights], f"panda {way}").z == pytest.approx(base)


@pytest.mark.parametrize(
    ("way", "height", "lift"),
    [("forward", 0.9, 0.0), ("forward", 1.0, 0.05), ("forward", 1.3, 0.35), ("forward", 1.5, 0.386),
     ("down", 0.8, 0.1)],
)  # fmt: skip
def test_a_torso_rises_until_a_path_is_twenty_centimetres_below_the_highest_in_reach(way, height, lift):
    assert stand([[0.0, 0.0, height]], f"fetch {way}").lift == pytest.approx(lift)


@pytest.mark.parametrize(("reach", "clearance"), [("panda forward", 0.16), ("fetch forward", 0.34)])
@pytest.mark.parametrize(("more", "ahead"), [(1e-4, 0.6), (-1e-4, 0.7)])
def test_a_base_keeps_its_clearance(reach, clearance, more, ahead):
    """The object ends that far before a base 60 cm ahead of the path."""
    entry = block([-0.6 + clearance + more, -9.0, 0.0], [0.0, 9.0, 9.0])
    assert -stand([[0.0, 0.0, 0.5]], reach, entry=entry).x == pytest.approx(ahead)


@pytest.mark.parametrize(("missing", "ahead"), [(0.000126, 0.7), (0.000138, 0.8)])
def test_a_millimetre_of_missing_clearance_costs_as_much_as_twenty_two_centimetres_out_of_reach(
    missing, ahead
):
    """Five hundredths; 80 cm ahead, the path is out of reach by 8 cm."""
    entry = block([-0.7 + 0.16 - missing, -9.0, 0.0], [0.0, 9.0, 9.0])
    assert -stand([[0.0, 0.0, 0.5]], entry=entry).x == pytest.approx(ahead)


@pytest.mark.parametrize(("reach", "height"), [("panda forward", 0.86), ("fetch forward", 1.44)])
@pytest.mark.parametrize(("more", "free"), [(1e-3, True), (-1e-3, False)])
def test_a_part_above_a_robot_keeps_its_clearance_from_the_column_over_its_base(reach, height, more, free):
    """The column of Panda is 70 cm high, that of Fetch 1.1 m, and the part ends above 65 cm ahead."""
    part = drawer(moved=np.array([[-0.65, -9.0, height + more], [9.0, 9.0, 9.0]]))
    assert (-stand([[0.0, 0.0, 0.5]], reach, part=part).x == pytest.approx(0.6)) == free


@pytest.mark.parametrize(("level", "side"), [(0.51, [0.0, 1.0, 0.0]), (0.49, [-1.0, 0.0, 0.0])])
def test_a_part_that_moves_more_up_than_out_is_reached_from_the_front(level, side):
    """The grip is nearest to that side of the object."""
    part = drawer(axis=np.array([0.0, level, np.sqrt(1.0 - level**2)]))
    entry = block([-0.1, -1.0, 0.0], [1.0, 1.0, 1.0])
    np.testing.assert_allclose(outward(entry, part), side)
