"""Which drawers and compartments have room for a cube, and where it ends."""

from pathlib import Path

import numpy as np
import pytest

from artigen.types import Joint, PartLabel
from envs.maniskill import containers
from envs.maniskill.containers import Container, find_container, room_when_open
from envs.maniskill.hulls import open_above_ground
from envs.maniskill.objects import TaskObject, TaskPart
from sim_export.geometry.hulls import box_hull
from sim_export.package import Hull, Link, SimPackage

Box = tuple[tuple[float, float, float], tuple[float, float, float]]
FLOOR = 0.04


def entry_of(
    kind: PartLabel,
    own: list[Box],
    body: list[Box],
    axis: tuple[float, float, float],
    grip: tuple[float, ...],
) -> tuple[TaskObject, TaskPart]:
    """A part before, or in, a body, all of them boxes."""
    motion = "prismatic" if kind == "drawer" else "revolute"
    hulls: dict[str, tuple[Hull, ...]] = {
        name: tuple(box_hull(np.array(low), np.array(high)) for low, high in boxes)
        for name, boxes in (("body", body), ("part", own))
    }
    links = tuple(
        Link(name=name, label=None, parts=(name,), visuals=(), hulls=value, inertial=None)
        for name, value in hulls.items()
    )
    length = float(np.linalg.norm(axis))
    joint = Joint(
        name="j", type=motion, parent="body", child="part", axis=np.array(axis) / length, upper=0.5 * length
    )  # fmt: skip
    package = SimPackage(name="a", category="Table", visual="voxels", links=links, joints=(joint,))
    moved = np.concatenate([hull.vertices for hull in hulls["part"]])
    part = TaskPart(
        kind=kind, verb="open", joint=joint, handle=None, grip=np.array(grip), moved=moved, own=hulls["part"],
        held=(), needs=(),
    )  # fmt: skip
    corners = np.concatenate([hull.vertices for value in hulls.values() for hull in value])
    bounds = np.stack([corners.min(axis=0), corners.max(axis=0)])
    return TaskObject(folder=Path(), package=package, parts=(part,), left_out=(), bounds=bounds), part


def in_drawer(
    rim: float = 0.06, wide: float = 0.1, size: float = 0.04, step: float = 0.0, deep: float = 0.1
) -> Container | None:
    """Space in a tray with walls of 1 cm; a ``step`` covers the last 4 cm of its floor."""
    top = FLOOR + rim
    tray: list[Box] = [
        ((0.0, 0.0, 0.0), (deep, wide, FLOOR)),
        ((-0.01, -0.01, 0.0), (0.0, wide + 0.01, top)),
        ((deep, -0.01, 0.0), (deep + 0.01, wide + 0.01, top)),
        ((0.0, -0.01, 0.0), (deep, 0.0, top)),
        ((0.0, wide, 0.0), (deep, wide + 0.01, top)),
    ]
    tray += [((deep - 0.04, 0.0, 0.0), (deep, wide, FLOOR + step))] if step else []
    body: list[Box] = [((0.0, 0.0, -0.1), (deep, wide, -0.09))]
    entry, part = entry_of("drawer", tray, body, (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return find_container(entry, part, 1.0, size)


def behind_door(
    *,
    room: float = 0.3,
    below: float = 0.0,
    wide: float = 0.5,
    grip: tuple[float, float, float] = (0.0, 0.5, 0.3),
) -> Container | None:
    """Space on a board behind a door hinged at y = 0, with ``room`` up to the next board; the door's
    lower edge is ``below`` the board's top if negative, above it if positive."""
    boards: list[Box] = [
        ((0.02, 0.0, 0.0), (0.6, 0.5, FLOOR)),
        ((0.02, 0.0, FLOOR + room), (0.6, 0.5, FLOOR + room + 0.5)),
    ]
    leaf: list[Box] = [((0.0, 0.0, FLOOR + below), (0.02, wide, 0.8))]
    entry, part = entry_of("door", leaf, boards, (0.0, 0.0, 1.0), grip)
    return find_container(entry, part, 1.0, 0.04)


@pytest.mark.parametrize(("rim", "some"), [(0.0251, True), (0.0249, False)])
def test_the_walls_of_a_tray_are_twenty_five_millimetres_high(rim, some):
    assert (in_drawer(rim=rim) is not None) == some


@pytest.mark.parametrize(
    ("wide", "size", "some"), [(0.061, 0.04, True), (0.061, 0.0401, False), (0.054, 0.04, False)]
)
def test_a_floor_is_half_as_much_again_as_the_cube(wide, size, some):
    assert (in_drawer(wide=wide, size=size) is not None) == some


@pytest.mark.parametrize(("step", "end"), [(0.0039, 0.195), (0.0041, 0.155)])
def test_a_floor_is_level_to_four_millimetres(step, end):
    """The region ends in the middle of its last cell of 1 cm."""
    space = in_drawer(step=step, deep=0.2)
    assert space is not None
    np.testing.assert_allclose(space.region[0], [0.005, 0.005, FLOOR], atol=1e-9)
    assert space.region[1, 0] == pytest.approx(end)


@pytest.mark.parametrize(("wide", "end"), [(0.496, 0.465), (0.494, 0.455)])
def test_a_compartment_is_used_to_a_depth_of_thirty_centimetres_and_off_the_sides(wide, end):
    """Three centimetres from the front and from each side, in cells of one centimetre."""
    space = behind_door(wide=wide)
    assert space is not None
    np.testing.assert_allclose(space.region, [[0.035, 0.035, FLOOR], [0.295, end, FLOOR + 0.16]], atol=1e-9)


@pytest.mark.parametrize(("room", "some"), [(0.161, True), (0.159, False)])
def test_a_gripper_needs_sixteen_centimetres_above_the_floor(room, some):
    assert (behind_door(room=room) is not None) == some


@pytest.mark.parametrize(("below", "some"), [(0.049, True), (0.051, False)])
def test_a_floor_is_at_most_five_centimetres_below_the_door(below, some):
    assert (behind_door(below=below) is not None) == some


@pytest.mark.parametrize(("cosine", "some"), [(0.91, True), (0.89, False)])
def test_a_door_faces_the_front(cosine, some):
    grip = (float(np.sqrt(1.0 - cosine**2)), cosine, 0.3)
    assert (behind_door(grip=grip) is not None) == some


@pytest.mark.parametrize(("opened", "some"), [(0.57, True), (0.55, False)])
def test_a_part_opens_to_seven_tenths_of_what_is_wanted_before_it_meets_the_ground(monkeypatch, opened, some):
    monkeypatch.setattr(containers, "open_above_ground", lambda *_: opened)
    monkeypatch.setattr(containers, "find_container", lambda *_: "space")
    entry, part = entry_of("drawer", [((0, 0, 0), (1, 1, 1))], [((0, 0, 0), (1, 1, 1))], (1, 0, 0), (0, 0, 0))
    assert room_when_open(entry, part, 0.8, 0.04) == ("space" if some else None)


@pytest.mark.parametrize(("below", "opened"), [(9e-4, 1.0), (11e-4, 0.9)])
def test_a_part_may_reach_a_millimetre_below_the_ground(below, opened):
    """It sinks in proportion, so that the last but two of the forty steps are above."""
    boxes: list[Box] = [((0, 0, 0), (1, 1, 1))]
    entry, part = entry_of("drawer", boxes, boxes, (0.0, 0.0, -2.0 * below), (0, 0, 0))
    assert open_above_ground(entry, part, 1.0) == pytest.approx(opened)
