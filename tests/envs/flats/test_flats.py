"""Flats: plans that tile, rooms that are reached, and the guarantees of a room for the whole."""

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false

from dataclasses import replace
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest
from box_furniture import FURNITURE, write_proven
from room_poses import expected_poses

from artigen.api.sample import ShapeJob, ShapeSettings, build_sampled
from artigen.api.scene import SceneSettings, furnish_room
from artigen.errors import ArtigenError
from artigen.transforms import transform_points
from envs.flats.flat import AROUND, Flat, frame_of, join_rooms, move_opening, with_neighbours
from envs.flats.furnish import choose_doors, furnish_flat, least_door
from envs.flats.layout import EXTENTS, HUBS, ROOMS, FlatPlan, draw_plans, read_rooms
from envs.goals.goal import Goal, start_room
from envs.rooms.catalogue import read_catalogue
from envs.rooms.check import check_room
from envs.rooms.contents import fill_room
from envs.rooms.file import read_room, write_room
from envs.rooms.footprints import cached_package
from envs.rooms.mjcf import HOME, write_room_mjcf
from envs.rooms.recipes import DOOR, WINDOW
from envs.rooms.room import SIDES, THICKNESS, Opening, Side, Zone, wall_axis
from envs.rooms.solids import place_solid
from envs.rooms.usd import write_room_usd
from sim_export.files.write import write_package
from sim_export.report import CheckResult, Report, write_report

pytestmark = pytest.mark.slow

WIDE = 1.05
KINDS = read_rooms(("hall,bedroom kitchen",))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("packages")
    for kind in FURNITURE:
        write_proven(kind, out)
    job = ShapeJob(category="Door", seed=1, out=out, cfg=ShapeSettings(width=WIDE, style="flush"))
    door = write_package(build_sampled(job), out / "wide door")
    check = CheckResult(id="V203", level="L2", title="sweep", verdict="pass")
    write_report(Report(package="wide door", checks=(check,)), door / "validation.json")
    return out


@pytest.fixture(scope="module")
def flat(folder: Path) -> Flat:
    return furnish_flat(KINDS, 0, read_catalogue(folder))


@cache
def first_plan(count: int) -> FlatPlan:
    return next(iter(draw_plans(ROOMS[count], 1, WIDE)))


@pytest.mark.parametrize("count", ROOMS)
def test_rooms_tile_the_flat_in_sizes_that_people_build(count):
    plan = first_plan(count)
    zones = [cell.zone for cell in plan.cells]
    half = np.array([[-THICKNESS / 2], [THICKNESS / 2]])
    boxes = np.array([(zone.low, zone.high) for zone in zones]) + half
    assert sum(np.prod(boxes[:, 1] - boxes[:, 0], axis=1)) == pytest.approx(
        np.prod(np.array(plan.size) + THICKNESS), rel=1e-3
    )
    gaps = np.maximum(boxes[:, None, 0] - boxes[None, :, 1], boxes[None, :, 0] - boxes[:, None, 1]).max(
        axis=2
    )
    assert (gaps[~np.eye(count, dtype=bool)] > -1e-6).all()
    for zone in zones:
        short, long = sorted(np.subtract(zone.high, zone.low))
        assert short >= EXTENTS[zone.kind].least - 1e-6
        assert long <= EXTENTS[zone.kind].slender * short + 1e-6


@pytest.mark.parametrize("count", ROOMS)
def test_every_room_has_one_door_and_they_lead_to_the_hub(count):
    plan = first_plan(count)
    assert tuple(cell.zone.kind for cell in plan.cells) == ROOMS[count]
    for cell in plan.cells:
        assert cell.span[1] - cell.span[0] >= WIDE
        if cell.parent is None:
            assert (cell.side, cell.zone.low[1]) == ("front", 0.0)
            continue
        parent = plan.cells[cell.parent]
        assert parent.zone.kind in HUBS
        axis = wall_axis(cell.side)
        assert all(
            zone.low[axis] <= end <= zone.high[axis] for zone in (cell.zone, parent.zone) for end in cell.span
        )
    hubs = [index for index, cell in enumerate(plan.cells) if cell.parent is None]
    assert len(hubs) == 1
    for index in range(count):
        seen = [index]
        while (parent := plan.cells[seen[-1]].parent) is not None:
            assert parent not in seen
            seen.append(parent)
        assert seen[-1] == hubs[0]


def test_words_name_rooms_by_number_or_kind_and_what_is_no_flat_is_refused():
    assert read_rooms(()) == ROOMS[4]
    assert read_rooms(("5",)) == ROOMS[5]
    assert KINDS == ("hall", "bedroom", "kitchen")
    for words, said in (
        (("9",), "2 to 7"),
        (("hall", "cave"), "cave"),
        (("hall",), "1"),
        (("kitchen", "bedroom"), "hall"),
    ):
        with pytest.raises(ArtigenError, match=said):
            read_rooms(words)


@pytest.mark.parametrize("side", SIDES)
def test_an_opening_comes_back_from_a_turned_room(side: Side):
    cell = replace(
        first_plan(3).cells[1], side=side, zone=Zone(name="a", kind="office", low=(2.0, 1.0), high=(5.0, 5.0))
    )
    frame = frame_of(cell)
    floor = transform_points(frame.T, np.array([(0.0, 0.0, 0.0), frame.size]))
    np.testing.assert_allclose(
        [floor[:, :2].min(axis=0), floor[:, :2].max(axis=0)], [(2, 1), (5, 5)], atol=1e-12
    )
    assert frame.side_in_flat("front") == side
    for own in AROUND:
        hole = Opening(side=own, start=0.7, width=0.9, height=2.0, bottom=0.1)
        there = move_opening(hole, frame.size, frame.T, frame.side_in_flat(own))
        start = np.array(cell.zone.low)[wall_axis(there.side)]
        assert start <= there.start < there.stop <= start + frame.size[wall_axis(own)]
        assert frame.side_in_room(there.side) == own
        local = replace(there, start=there.start - float(start))
        turn = np.linalg.inv(frame.T)
        size = (3.0, 4.0, 2.6)
        turn[:2, 3] = -(turn[:2, :2] @ np.array([[0.0, 3.0], [0.0, 4.0]])).min(axis=1)
        assert move_opening(local, size, turn, own) == hole


def test_a_flat_keeps_what_a_room_promises_and_every_room_is_reached(flat):
    whole = join_rooms(flat)
    assert check_room(whole, open_doors=True) == ()
    assert len({placement.id for placement in whole.placements}) == len(whole.placements)
    assert len({fixture.name for fixture in whole.fixtures}) == len(whole.fixtures)
    doors = [placement for placement in whole.placements if placement.role == DOOR.name]
    assert {placement.package.name for placement in doors} == {"wide door"}
    assert all(room.placements for room in flat.rooms)
    closed = check_room(whole)
    assert {problem.kind for problem in closed} == {"unreachable"}
    assert not any(problem.id.startswith("hall_") for problem in closed)


def test_a_blocked_doorway_is_found(flat):
    whole = join_rooms(flat)
    door = whole.placement("bedroom_door_1")
    x, y, _ = door.position
    low, high = (x - 0.5, y - 0.5, 0.001), (x + 0.5, y + 0.5, 0.05)
    crate = replace(whole.fixtures[0], name="crate", low=low, high=high)
    problems = check_room(replace(whole, fixtures=(*whole.fixtures, crate)), open_doors=True)
    assert any(problem.kind == "unreachable" and problem.id.startswith("bedroom") for problem in problems)


def test_windows_are_in_outer_walls_and_doors_between_rooms(flat):
    whole = join_rooms(flat)
    for placement in whole.placements:
        boxes = place_solid(placement).boxes
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        outside = min(*low[:2], *(np.array(whole.size[:2]) - high[:2])) < -0.02
        assert outside == (placement.role == WINDOW.name or placement.id == "hall_door_1")
    assert {hole.side for hole in whole.openings} <= set(SIDES)


def test_walls_leave_no_gap_but_their_openings(flat):
    """Along the middle of every inner wall there is a wall of one of both rooms, above all doors."""
    whole = join_rooms(flat)
    walls = np.array([(each.low, each.high) for each in whole.fixtures if each.name.startswith("wall")])
    for cell in flat.plan.cells:
        for side in set(SIDES) - set(cell.outer):
            axis = wall_axis(side)
            at = cell.zone.low[1 - axis] if side in ("front", "left") else cell.zone.high[1 - axis]
            points = np.full((50, 3), 2.5)
            points[:, axis] = np.linspace(cell.zone.low[axis], cell.zone.high[axis], 50)
            points[:, 1 - axis] = at + 0.02 * (-1 if side in ("front", "left") else 1)
            inside = (points[:, None] > walls[:, 0] - 1e-6) & (points[:, None] < walls[:, 1] + 1e-6)
            assert np.logical_or.reduce(inside.all(axis=2), axis=1).all()


def test_a_flat_comes_back_from_its_file_and_steps_in_mujoco(flat, tmp_path):
    whole = join_rooms(flat)
    write_room(whole, tmp_path)
    assert read_room(tmp_path).zones == whole.zones
    model = mujoco.MjModel.from_xml_path(str(write_room_mjcf(whole, tmp_path)))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 50)
    assert np.isfinite(data.qpos).all()
    assert model.joint("bedroom_door_1/joint_0").id > 0


def test_engines_find_every_body_of_a_flat_in_which_doors_stand_open(flat, tmp_path):
    """One stage and one MJCF: poses to a millimetre, a lamp in each room, doors between rooms on hinges."""
    pytest.importorskip("pxr")
    from pxr import Usd, UsdGeom, UsdLux, UsdPhysics

    whole = join_rooms(replace(flat, rooms=tuple(fill_room(room, 1.0) for room in flat.rooms)))
    package = cached_package(whole.placement("bedroom_door_1").package)
    (leaf,) = (link.name for link in package.links if link.label == "door")
    (hinge,) = (joint.name for joint in package.joints if joint.child == leaf)
    ajar = Goal(words="", family="close", start=(("bedroom_door_1", hinge, 0.6),))
    whole = start_room(whole, ajar)
    expected = expected_poses(whole)
    assert whole.contents
    model = mujoco.MjModel.from_xml_path(str(write_room_mjcf(whole, tmp_path)))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(HOME).id)
    mujoco.mj_forward(model, data)
    stage = Usd.Stage.Open(str(write_room_usd(whole, tmp_path)))
    cache, prims = UsdGeom.XformCache(), list(stage.Traverse())
    bodies = [prim for prim in prims if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    assert {str(prim.GetPath()).removeprefix("/World/") for prim in bodies} == set(expected)
    for prim in bodies:
        name = str(prim.GetPath()).removeprefix("/World/")
        T = np.array(cache.GetLocalToWorldTransform(prim)).T
        np.testing.assert_allclose(T, expected[name], atol=1e-3, err_msg=name)
        np.testing.assert_allclose(data.body(name).xpos, T[:3, 3], atol=1e-3, err_msg=name)
    assert not stage.GetCompositionErrors()
    assert stage.GetPrimAtPath(f"/World/bedroom_door_1/joints/{hinge}").IsA(UsdPhysics.RevoluteJoint)
    lamps = [prim for prim in prims if prim.IsA(UsdLux.DiskLight)]
    at = np.array([np.array(cache.GetLocalToWorldTransform(prim))[3, :2] for prim in lamps])
    for zone in whole.zones:
        assert ((at > zone.low) & (at < zone.high)).all(axis=1).any(), zone.name


def test_a_hub_is_shown_with_the_doors_of_its_rooms(flat):
    hall = with_neighbours(flat, KINDS.index("hall"))
    assert {"bedroom_door_1", "kitchen_door_1"} <= {placement.id for placement in hall.placements}


def test_doors_that_a_robot_does_not_pass_are_left_out(folder):
    catalogue = read_catalogue(folder)
    kept, width = choose_doors(catalogue, 0.3)
    assert (width, [entry.folder.name for entry in kept.of_role(DOOR)]) == (
        pytest.approx(WIDE, abs=0.02),
        ["wide door"],
    )
    assert least_door(0.3) < WIDE < least_door(0.4)
    assert choose_doors(catalogue, 0.4)[0].of_role(DOOR) == ()


def test_rooms_are_of_flats_and_sizes_are_not(folder, tmp_path):
    with pytest.raises(ArtigenError, match="only a flat has rooms"):
        furnish_room("kitchen", tmp_path, packages=folder, cfg=SceneSettings(rooms=("3",)))
    with pytest.raises(ArtigenError, match="width"):
        furnish_room("flat", tmp_path, packages=folder, cfg=SceneSettings(width=5.0))


def test_the_same_seed_gives_the_same_plans():
    one, other, third = (list(draw_plans(KINDS, seed, WIDE)) for seed in (4, 4, 5))
    assert one == other != third
