"""Turn, press, lift, slide: which parts are for which verb, which are latches, where fingers find a hold."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from artigen.types import Joint
from envs.maniskill.hulls import hulls_at, plinth_under
from envs.maniskill.objects import (
    TaskError,
    TaskObject,
    on_plinth,
    read_object,
    read_objects,
)
from envs.maniskill.solver.contacts import _thickness, is_inside, surface_samples
from envs.maniskill.solver.field import build_field, distances
from envs.maniskill.verbs import verb_of
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull
from sim_export.package import Requirement, SimPackage

FRONT, UP, SIDE = np.array([-1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def latched(package: SimPackage, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The cabinet with a door that its knob holds shut."""
    labels = {link.name: link.label for link in package.links}
    door, knob = (next(x for x in package.joints if labels[x.child] == label) for label in ("door", "knob"))
    joints = tuple(replace(x, parent=door.child) if x is knob else x for x in package.joints)
    need = Requirement(joint=door.name, needs=knob.name, fraction=0.9)
    changed = replace(package, joints=joints, requires_open=(need,), handles=package.handles)
    return write_package(changed, tmp_path_factory.mktemp("latched") / "cabinet")


def joint(kind: str, axis: np.ndarray, origin: np.ndarray) -> Joint:
    return Joint(
        name="j", type=kind, parent="a", child="b", origin=origin, axis=axis, upper=0.5,
    )  # type: ignore[arg-type]  # fmt: skip


def cube(middle: np.ndarray, half: float = 0.01) -> np.ndarray:
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return middle + half * signs


@pytest.mark.parametrize(
    ("kind", "axis", "origin", "label", "verb"),
    [
        ("revolute", FRONT, np.zeros(3), "knob", "turn"),  # a dial
        ("revolute", -FRONT, 0.06 * SIDE, "knob", "turn"),  # a lever on its spindle
        ("prismatic", -FRONT, np.zeros(3), "knob", "press"),  # a button
        ("prismatic", -UP, np.zeros(3), "knob", "press"),  # a toaster's lever
        ("revolute", SIDE, np.zeros(3), "knob", "press"),  # a rocker, about its middle
        ("revolute", SIDE, 0.2 * FRONT, "handle", "lift"),
        ("revolute", UP, 0.4 * SIDE, "door", "open"),
        ("revolute", SIDE, -0.4 * FRONT, "door", "lift"),  # a lid, hinged at the rear
        ("prismatic", UP, np.zeros(3), "door", "lift"),
        ("prismatic", FRONT, np.zeros(3), "tray", "slide"),
        ("prismatic", SIDE, np.zeros(3), "door", "slide"),
    ],
)
def test_the_verb_is_that_of_the_motion(kind, axis, origin, label, verb):
    """The part is before the point 0, and its carrier behind it."""
    grip = np.zeros(3)
    motion = joint(kind, axis, origin)
    if verb == "lift" and kind == "revolute":
        motion = joint(kind, axis if np.cross(axis, -origin)[2] > 0 else -axis, origin)
    assert verb_of(motion, label, grip, FRONT, cube(grip)) == verb


def aslant(cosine: float, along: np.ndarray, across: np.ndarray) -> np.ndarray:
    """A unit direction with that cosine to ``along``."""
    return cosine * along + np.sqrt(1.0 - cosine**2) * across


@pytest.mark.parametrize(
    ("kind", "axis", "origin", "label", "verbs"),
    [
        ("revolute", lambda x: aslant(x, FRONT, UP), np.zeros(3), "knob", ("press", "turn")),
        ("prismatic", lambda x: aslant(x, -FRONT, SIDE), np.zeros(3), "knob", ("slide", "press")),
        ("prismatic", lambda x: aslant(x, -UP, SIDE), np.zeros(3), "knob", ("slide", "press")),
        ("prismatic", lambda x: aslant(x, UP, SIDE), np.zeros(3), "door", ("slide", "lift")),
    ],
)
def test_directions_are_parallel_from_a_cosine_of_seven_tenths(kind, axis, origin, label, verbs):
    for cosine, verb in zip((0.69, 0.71), verbs, strict=True):
        motion = joint(kind, axis(cosine), origin)
        assert verb_of(motion, label, np.zeros(3), FRONT, cube(np.zeros(3))) == verb


@pytest.mark.parametrize(("share", "verbs"), [(0.24, {"press"}), (0.26, {"press", "lift"})])
def test_a_part_rocks_about_an_axis_within_a_quarter_of_its_length_from_its_middle(share, verbs):
    """Beyond that, one of the two ways to turn lifts it."""
    ways = (joint("revolute", sign * SIDE, -share * 0.02 * FRONT) for sign in (1.0, -1.0))
    assert {verb_of(way, "knob", np.zeros(3), FRONT, cube(np.zeros(3))) for way in ways} == verbs


def test_verbs_share_out_all_that_moves(package, tmp_path):
    folder = write_package(package, tmp_path / "cabinet")
    moved = {x.joint.name: x.verb for x in read_object(folder, "any").parts}
    for verb in ("turn", "press", "lift", "slide"):
        for part in read_object(folder, "any", "optional", verb).parts:
            assert part.verb == verb
            assert moved.setdefault(part.joint.name, verb) == verb
    moving = {x.name for x in package.joints if x.type != "fixed" and x.kind != "screw"}
    assert set(moved) == moving
    with pytest.raises(ValueError, match="verb 'shove', expected one of open, turn"):
        read_objects(folder, "any", verb="shove", validation="any")  # type: ignore[arg-type]


def test_a_knob_without_limits_is_turned_by_a_quarter(package, tmp_path):
    labels = {link.name: link.label for link in package.links}
    joints = tuple(
        replace(
            x,
            type="continuous",
        )
        if labels[x.child] == "knob"
        else x
        for x in package.joints
    )
    folder = write_package(replace(package, joints=joints), tmp_path / "endless")
    part = next(x for x in read_object(folder, "knob", "optional", "turn").parts)
    assert part.span == pytest.approx(np.pi / 2)


def test_a_latch_is_what_a_leaf_carries_and_needs(latched):
    entry = read_object(latched, "door")
    part = entry.parts[0]
    assert [x.fraction for x in part.latches] == [0.9]
    assert part.latches[0].part.kind == "knob"
    assert part.latches[0].part.joint.name in part.needs
    assert part.grip_latch is None or part.grip_latch is part.latches[0]


def test_low_objects_stand_on_a_plinth(latched):
    entry = read_object(latched, "any")
    height = float(np.ptp(entry.bounds[:, 2]))

    def of_height(value: float) -> TaskObject:
        return replace(entry, bounds=np.stack([entry.bounds[0], [*entry.bounds[1, :2], value]]))

    low = of_height(float(entry.bounds[0, 2]) + 0.75 - 1e-6)
    assert on_plinth(low).raised == 0.5
    assert on_plinth(of_height(float(entry.bounds[0, 2]) + 0.75)).raised == 0.0
    assert on_plinth(entry).raised == (0.5 if height < 0.75 else 0.0)
    plinth = plinth_under(on_plinth(low)).vertices
    assert np.ptp(plinth[:, 2]) == pytest.approx(0.5)
    assert plinth[:, 2].max() == pytest.approx(entry.bounds[0, 2])


def test_samples_lie_on_the_hull_and_face_outwards():
    hull = box_hull(np.array([-0.1, -0.2, 0.0]), np.array([0.1, 0.2, 0.03]))
    points, normals = surface_samples((hull,), 0.02)
    assert len(points) > 100
    assert is_inside(hull, points).all()
    assert not is_inside(hull, points + 1e-4 * normals).any()


def test_how_thick_a_union_of_boards_is():
    boards = [box_hull(np.array([x, 0.0, 0.0]), np.array([x + 0.01, 0.2, 0.2])) for x in (0.0, 0.01)]
    points = np.array([[0.0, 0.1, 0.1], [0.0, 0.05, 0.1]])
    inwards = np.repeat([[1.0, 0.0, 0.0]], 2, axis=0)
    np.testing.assert_allclose(_thickness(boards, points, inwards, 0.07), 0.02, atol=0.002)
    assert np.isinf(_thickness(boards, points, np.repeat([[0.0, 1.0, 0.0]], 2, axis=0), 0.05)).all()


def test_below_the_ground_everything_is_solid():
    field = build_field((box_hull(np.zeros(3), np.full(3, 0.1)),), ground=-0.3)
    points = np.array([[2.0, 0.0, -0.25], [2.0, 0.0, -0.5], [2.0, 0.0, 3.0], [0.05, 0.05, 0.05]])
    np.testing.assert_allclose(distances(field, points), [0.05, 0.0, 0.12, 0.0], atol=1e-6)


def test_a_box_of_interest_cuts_a_field_and_changes_nothing_in_it():
    hull = box_hull(np.zeros(3), np.array([0.4, 0.02, 0.02]))
    box = np.array([[-0.05, -0.05, -0.05], [0.1, 0.1, 0.1]])
    small = build_field((hull, box_hull(np.full(3, 2.0), np.full(3, 2.1))), box, 0.005)
    points = np.random.default_rng(0).uniform(*box, (200, 3))
    true = np.linalg.norm(np.maximum(np.maximum(-points, points - hull.vertices.max(axis=0)), 0.0), axis=1)
    np.testing.assert_allclose(distances(small, points), true, atol=1.5 * small.cell)


@pytest.mark.sim
def test_a_latched_door_starts_latched_unless_it_is_open(latched):
    pytest.importorskip("mani_skill")
    import envs  # noqa: F401  registers the tasks

    settings: dict[str, Any] = {"sim_backend": "physx_cpu", "render_backend": "none", "validation": "any"}
    for extra, shut in (({}, True), ({"latches": "open"}, False), ({"goal": "close"}, False)):
        env = gym.make("ArtiGen-OpenPart-v1", packages=str(latched), part="door", obs_mode="state",
                       **extra, **settings)  # fmt: skip
        env.reset(seed=0)
        task: Any = env.unwrapped
        latch = task.drawn[0][1].latches[0].part
        names = [x.name for x in task.built[0].active_joints]
        turned = float(task.object.get_qpos()[0, names.index(latch.joint.name)])
        assert (turned == pytest.approx(latch.joint.lower)) == shut
        env.close()
    with pytest.raises(TaskError, match="to press that one joint moves"):
        gym.make("ArtiGen-PressPart-v1", packages=str(latched), part="drawer", **settings)


def test_hulls_of_followers_are_where_their_leader_takes_them(package, tmp_path):
    labels = {link.name: link.label for link in package.links}
    first, second = [x for x in package.joints if labels[x.child] in ("door", "drawer")][:2]
    ratio = second.upper / first.upper
    joints = tuple(replace(x, follows=first.name, ratio=ratio) if x is second else x for x in package.joints)
    entry = read_object(write_package(replace(package, joints=joints), tmp_path / "pair"), "any")
    assert dict(entry.left_out)[second.name] == f"follows {first.name}"
    part = next(x for x in entry.parts if x.joint.name == first.name)

    def lowest(qpos: dict[str, float]) -> np.ndarray:
        return np.concatenate([h.vertices for group in hulls_at(entry, part, qpos) for h in group]).min(
            axis=0
        )

    both = lowest({first.name: first.upper, second.name: 0.0})
    np.testing.assert_allclose(both, lowest({first.name: first.upper}))
    free = read_object(write_package(package, tmp_path / "free"), "any")
    moved = np.concatenate(
        [
            h.vertices
            for g in hulls_at(free, part, {first.name: first.upper, second.name: second.upper})
            for h in g
        ]
    )
    np.testing.assert_allclose(both, moved.min(axis=0), atol=1e-9)
