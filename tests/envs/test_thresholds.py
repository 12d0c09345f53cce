"""Both sides of the thresholds of L3 and of the gymnasium environments, and closed forms of their trials."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest

from artigen.types import Joint
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull
from sim_export.package import Inertial, Link, SimPackage
from sim_export.report import CheckResult

pytest.importorskip("sapien")
import envs.dynamics as dynamics
import envs.trials as support
import envs.trials as trials
from envs.actuate import ActuateConfig, ActuateEnv
from envs.dynamics import MujocoResult
from envs.hand import Moved, hand_effort
from envs.joint_sweep import JointSweepEnv
from envs.plan import JointPlan, TrialPlan
from envs.settle import SettleEnv
from envs.sim.loaded import LinkLoad, set_open_fraction
from envs.trials import PullResult, StandResult, TrialResults, run_trials

pytestmark = pytest.mark.sim
G = 9.81
FOLDER = Path()


def joint_of(kind: str = "prismatic", upper: float = 0.5, **given: object) -> Joint:
    """A joint from the body to the only part that moves."""
    given = {"origin": np.zeros(3), "axis": np.array([-1.0, 0.0, 0.0]), "velocity": 10.0, **given}
    return Joint(
        name="joint_0", type=kind, parent="link_1", child="link_0", upper=upper, **given
    )  # fmt: skip


def results(joint: Joint | None = None, **changes: object) -> TrialResults:
    """Measurements of an object whose only joint does all that it should."""
    plan = JointPlan(
        opening=30.0, closing=30.0, needs=(), speed_limit=2.0, lean=np.zeros(3), axis=np.zeros(3),
    )  # fmt: skip
    sound = TrialResults(
        joints=(joint or joint_of(),),
        loads=(LinkLoad(name="link_0", hulls=1, shapes=1, lost=(), mass=1.0, engine_mass=1.0),),
        plan=TrialPlan(joints=(plan,), groups=((0,),)),
        rest_drift=np.zeros(1),
        rest_speed=np.zeros(1),
        lean_drift=np.zeros(1),
        pulls=(PullResult(opened=1.0, open_gap=0.0, close_gap=0.0, peak_speed=0.0),),
        stand=StandResult(tilt=0.0, drift=0.0, penetration=0.0, overhang=-0.1),
        size_ratio=1.0,
        trace=np.zeros(4),
    )
    return replace(sound, **changes)


def pulled(joint: Joint | None = None, **changes: float) -> TrialResults:
    sound = results(joint)
    return replace(sound, pulls=(replace(sound.pulls[0], **changes),))


def stood(**changes: float) -> CheckResult:
    sound = results()
    package = SimPackage(name="a", category="Table", visual="voxels", links=(), joints=())
    return dynamics.check_stand(package, replace(sound, stand=replace(sound.stand, **changes)))


def weighed(mass: float) -> CheckResult:
    sound = results()
    return dynamics.check_loads(replace(sound, loads=(replace(sound.loads[0], engine_mass=mass),)))


SMALL = joint_of("revolute", 0.2)
KEY = joint_of(upper=0.001)
ROWS: dict[str, tuple[Callable[[float], CheckResult], float, float]] = {
    "mass": (weighed, 1 + 0.9e-4, 1 + 1.1e-4),
    "rest": (lambda x: dynamics.check_rest(results(rest_drift=np.array([0.5 * x]))), 0.0099, 0.0101),
    "rest speed": (lambda x: dynamics.check_rest(results(rest_speed=np.array([x]))), 0.9e-3, 1.1e-3),
    "tilt": (lambda x: stood(tilt=x), 1.9, 2.1),
    "drift": (lambda x: stood(drift=x), 4.9e-3, 5.1e-3),
    "sinks": (lambda x: stood(penetration=x), 4.9e-3, 5.1e-3),
    "opens": (lambda x: dynamics.check_opens(pulled(open_gap=0.5 * x)), 0.0099, 0.0101),
    "closes": (lambda x: dynamics.check_opens(pulled(close_gap=0.5 * x)), 0.0099, 0.0101),
    "turns": (lambda x: dynamics.check_opens(pulled(SMALL, open_gap=np.radians(x))), 0.49, 0.51),
    "slides": (lambda x: dynamics.check_opens(pulled(KEY, open_gap=x)), 0.99e-4, 1.01e-4),
    "stays": (lambda x: dynamics.check_stays_closed(results(lean_drift=np.array([0.5 * x]))), 0.0099, 0.0101),
    "size": (lambda x: dynamics.check_energy(results(size_ratio=x)), 9.9, 10.1),
    "speed": (lambda x: dynamics.check_energy(pulled(peak_speed=x)), 1.99, 2.01),
}


@pytest.mark.parametrize("name", ROWS)
def test_what_is_within_passes_and_what_is_beyond_fails(name):
    judge, within, beyond = ROWS[name]
    assert (judge(within).verdict, judge(beyond).verdict) == ("pass", "fail")


@pytest.mark.parametrize(("difference", "verdict"), [(0.9e-6, "pass"), (1.1e-6, "fail")])
def test_a_second_run_may_differ_by_a_millionth(monkeypatch, difference, verdict):
    monkeypatch.setattr(dynamics, "run_trials", lambda *_, **__: results(trace=np.full(4, difference)))
    package = SimPackage(name="a", category="Table", visual="voxels", links=(), joints=())
    assert dynamics.check_repeat(FOLDER, package, results()).verdict == verdict


@pytest.mark.parametrize(("force", "verdict"), [(0.9e-3, "pass"), (1.1e-3, "fail")])
def test_constraints_may_push_with_a_millinewton(monkeypatch, force, verdict):
    monkeypatch.setattr(dynamics, "compile_package", lambda _: (MujocoResult(file="a", force=force),))
    assert dynamics.check_mujoco(FOLDER).verdict == verdict


@pytest.mark.parametrize(
    ("label", "kind", "lever", "expected"),
    [
        ("drawer", "prismatic", 0.0, 30.0),
        ("knob", "prismatic", 0.0, 10.0),
        ("door", "revolute", 0.6, 18.0),
        ("door", "revolute", 0.8, 20.0),
        ("door", "revolute", 0.2, 6.0),
        ("knob", "continuous", 0.2, 1.0),
        ("knob", "continuous", 0.05, 0.5),
    ],
)
def test_a_hand_pulls_with_a_force_and_turns_with_what_its_lever_makes_of_it(label, kind, lever, expected):
    joint = SimpleNamespace(label=label, spec=joint_of(kind), handle=None)
    moved = Moved(
        mass=1.0, com=np.zeros(3), inertia=1.0, vertices=np.array([[0.0, lever, 0.0]]),
        axis=np.array([0.0, 0.0, 1.0]), origin=np.zeros(3),
    )  # fmt: skip
    assert hand_effort(joint, moved) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("label", "off", "expected"), [("handle", 0.011, 0.33), ("handle", 0.009, 1.47), ("knob", 0.011, 0.51)]
)
def test_a_hand_holds_a_handle_in_its_middle_unless_that_is_on_the_axis(label, off, expected):
    """A cross of 8 cm, whose middle is beside the axis."""
    corners = np.array([[x + off, 0.0, 0.0] for x in (-0.04, 0.04)])
    spec = joint_of("revolute", axis=np.array([0.0, 0.0, 1.0]))
    joint = SimpleNamespace(label=label, spec=spec, handle=SimpleNamespace(corners=corners))
    assert hand_effort(joint, SimpleNamespace()) == pytest.approx(expected)


@pytest.mark.parametrize(("height", "stands"), [(4.9e-3, True), (5.1e-3, False)])
def test_what_is_within_five_millimetres_of_the_floor_stands_on_it(monkeypatch, height, stands):
    """Three feet carry what lies between them; the fourth, beyond which the rest leans, is a bit short."""
    feet = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, height]], dtype=float)
    monkeypatch.setattr(support, "center_of_mass", lambda _: np.array([0.7, 0.7, 0.5]))
    assert (support.overhang_of(SimpleNamespace(), feet) < 0.0) == stands


def block(name: str, low: object, high: object, mass: float) -> Link:
    """A box with a mass."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    inertial = Inertial(mass=mass, com=(low + high) / 2.0, inertia=0.1 * mass * np.eye(3))
    return Link(
        name=name, label="drawer" if name == "link_0" else "base", parts=(name,), visuals=(),
        hulls=(box_hull(low, high),), inertial=inertial,
    )  # fmt: skip


def run(folder: Path, part: Link, body: Link, **given: object) -> TrialResults:
    """The trials of a body and a part that slides."""
    package = SimPackage(
        name="slide", category="Table", visual="voxels", links=(part, body), joints=(joint_of(**given),)
    )
    return run_trials(write_package(package, folder / "slide"), package, 0.01)


AHEAD = block("link_0", (-0.5, -0.1, 0.2), (-0.4, 0.1, 0.4), 1.0)
BODY = block("link_1", (0.0, -0.5, 0.0), (1.0, 0.5, 0.2), 50.0)


def test_trials_last_as_long_and_lean_as_far_as_they_say(tmp_path):
    """A damped slide moves at the speed of force over damping."""
    found = run(tmp_path, AHEAD, BODY, damping=100.0, upper=3.0)
    assert found.rest_drift[0] == pytest.approx(0.0, abs=1e-6)
    assert found.lean_drift[0] == pytest.approx(G * np.sin(np.radians(5.0)) / 100.0 * 2.0, rel=0.1)
    assert found.pulls[0].opened == pytest.approx(30.0 / 100.0 * 5.0 / 3.0, rel=0.1)
    # The work of hand and gravity, all of it speed, and half as much again.
    assert found.plan.joints[0].speed_limit == pytest.approx(1.5 * np.sqrt(2.0 * 30.0 * 3.0), rel=1e-6)


def test_a_slide_that_hangs_sinks_for_five_seconds(tmp_path):
    found = run(tmp_path, AHEAD, BODY, damping=1000.0, upper=1.0, axis=np.array([0.0, 0.0, -1.0]))
    assert found.rest_drift[0] == pytest.approx(G / 1000.0 * 5.0, rel=0.02)


@pytest.mark.parametrize(("speed", "seconds"), [(0.99e-3, 0.26), (1.01e-3, 5.0)])
def test_what_covers_less_than_a_thousandth_of_its_range_a_second_is_given_up(speed, seconds):
    """After a quarter of a second; what is faster has five."""
    loaded = SimpleNamespace(
        joints=[
            SimpleNamespace(index=0, span=1.0, limited=True, spec=joint_of(upper=1.0), engine=MagicMock())
        ],
        articulation=SimpleNamespace(qpos=np.zeros(1), qvel=np.array([speed])),
        scene=SimpleNamespace(timestep=0.01),
    )

    def step() -> None:
        loaded.articulation.qpos = loaded.articulation.qpos + 0.01 * speed

    loaded.step = step
    plan = results().plan.joints[0]
    opened, *_ = trials._drive(loaded, [(loaded.joints[0], plan)], [], direction=1.0, kept=[])
    assert opened[0] == pytest.approx(speed * seconds, rel=0.05)


def test_a_free_object_is_watched_for_three_seconds(tmp_path):
    """A weight before its edge tips it slowly: its inertia is large."""
    moment, before = 1000.0, 0.1
    body = replace(BODY.inertial, com=np.array([-before, 0.0, 0.1]), inertia=moment * np.eye(3))
    found = run(
        tmp_path, replace(AHEAD, inertial=replace(AHEAD.inertial, mass=0.01)), replace(BODY, inertial=body)
    )
    assert found.stand.tilt == pytest.approx(np.degrees(50.0 * G * before / moment * 3.0**2 / 2.0), rel=0.05)


@pytest.mark.parametrize(("lever", "turned"), [(0.0095, True), (0.0105, False)])
def test_a_handle_within_a_centimetre_of_the_axis_is_turned(folder, lever, turned):
    env = ActuateEnv(folder, ActuateConfig(joint="joint_1"))
    env.reset(seed=0)
    env._grip = np.array([lever, 0.0, 0.0])
    along = abs(env._observe()["opening_direction"][2])
    assert along == pytest.approx(float(turned), abs=1e-6)


@pytest.mark.parametrize(("share", "success"), [(0.895, False), (0.905, True)])
def test_a_joint_counts_as_open_from_nine_tenths_of_its_range(folder, share, success):
    env = ActuateEnv(folder, ActuateConfig(joint="joint_1"))
    env.reset(seed=0)
    set_open_fraction(env.loaded, [0.0, share, 0.0, 0.0])
    *_, info = env.step(np.zeros(1))
    assert info["opened"] == pytest.approx(share, abs=1e-3)
    assert info["success"] == success


def test_a_step_is_a_twentieth_of_a_second_in_five(folder):
    """In free fall from two centimetres, with a push aside by a fifth of the weight."""
    env = SettleEnv(folder)
    env.reset(seed=0)
    observation = env.step(np.array([0.0, 1.0, 0.0]))[0]
    assert observation["linear_velocity"][2] == pytest.approx(-G / 20.0, rel=3e-3)
    assert observation["linear_velocity"][1] == pytest.approx(0.2 * G / 20.0, rel=3e-3)
    assert observation["height"][0] == pytest.approx(0.02 - G / 20.0**2 * (1.0 + 1.0 / 5.0) / 2.0, abs=1e-4)


def test_it_starts_leaned_by_one_degree_at_most(folder):
    env = SettleEnv(folder)
    tilts = [env.reset(seed=seed)[1]["tilt_degrees"] for seed in range(12)]
    assert 0.8 < max(tilts) <= 1.0


@pytest.mark.parametrize(
    ("tilt", "speed", "settled", "over"),
    [
        (1.9, 0.0, True, False),
        (2.1, 0.0, False, False),
        (0.0, 0.0099, True, False),
        (0.0, 0.0101, False, False),
        (44.9, 0.0, False, False),
        (45.1, 0.0, False, True),
    ],
)
def test_it_is_settled_or_has_fallen_beyond_a_tilt_and_a_speed(
    folder, monkeypatch, tilt, speed, settled, over
):
    env = SettleEnv(folder)
    env.reset(seed=0)
    monkeypatch.setattr(env, "_info", lambda: {"success": False, "tilt_degrees": tilt, "speed": speed})
    done = [env.step(np.zeros(3)) for _ in range(11)]
    assert [reward for _, reward, *_ in done] == [float(settled)] * 11
    assert done[0][2] == over
    assert [info["success"] for *_, info in done] == [settled and step >= 10 for step in range(1, 12)]


def test_a_sweep_goes_by_tenths_and_forgives_two_millimetres(folder, monkeypatch):
    env = JointSweepEnv(folder)
    observation, info = env.reset(seed=0)
    assert info["covered"] == pytest.approx(0.1)
    observation, *_ = env.step(np.ones(4))
    np.testing.assert_allclose(observation["open_fraction"], 0.1, atol=1e-6)
    for depth, penalty in ((1.9e-3, 0.0), (2.1e-3, -1.0)):
        found = {pair: rest + depth for pair, rest in env._rest.items()}
        monkeypatch.setattr(env, "_overlaps", lambda found=found: found)
        assert env.step(np.zeros(4))[1] == penalty
