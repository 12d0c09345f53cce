"""Goals in words refer to one thing, begin unreached, and are reached by the state that they describe."""

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import mujoco
import numpy as np
import pytest
import torch
from bare_room import ROOM
from box_furniture import FURNITURE, write_proven

import envs
from artigen.transforms import transform_points
from envs.goals.file import GoalFileError, read_goals, write_goals
from envs.goals.goal import FAMILIES, Goal, ItemGoal, Region, State, is_reached, start_room, state_of
from envs.goals.mujoco import read_mujoco_state
from envs.goals.names import name_items, name_objects
from envs.goals.references import Reference, refer, write_references
from envs.goals.sample import sample_goals
from envs.rooms.contents import fill_room
from envs.rooms.file import write_room
from envs.rooms.footprints import cached_package
from envs.rooms.map import start_place
from envs.rooms.mjcf import write_room_mjcf
from envs.rooms.room import Item, Placement, Room, pose_matrix_of
from sim_export.files.write import write_package
from sim_export.motion.kinematics import link_displacements
from sim_export.package import HandleAnnotation

PLACES = {"base_a": ("base cabinet", 0.5), "base_b": ("base cabinet", 1.4), "fridge": ("fridge", 2.4)}
"""Role of each package, and its place along the back wall (m)."""
WASHER = ("washer", "washing machine", 3.3)


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Room:
    """Two base cabinets, one with drawers, a fridge and a washing machine, with things and a towel."""
    base = tmp_path_factory.mktemp("packages").resolve()
    kinds = {kind.name: kind for kind in FURNITURE}
    placements = []
    for name, role, x in (*((name, *place) for name, place in PLACES.items()), WASHER):
        kind = kinds[name]
        placements.append(
            Placement(
                id=name, role=role, category=kind.category, package=write_proven(kind, base), size=kind.size,
                position=(x, 3.1, kind.size[2] / 2 + 0.003), quat=(0.5**0.5, 0.0, 0.0, 0.5**0.5),
                standing=((x, 2.2),),
            )
        )  # fmt: skip
    full = fill_room(replace(ROOM, placements=tuple(placements)), 1.0)
    towel = Item(
        id="towel_1", thing="towel", holder="base_b", link="body", position=(0.0, 0.0, 0.4405),
        quat=(1.0, 0.0, 0.0, 0.0), size=(0.3, 0.2, 0.05), mass=0.3, colors=((0.9, 0.9, 0.9), (0.8, 0.8, 0.8)),
    )  # fmt: skip
    jar = replace(
        towel, id="jar_99", thing="jar", position=(0.0, 0.3, 0.4405), size=(0.07, 0.07, 0.1), mass=0.2
    )
    return replace(full, contents=(*full.contents, towel, jar))


@pytest.fixture(scope="module")
def goals(room: Room) -> tuple[Goal, ...]:
    return sample_goals(room, 3, 60)


def solved(goal: Goal, room: Room) -> State:
    """The first state of a goal, changed to what its conditions say: things are in the middle of their
    regions, or far away."""
    state = state_of(start_room(room, goal))
    joints = dict(state.joints)
    for each in goal.joints:
        joints[each.object, each.joint] = (each.low + each.high) / 2.0
    items = dict(state.items)
    for each in goal.items:
        placement, region = room.placement(each.object), each.regions[-1]
        package = cached_package(placement.package)
        mine = {joint: q for (name, joint), q in joints.items() if name == each.object}
        links = [link.name for link in package.links]
        T = (
            pose_matrix_of(placement)
            @ link_displacements(package.links, package.joints, mine)[links.index(region.link)]
        )
        middle = transform_points(T, np.mean([region.low, region.high], axis=0)[None])[0]
        (size,) = (item.size for item in room.contents if item.id == each.item)
        pose = items[each.item].copy()
        pose[:3, 3] = 0.0
        pose[:3, 3] = (middle if each.inside else np.full(3, 9.0)) - transform_points(
            pose, np.array([[0, 0, size[2] / 2]])
        )[0]
        items[each.item] = pose
    for each in goal.lifts:
        items[each.item] = items[each.item].copy()
        items[each.item][2, 3] = each.height
    base = next((each.places[0] for each in goal.bases), None)
    return State(joints=joints, items=items, base=base)


def test_a_room_has_goals_of_all_families_in_different_words(goals):
    assert {goal.family for goal in goals} == set(FAMILIES)
    assert len({goal.words for goal in goals}) == len(goals)


def test_goals_begin_unreached_and_are_reached_as_they_say(room, goals):
    for goal in goals:
        started = start_room(room, goal)
        assert not is_reached(goal, started, state_of(started)), goal.words
        assert is_reached(goal, started, solved(goal, room)), goal.words


def test_no_condition_of_a_goal_is_idle(room, goals):
    """Any one joint or thing left as it was at first is enough to miss a goal, unless it is there already."""
    for goal in goals:
        started, done = start_room(room, goal), solved(goal, room)
        first = state_of(started)
        for each in goal.joints:
            key = (each.object, each.joint)
            left = {**done.joints, key: first.joints.get(key, 0.0)}
            there = each.low <= left[key] <= each.high
            assert is_reached(goal, started, replace(done, joints=left)) == there
        assert not (goal.bases and is_reached(goal, started, replace(done, base=start_place(room))))
        for each in (*goal.items, *goal.lifts):
            left = {**done.items, each.item: first.items[each.item]}
            assert not is_reached(goal, started, replace(done, items=left)), goal.words


def test_goals_on_parts_with_handles_come_first(room, tmp_path: Path):
    placement = room.placement("base_b")
    package = cached_package(placement.package)
    for joint in (each for each in package.joints if each.type == "prismatic"):
        (link,) = (each for each in package.links if each.name == joint.child)
        corners = link.hulls[0].vertices[:8]
        handle = HandleAnnotation(
            link=link.name, part=link.name, corners=corners, normal=-np.eye(3)[0], grasp_line=corners[:2],
            width=0.02, clearance=0.02, opening_direction=joint.axis, gapart="handle",
        )  # fmt: skip
        folder = write_package(replace(package, handles=(handle,)), tmp_path / joint.name)
        held = tuple(replace(each, package=folder) if each is placement else each for each in room.placements)
        goals = sample_goals(replace(room, placements=held), 3, 60)
        for family in ("pull", "close"):
            first = next(goal for goal in goals if goal.family == family)
            assert [(each.object, each.joint) for each in first.joints] == [("base_b", joint.name)]


def test_phrases_refer_to_one_object_or_thing(room):
    objects = name_objects(room)
    things = name_items(room, objects)
    assert set(objects) == {placement.id for placement in room.placements}
    phrases = [*(f"the {phrase}" for phrase in objects.values()), *things.values()]
    assert len(set(phrases)) == len(phrases)
    assert objects["base_a"] == "left base cabinet"
    assert objects["base_b"] == "right base cabinet"
    assert things["towel_1"] == "the towel"


def test_every_object_and_part_has_a_phrase_of_its_own_that_survives_the_file(room, tmp_path: Path):
    references = refer(room)
    assert len({each.phrase for each in references}) == len(references)
    assert {each.id for each in references if not each.link} >= {each.id for each in room.placements}
    moving = {
        (placement.id, joint.child)
        for placement in room.placements
        for joint in cached_package(placement.package).joints
        if joint.type != "fixed"
    }
    assert {(each.id, each.link) for each in references if each.link} == moving
    stored = json.loads(write_references(references, tmp_path).read_text())["references"]
    assert [Reference(**each) for each in stored] == list(references)


def test_what_lies_in_a_drawer_moves_with_it_and_stays_inside(room):
    (drawer, *_) = cached_package(room.placement("base_b").package).joints
    tray = np.array([-0.1, 0.0, -0.41])
    spoon = Item(
        id="spoon_1", thing="spoon", holder="base_b", link=drawer.child, position=tuple(tray.tolist()),
        quat=(1.0, 0.0, 0.0, 0.0), size=(0.2, 0.04, 0.01), mass=0.05, colors=((0.7, 0.7, 0.7),) * 2,
    )  # fmt: skip
    full = replace(room, contents=(*room.contents, spoon))
    region = Region(link=drawer.child, low=tuple(tray - 0.05), high=tuple(tray + 0.05))
    goal = Goal(
        words="", family="put_in", items=(ItemGoal(item="spoon_1", object="base_b", regions=(region,)),)
    )
    opened = start_room(full, Goal(words="", family="close", start=(("base_b", drawer.name, 0.25),)))
    way = state_of(opened).items["spoon_1"][:3, 3] - state_of(full).items["spoon_1"][:3, 3]
    np.testing.assert_allclose(way, (0.0, -0.25, 0.0), atol=1e-9)
    assert is_reached(goal, full, state_of(full))
    assert is_reached(goal, opened, state_of(opened))
    assert not is_reached(goal, full, replace(state_of(full), items=state_of(opened).items))


def test_goals_come_back_from_their_file(goals, tmp_path: Path):
    write_goals(goals, tmp_path)
    assert read_goals(tmp_path) == goals
    (tmp_path / "goals.json").write_text('{"format": "artigen-goals", "version": 2, "goals": [{}]}')
    with pytest.raises(GoalFileError, match="structure"):
        read_goals(tmp_path)


def test_mujoco_agrees_with_the_kinematics(room, goals, tmp_path: Path):
    by_family = {goal.family: goal for goal in goals}
    for goal in by_family.values():
        started = start_room(room, goal)
        model = mujoco.MjModel.from_xml_path(str(write_room_mjcf(started, tmp_path)))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        assert not is_reached(goal, started, read_mujoco_state(started, data)), goal.words
        done = solved(goal, room)
        for (name, joint), q in done.joints.items():
            data.joint(f"{name}/{joint}").qpos[0] = q
        for name, pose in done.items.items():
            data.joint(name).qpos[:3] = pose[:3, 3]
        there = replace(read_mujoco_state(started, data), base=done.base)
        assert is_reached(goal, started, there), goal.words


@pytest.mark.sim
def test_a_goal_is_drawn_by_the_seed_and_reached_in_maniskill(room, goals, tmp_path: Path):
    pytest.importorskip("mani_skill")
    assert envs.registration.ROOM_ID
    write_room(room, tmp_path)
    write_goals(goals, tmp_path)
    close, go = (next(goal for goal in goals if goal.family == family) for family in ("close", "go"))
    settings: dict[str, Any] = {"sim_backend": "physx_cpu", "render_backend": "none", "obs_mode": "state"}
    env = gym.make("ArtiGen-Room-v1", scenes=tmp_path, goal="sampled", reward_mode="sparse", **settings)
    words = []
    for seed in (0, 1, 2, 0):
        _, info = env.reset(seed=seed)
        assert not info["success"].any()
        words.append(env.unwrapped.get_language_instruction()[0])
    assert words[0] == words[3]
    assert len(set(words)) > 1
    env.close()
    env = gym.make("ArtiGen-Room-v1", scenes=tmp_path, goal=close.words, reward_mode="sparse", **settings)
    env.reset(seed=0)
    task = env.unwrapped
    ((name, joint, q),) = close.start
    articulation = task.furnished.placed[0][name]
    slot = [each.name for each in articulation.active_joints].index(joint)
    assert float(articulation.get_qpos()[0, slot]) == pytest.approx(q, abs=1e-3)
    assert task.read_state(0, go).base == pytest.approx(start_place(room), abs=1e-3)
    articulation.set_qpos(torch.zeros_like(articulation.get_qpos()))
    assert bool(task.evaluate()["success"].all())
    env.close()
    with pytest.raises(Exception, match="no goal 'dance'"):
        gym.make("ArtiGen-Room-v1", scenes=tmp_path, goal="dance", **settings)


def test_a_thing_in_none_of_the_regions_is_outside(room):
    goal = Goal(
        words="",
        family="take_out",
        items=(ItemGoal(item="towel_1", object="fridge", regions=(), inside=False),),
    )
    assert is_reached(goal, room, state_of(room))
