"""What tasks read out of packages, where robots stand, and where things can be put: no simulator needed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from envs.maniskill.containers import column_spans, find_container, largest_rectangle
from envs.maniskill.objects import TaskError, TaskObject, find_packages, read_object, read_objects
from envs.maniskill.placement import find_stand, free_radius, grip_path, outward
from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver.grasp import find_grasps
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull, convex_hull
from sim_export.package import Hull, SimPackage
from sim_export.report import CheckResult, Report, write_report


@pytest.fixture(scope="module")
def cabinet(folder: Path) -> TaskObject:
    return read_object(folder, "any")


def verdict(folder: Path, result: str) -> None:
    check = CheckResult(id="V304", level="L3", title="joints open", verdict=result)  # type: ignore[arg-type]
    write_report(Report(package=folder.name, checks=(check,)), folder / "validation.json")


def test_a_part_is_used_or_left_out_by_name(cabinet):
    used = {part.joint.name for part in cabinet.parts}
    left_out = {name for name, _ in cabinet.left_out}
    moving = {joint.name for joint in cabinet.package.joints if joint.type != "fixed"}
    assert used
    assert used | left_out == moving
    assert not used & left_out
    assert all(reason for _, reason in cabinet.left_out)


def test_endless_and_screwing_joints_are_left_out(package, tmp_path):
    joints = tuple(
        replace(
            joint,
            type="continuous",
        )
        if joint.type == "revolute"
        else joint
        for joint in package.joints
    )
    entry = read_object(write_package(replace(package, joints=joints), tmp_path / "endless"), "any")
    assert "turns without limits" in dict(entry.left_out).values()
    assert all(part.joint.type == "prismatic" for part in entry.parts)


def test_an_empty_folder_is_named(tmp_path):
    with pytest.raises(TaskError, match=r"no mobility\.urdf in it or below"):
        find_packages(tmp_path)
    with pytest.raises(TaskError, match="no such folder"):
        find_packages(tmp_path / "nowhere")


def test_only_what_passed_is_used(package, tmp_path):
    folder = write_package(package, tmp_path / "cabinet")
    with pytest.raises(TaskError, match=r"1 of 1 packages have no validation\.json"):
        read_objects(tmp_path, "any")
    verdict(folder, "fail")
    with pytest.raises(TaskError, match=r"failed validation: V304 \(joints open\)"):
        read_objects(tmp_path, "any")
    assert read_objects(tmp_path, "any", validation="any")
    verdict(folder, "pass")
    assert len(read_objects(tmp_path, "any")) == 1


def test_a_missing_kind_says_what_was_found(package, tmp_path):
    links = tuple(
        replace(link, label="tray" if link.label == "drawer" else link.label) for link in package.links
    )
    write_package(replace(package, links=links), tmp_path / "trays")
    with pytest.raises(TaskError, match=r"none has a drawer that one joint moves .*joint_0 moves a tray"):
        read_objects(tmp_path, "drawer", validation="any")


@pytest.mark.parametrize("robot", sorted(ROBOTS))
def test_the_robot_stands_clear_and_in_front(cabinet, robot):
    spec = ROBOTS[robot]
    fractions = np.linspace(0.0, 0.75, 9)
    for part in cabinet.parts:
        path = grip_path(cabinet, part, fractions)
        stand = find_stand(cabinet, part, spec, fractions, path, spec.forward)
        base = np.array([[stand.x, stand.y, stand.z]])
        assert free_radius(cabinet, part, base, spec.column, fractions)[0] > spec.clearance - 0.02
        assert (base[0] - path[0]) @ outward(cabinet, part) > 0.3
        assert np.linalg.norm(base[0, :2] - path[:, :2], axis=1).max() < spec.forward.far + 0.25


NEAREST = {(0.5, 0.5): (-1.0, 0.0), (0.9, 0.5): (1.0, 0.0), (0.5, 0.03): (0.0, -1.0), (0.5, 0.97): (0.0, 1.0)}


@pytest.mark.parametrize(("place", "side"), NEAREST.items())
def test_what_lifts_is_reached_from_the_nearest_side(cabinet, place, side):
    drawer = next(part for part in cabinet.parts if part.kind == "drawer")
    joint = replace(drawer.joint, axis=np.array([0.0, 0.0, 1.0]))
    low, high = cabinet.bounds
    size = np.full(3, min(high[:2] - low[:2]))  # a square, so that the middle is equally near to all sides
    square = replace(cabinet, bounds=np.stack([low, low + size]))
    grip = low + size * [*place, 1.0]
    lifting = replace(drawer, joint=joint, handle=None, grip=grip)
    np.testing.assert_array_equal(outward(square, lifting), [*side, 0.0])
    lid = replace(
        joint, type="revolute", axis=np.array([0.0, 1.0, 0.0]), origin=np.add(grip, [0.2, 0.0, 0.0])
    )
    np.testing.assert_array_equal(outward(square, replace(lifting, joint=lid)), [-1.0, 0.0, 0.0])


def test_the_grip_follows_the_joint(cabinet):
    for part in cabinet.parts:
        path = grip_path(cabinet, part, np.array([0.0, 1e-4]))
        direction = (path[1] - path[0]) / np.linalg.norm(path[1] - path[0])
        if part.handle is not None:
            np.testing.assert_allclose(direction, part.handle.opening_direction, atol=1e-3)
            assert direction @ outward(cabinet, part) > 0.9


def test_grasps_straddle_the_handle(cabinet):
    part = next(part for part in cabinet.parts if part.handle is not None)
    grasps = find_grasps(part.handle, part.held, ROBOTS["panda"])
    R = grasps.poses[:, :3, :3]
    np.testing.assert_allclose(R @ np.swapaxes(R, 1, 2), np.tile(np.eye(3), (len(R), 1, 1)), atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(R), 1.0)
    best = grasps.poses[grasps.cost.argmin()]
    bar = part.handle.grasp_line[1] - part.handle.grasp_line[0]
    assert abs(best[:3, 1] @ bar) < 1e-6
    assert best[:3, 0] @ part.handle.normal < -0.99
    thick = replace(part.handle, width=0.2)
    assert len(find_grasps(thick, (), ROBOTS["panda"]).poses) == 0


def test_columns_meet_a_box_where_it_is():
    box = convex_hull(np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0.5, 0.7)], dtype=float))
    low, high = column_spans((box,), np.array([[0.5, 1.9], [1.1, 1.0]]))
    np.testing.assert_allclose([low[0, 0], high[0, 0]], [0.5, 0.7], atol=1e-9)
    assert np.isinf([low[0, 1], high[0, 1]]).all()


def test_the_largest_rectangle_is_found():
    mask = np.zeros((6, 7), dtype=bool)
    mask[1:4, 2:6] = True
    mask[:, 0] = True
    assert largest_rectangle(mask) == (1, 4, 2, 6)
    assert largest_rectangle(np.zeros((3, 3), dtype=bool)) == (0, 0, 0, 0)


def test_a_drawer_has_room_within_its_walls(cabinet):
    part = next(part for part in cabinet.parts if part.kind == "drawer")
    container = find_container(cabinet, part, 0.9, 0.04)
    assert container is not None
    assert (container.region[0] >= part.moved.min(axis=0)).all()
    assert (container.region[1] <= part.moved.max(axis=0)).all()
    assert (container.aim[:2] > container.region[0, :2]).all()
    assert (container.aim[:2] < container.region[1, :2]).all()
    assert find_container(cabinet, part, 0.9, 0.9) is None


def with_hulls(package: SimPackage, link: str, hulls: tuple[Hull, ...], **changes) -> SimPackage:
    """The package with other hulls of one link."""
    links = tuple(replace(x, hulls=hulls) if x.name == link else x for x in package.links)
    return replace(package, links=links, **changes)


@pytest.mark.parametrize(("beyond", "held"), [(0.0049, 2), (0.0051, 1)])
def test_hulls_of_a_handle_reach_five_millimetres_beyond_its_box(package, tmp_path, beyond, held):
    handle = package.handles[0]
    low, high = handle.corners.min(axis=0), handle.corners.max(axis=0)
    for name, wider in (("low", (low - beyond, high)), ("high", (low, high + beyond))):
        hulls = (box_hull(low, high), box_hull(*wider), box_hull(low - 0.1, high + 0.1))
        folder = write_package(with_hulls(package, handle.link, hulls), tmp_path / name)
        part = next(x for x in read_object(folder, "any").parts if x.handle is not None)
        assert len(part.held) == held


@pytest.mark.parametrize(("behind", "side"), [(0.0099, 0.1), (0.0101, 0.05)])
def test_a_part_is_gripped_in_the_middle_of_its_foremost_centimetre(package, tmp_path, behind, side):
    """The drawer opens to the front, where a second board begins farther back, up to y = 0.2."""
    labels = {link.name: link.label for link in package.links}
    drawer = next(x for x in package.joints if labels[x.child] == "drawer")
    boards = (
        box_hull(np.array([-0.5, 0.0, 0.0]), np.array([-0.4, 0.1, 0.1])),
        box_hull(np.array([-0.5 + behind, 0.1, 0.0]), np.array([-0.4, 0.2, 0.1])),
    )
    plain = with_hulls(package, drawer.child, boards, handles=())
    entry = read_object(write_package(plain, tmp_path / "plain"), "drawer")
    np.testing.assert_allclose(entry.parts[0].grip[1:], [side, 0.05], atol=1e-6)
