"""What the scripted robot tries, in which order, how fast, and what it takes for a success."""

from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest

from artigen.types import Joint
from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver import solve as module
from envs.maniskill.solver.plan_open import NoPlan, OpenPlan
from envs.maniskill.solver.plan_put import PutPlan
from envs.maniskill.solver.solve import solve_open_part, solve_put_inside
from sim_export.geometry.hulls import box_hull

ONE = box_hull(np.zeros(3), np.ones(3))
GRIP = np.array([0.1, 0.2, 0.3])


def door(name: str = "door", latches: tuple = ()) -> SimpleNamespace:
    """A door with a range of one radian about an axis through its grip."""
    joint = Joint(
        name=name, type="revolute", parent="a", child="b", origin=GRIP,
        axis=np.array([0.0, 0.0, 1.0]), upper=1.0,
    )  # fmt: skip
    return SimpleNamespace(
        joint=joint, span=1.0, kind="door", verb="open", grip=GRIP, latches=latches, grip_latch=None
    )


def run_stubbed(monkeypatch, stubs: dict, task: SimpleNamespace, solve) -> None:
    """One episode of a task by a solver, whose planning and driving are replaced by ``stubs``."""
    for name, stub in stubs.items():
        monkeypatch.setattr(module, name, stub)
    env = MagicMock(unwrapped=task)
    env.reset.return_value = (None, {})
    solve(env, 0)


@pytest.fixture
def play(monkeypatch):
    """An episode with a door, in which plans do what ``plan`` says of (kind, begin, end): the penetration of
    a plan and the new open fraction, or None if there is no plan. Returns what was tried, moved, and built.
    """

    def make(plan, part=None, goal: float = 1.0):
        at, log = {}, SimpleNamespace(tried=[], moves=[], waits=[], fields=[])
        part = part or door()
        task = SimpleNamespace(
            drawn=[(MagicMock(raised=0.0, floor=0.0), part)],
            latched=True,
            goal_open=goal,
            open_fraction=[0.0],
        )
        driver = SimpleNamespace(
            task=task, over=False, succeeded=False, steps=0, robot=ROBOTS["panda"], chain=None, body=None,
            closed=None, begin=0.0,
        )  # fmt: skip

        def planner(kind):
            def make_plan(opening, grasps, q, begin, end, *, skip=0):
                log.tried.append((kind, opening.part.joint.name, begin, end))
                found = plan(kind, begin, end)
                if found is None:
                    raise NoPlan("no plan")
                if end != begin:
                    at[opening.part.joint.name] = found[1]
                stage = np.full((1, 1), float(kind == "touch"))
                return OpenPlan(
                    before=stage, approach=stage, path=stage, leave=stage, width=0.0, pressed=found[0]
                )

            return make_plan

        stubs = {
            "start": lambda env, info: driver,
            "opened": lambda _, part: at.get(part.joint.name, 0.0),
            "object_hulls": lambda *_: ((ONE,), (ONE,)),
            "object_in_root": lambda _: np.eye(4),
            "arm_angles": lambda _: np.zeros(1),
            "handle_grasps": lambda _: "handle",
            "edge_grasps": lambda _: "edge",
            "push_places": lambda *_: "places",
            "build_field": lambda *args, **_: log.fields.append(args[1:]),
            "plan_open": planner("hold"),
            "plan_touch": planner("touch"),
            "move": lambda _, q, speed=1.0: log.moves.append((float(q[0]), speed)),
            "grip": lambda *_: None,
            "wait": lambda _, count: log.waits.append(count),
        }
        run_stubbed(monkeypatch, stubs, task, solve_open_part)
        return log

    return make


def test_a_door_that_cannot_be_opened_at_once_is_pulled_ajar_or_opened_in_part(play):
    tried = play(lambda *_: None).tried
    assert {begin for kind, _, begin, _ in tried if kind == "touch"} == {0.0, 0.7, 0.5, 0.35, 0.26}
    for kind in ("hold", "touch"):
        ends = [end for which, _, begin, end in tried if which == kind and begin == 0.0]
        assert set(ends) == {1.0, 0.6, 0.3, 0.15}


@pytest.mark.parametrize(("pressed", "touch"), [(0.0079, 0.0), (0.0081, 1.0)])
def test_a_plan_may_press_by_eight_millimetres(play, pressed, touch):
    """Pushing is tried after holding."""
    log = play(lambda kind, _, end: (pressed if kind == "hold" else 0.0, end))
    assert log.moves[0][0] == touch


@pytest.mark.parametrize(("progress", "rounds"), [(0.029, 4), (0.031, 33)])
def test_plans_are_given_up_after_four_rounds_without_progress(play, progress, rounds):
    log = play(lambda _, begin, end: (0.0, begin + progress))
    assert len(log.moves) == 4 * rounds


def test_a_latch_is_opened_halfway_between_where_it_lets_go_and_its_end(play):
    latch = SimpleNamespace(part=door("latch"), fraction=0.8)
    log = play(lambda _, begin, end: (0.0, end), part=door(latches=(latch,)), goal=0.75)
    assert log.tried == [("hold", "latch", 0.0, pytest.approx(0.9)), ("hold", "door", 0.0, 0.75)]


def test_a_part_is_approached_at_half_and_pulled_at_six_tenths_of_the_speed_and_comes_to_rest(play):
    log = play(lambda _, begin, end: (0.0, end))
    assert [speed for _, speed in log.moves] == [1.0, 0.5, 0.6, 1.0]
    assert log.waits == [2, 2, 8, 8]


def test_what_is_near_the_grip_is_resolved_finely(play):
    log = play(lambda _, begin, end: (0.0, end))
    coarse, fine = log.fields[:2], log.fields[2:4]
    assert coarse == [(), ()]
    for box, cell in fine:
        np.testing.assert_allclose(box, np.stack([GRIP - 0.32, GRIP + 0.32]))
        assert cell == 0.005


@pytest.fixture
def carry(monkeypatch):
    """An episode in which every lift raises the cube by a height, and the part has moved by a fraction."""

    def make(rise: float = 0.1, moved: float = 0.0):
        log = SimpleNamespace(moves=[], columns=[], solids=[])
        cube = MagicMock()
        cube.pose.p = np.array([[0.0, 0.0, 0.5]])
        task = MagicMock(cube=cube, cube_size=0.04, open_fraction=[0.5 + moved], drawn=[(1, 2)])
        task.cube_stand.pose.p = [MagicMock(numpy=lambda: np.array([0.4, 0.1, -0.5]))]
        cube.pose.to_transformation_matrix.return_value = [MagicMock(numpy=lambda: np.eye(4))]
        task.solid_at_start.return_value = "start"
        task.resting_places.return_value = np.zeros((1, 3))
        task.containers = [MagicMock(down=True, inwards=np.array([1.0, 0.0, 0.0]))]
        driver = MagicMock(task=task, begin=0.5, over=False, succeeded=False)

        def plan_put(work, *_, **__):
            log.solids.append(work.obstacles[0].field)
            way = np.zeros((3, 1))
            return PutPlan(pick=way, lift=way + 1.0, place=way + 2.0, leave=way + 3.0)

        def move(_, q, speed):
            log.moves.append((int(q[0]), speed))
            if q[0] == 1.0 and speed > 0.6:  # the first waypoint of a lift
                cube.pose.p = cube.pose.p + np.array([0.0, 0.0, rise])

        stubs = {
            "start": lambda *_: driver,
            "plan_put": plan_put,
            "move": move,
            "grip": lambda *_: None,
            "wait": lambda *_: None,
            "build_field": lambda hulls: log.columns.append(hulls[0].vertices),
            "object_field": lambda *_: "now",
            "object_qpos": lambda _: {},
            "object_in_root": lambda _: np.eye(4),
            "root_pose": lambda _: np.eye(4),
            "arm_angles": lambda _: np.zeros(1),
        }
        run_stubbed(monkeypatch, stubs, task, solve_put_inside)
        return log

    return make


@pytest.mark.parametrize(("rise", "picks"), [(0.051, 1), (0.049, 3)])
def test_a_cube_in_the_gripper_has_risen_by_five_centimetres(carry, rise, picks):
    assert len(carry(rise).solids) == picks


@pytest.mark.parametrize(
    ("moved", "solid"), [(0.019, "start"), (-0.019, "start"), (0.021, "now"), (-0.021, "now")]
)
def test_a_part_that_moved_by_a_fiftieth_is_looked_at_again(carry, moved, solid):
    assert carry(moved=moved).solids == [solid]


def test_the_column_below_the_cube_is_solid_for_forty_centimetres(carry):
    (corners,) = carry().columns
    np.testing.assert_allclose(corners.min(axis=0), [0.37, 0.07, 0.1])
    np.testing.assert_allclose(corners.max(axis=0), [0.43, 0.13, 0.5])


def test_a_stage_begins_fast_and_goes_on_slowly(carry):
    assert carry().moves == [(stage, speed) for stage in range(4) for speed in (0.9, 0.5, 0.5)]
