"""Other engines as witnesses: laws of the plan, seeded defects, thresholds at their boundary, no engine."""

import json
import shutil
import sys
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from artigen.errors import ArtigenError
from envs.config import EngineChoice
from envs.engines.choose import choose_engines
from envs.engines.judge import judge
from envs.engines.plan import EnginePlan, make_plan, moved_load, travelled
from envs.engines.runners.harness import bisect, push
from envs.engines.witness import ask_engines, run_engine
from sim_export.files.read import read_package
from sim_export.report import CheckResult, Report, describe_report

STEPS = 200


@pytest.fixture(scope="module")
def plan(folder) -> EnginePlan:
    return make_plan(folder, read_package(folder, appearance=False), steps=STEPS)


@pytest.fixture(scope="module")
def answer(plan) -> dict:
    return run_engine(plan, EngineChoice(name="mujoco"), 120.0)


def verdicts(plan: EnginePlan, answer: dict) -> dict[str, str]:
    return {check.id[:4]: check.verdict for check in judge("mujoco", plan, answer)}


def failures(plan: EnginePlan, answer: dict) -> set[str]:
    return {check for check, verdict in verdicts(plan, answer).items() if verdict == "fail"}


def copy_with(folder: Path, target: Path, file: str, old: str, new: str) -> Path:
    """A copy of a package with the first ``old`` in one file replaced."""
    shutil.copytree(folder, target)
    text = (target / file).read_text()
    assert old in text
    (target / file).write_text(text.replace(old, new, 1))
    return target


def test_motion_without_damping_is_the_limit_of_motion_with_little():
    times = np.linspace(0.0, 1.0, 11)
    free = travelled(2.0, 4.0, 0.0, times)
    assert np.allclose(free, 0.25 * times**2)
    assert np.allclose(travelled(2.0, 4.0, 1e-3, times), free, rtol=1e-3)


def test_motion_against_damping_ends_at_the_speed_where_both_balance():
    times = np.array([99.0, 100.0])
    first, last = travelled(3.0, 1.0, 6.0, times)
    assert last - first == pytest.approx(0.5)


def test_a_plan_is_plain_json_and_brackets_the_friction(plan):
    again = json.loads(json.dumps(asdict(plan)))
    assert [joint["name"] for joint in again["joints"]] == [joint.name for joint in plan.joints]
    tried = [joint for joint in plan.joints if joint.trial is not None]
    assert tried
    for joint in tried:
        assert joint.trial is not None
        assert joint.trial.held == pytest.approx(0.9 * joint.friction)
        assert joint.trial.slipped == pytest.approx(1.1 * joint.friction)
        assert joint.lower < joint.trial.start < joint.upper
        assert joint.trial.start + joint.trial.expected < joint.upper


def test_a_push_overcomes_half_more_than_the_friction_and_crosses_the_range_in_a_second(plan, folder):
    """From rest, 2 m s pushes a mass over a distance s in a second."""
    package = read_package(folder, appearance=False)
    joints = {joint.name: joint for joint in package.joints}
    for task in plan.joints:
        span = task.upper - task.lower
        assert task.speed == pytest.approx(span)
        free = task.effort - task.damping * task.speed - 1.5 * task.friction
        assert free == pytest.approx(2.0 * moved_load(package, joints[task.name]) * span, abs=1e-9)


@pytest.mark.sim
@pytest.mark.parametrize("engine", ["mujoco", "mujoco-urdf", "sapien"])
def test_a_good_package_passes_in_every_engine_of_this_environment(plan, engine):
    found = run_engine(plan, EngineChoice(name=engine), 120.0)
    assert "rest" in found, found
    assert failures(plan, found) == set()


@pytest.mark.sim
@pytest.mark.parametrize(
    ("pattern", "new", "caught"),
    [
        ("frictionloss", "0", {"V501", "V506"}),
        ("mass", "77", {"V502"}),
        ("range", "0 0.05", {"V501", "V505"}),
    ],
)
def test_a_value_changed_in_the_mjcf_only_is_caught(folder, plan, tmp_path, pattern, new, caught):
    text = (folder / "mobility.mjcf.xml").read_text()
    begin = text.index(f'{pattern}="') + len(pattern) + 2
    old = text[begin - len(pattern) - 2 : text.index('"', begin) + 1]
    broken = copy_with(folder, tmp_path / "broken", "mobility.mjcf.xml", old, f'{pattern}="{new}"')
    found = run_engine(replace(plan, folder=str(broken)), EngineChoice(name="mujoco"), 120.0)
    assert caught <= failures(plan, found)
    assert "V503" not in failures(plan, found)


@pytest.mark.sim
def test_a_blocked_joint_is_caught(folder, plan, tmp_path):
    """A wall in the world, in front of the whole object."""
    wall = '<worldbody><geom type="box" size="0.01 5 5" pos="-0.9 0 0" />'
    broken = copy_with(folder, tmp_path / "blocked", "mobility.mjcf.xml", "<worldbody>", wall)
    low = min(float(hull.vertices[:, 0].min()) for link in read_package(folder).links for hull in link.hulls)
    text = (broken / "mobility.mjcf.xml").read_text().replace('pos="-0.9 0 0"', f'pos="{low - 0.03:.4f} 0 0"')
    (broken / "mobility.mjcf.xml").write_text(text)
    found = run_engine(replace(plan, folder=str(broken)), EngineChoice(name="mujoco"), 120.0)
    assert "V505" in failures(plan, found)


@pytest.mark.sim
def test_a_file_that_the_engine_refuses_is_a_failure_with_its_sentence(folder, plan, tmp_path):
    broken = copy_with(
        folder, tmp_path / "refused", "mobility.mjcf.xml", "<worldbody>", "<worldbody><nonsense/>"
    )
    checks = ask_engines(broken, (EngineChoice(name="mujoco"),), 120.0)
    assert {check.verdict for check in checks} == {"fail"}
    assert "nonsense" in checks[0].message


@pytest.mark.sim
def test_thresholds_at_their_boundary(plan, answer):
    joint = next(joint for joint in plan.joints if joint.trial is not None)
    name, span = joint.name, joint.upper - joint.lower

    def judged(key: str, entry: str, value: float) -> set[str]:
        changed = json.loads(json.dumps(answer))
        if key == "rest":
            changed["rest"][entry][name] = value
        else:
            changed[key][name][entry] = value
        return failures(plan, changed)

    assert failures(plan, answer) == set()
    for key, entry, limit, worse, check in (
        ("rest", "drift", 0.01 * span, 1.0, "V504"),
        ("range", "open_gap", joint.tolerance, 1.0, "V505"),
        ("range", "close_gap", joint.tolerance, 1.0, "V505"),
        ("friction", "held", 0.2, 1.0, "V506"),
        ("friction", "slipped", 0.5, -1.0, "V506"),
    ):
        assert judged(key, entry, limit * (1.0 - 1e-6 * worse)) == set()
        assert judged(key, entry, limit * (1.0 + 1e-6 * worse)) == {check}
        assert judged(key, entry, float("nan")) == {check}


@pytest.mark.sim
def test_a_step_less_and_a_gram_more_are_noticed(plan, answer):
    short = json.loads(json.dumps(answer))
    short["rest"]["steps"] -= 1
    assert failures(plan, short) == {"V503"}
    heavy = json.loads(json.dumps(answer))
    link = plan.links[0]
    assert link.mass is not None
    heavy["links"][link.name]["mass"] = link.mass * (1.0 + 2e-4)
    assert failures(plan, heavy) == {"V502"}
    lost = json.loads(json.dumps(answer))
    lost["links"][link.name]["shapes"] -= 1
    assert failures(plan, lost) == {"V501"}


@pytest.mark.sim
@pytest.mark.parametrize(("steps", "caught"), [(1999, {"V503"}), (2000, set())])
def test_joints_stay_finite_for_two_thousand_steps(folder, answer, steps, caught):
    """Where a plan does not ask for fewer."""
    plan = make_plan(folder, read_package(folder, appearance=False))
    lasted = json.loads(json.dumps(answer))
    lasted["rest"]["steps"] = steps
    assert failures(plan, lasted) == caught


@pytest.mark.sim
@pytest.mark.parametrize(("share", "caught"), [(0.99, set()), (1.01, {"V501", "V502"})])
def test_numbers_may_differ_by_their_tolerance(plan, answer, share, caught):
    near = json.loads(json.dumps(answer))
    link, joint = plan.links[0], plan.joints[0]
    assert link.mass is not None
    near["links"][link.name]["mass"] = link.mass * (1.0 + share * 1e-4)
    near["joints"][joint.name]["upper"] = joint.upper * (1.0 + share * 1e-4)
    assert failures(plan, near) == caught


@pytest.mark.parametrize("times", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("kind", ["prismatic", "revolute"])
def test_an_end_may_be_missed_by_a_share_of_the_range_or_by_a_least_length(folder, kind, times):
    """Below the range at which both are the same the least length counts, above it the share."""
    package = read_package(folder, appearance=False)
    least = 1e-4 if kind == "prismatic" else np.radians(0.5)
    first = next(joint for joint in package.joints if joint.type != "fixed")
    short = replace(first, type=kind, lower=0.0, upper=times * least / 0.01)
    joints = tuple(short if joint is first else joint for joint in package.joints)
    task = make_plan(folder, replace(package, joints=joints, requires_open=())).joints[0]
    assert task.tolerance == pytest.approx(max(times, 1.0) * least)


def test_friction_is_tried_for_a_part_of_the_range_or_for_a_second(plan):
    for joint in plan.joints:
        if joint.trial is not None:
            far = joint.trial.expected >= 0.25 * (joint.upper - joint.lower)
            assert far or joint.trial.seconds == pytest.approx(1.0)
            assert joint.trial.seconds <= 1.0


@pytest.mark.parametrize(("quarter", "seconds"), [(0.5, 0.5), (0.99, 0.99), (2.0, 1.0)])
def test_a_friction_trial_ends_with_a_quarter_of_the_range_or_after_a_second(folder, quarter, seconds):
    """Without damping; so many seconds the tenth of the friction that is left takes for a quarter."""
    package = read_package(folder, appearance=False)
    first = next(joint for joint in package.joints if joint.type != "fixed")
    needed = 2.0 * 0.25 * (first.upper - first.lower) / quarter**2 * moved_load(package, first)
    tried = replace(first, friction=needed / 0.1, damping=0.0)
    joints = tuple(tried if joint is first else joint for joint in package.joints)
    trial = make_plan(folder, replace(package, joints=joints)).joints[0].trial
    assert trial is not None
    assert trial.seconds == pytest.approx(seconds, abs=1.5 / 240.0)


def test_a_short_joint_may_move_by_what_one_step_of_gravity_does(plan, answer):
    """1 % of 5 mm is less than 0.2 mm, 1 % of 50 mm is more."""
    first = next(joint for joint in plan.joints if joint.type == "prismatic")
    assert 9.81 * plan.timestep**2 < 2e-4
    for upper, allowed in ((0.005, 2e-4), (0.05, 0.01 * 0.05)):
        short = replace(first, lower=0.0, upper=upper, tolerance=max(0.01 * upper, 1e-4))
        changed = replace(plan, joints=tuple(short if joint is first else joint for joint in plan.joints))
        for share, caught in ((0.99, "pass"), (1.01, "fail")):
            moved = json.loads(json.dumps(answer))
            moved["rest"]["drift"][first.name] = share * allowed
            assert verdicts(changed, moved)["V504"] == caught


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_an_endless_joint_may_end_where_its_follower_does(plan, answer, way):
    """A thread may be right-handed or left-handed."""
    turn = replace(plan.joints[0], type="continuous", lower=0.0, upper=2 * np.pi)
    travel = replace(
        turn, name="travel", type="prismatic", upper=0.08, mimic=turn.name, multiplier=way * 0.004
    )
    screw = replace(plan, joints=(turn, travel, *plan.joints[1:]))
    told = json.loads(json.dumps(answer))
    told["joints"]["travel"] = {"lower": 0.0, "upper": 0.08, "friction": None, "damping": None}
    for ends, verdict in (((None, None), "pass"), ((0.0, 20.0), "pass"), ((0.0, 19.0), "fail")):
        lower, upper = ends if way > 0.0 or ends[1] is None else (-ends[1], 0.0)
        told["joints"][turn.name] |= {"lower": lower, "upper": upper}
        assert verdicts(screw, told)["V501"] == verdict


class OneJoint:
    """A mass of 1 kg on a runner of 1 m with friction, exactly; or one that is moved at a given speed."""

    def __init__(self, friction: float = 1.0, speed: float | None = None) -> None:
        self.friction, self.speed = friction, speed
        self.x = self.v = 0.0
        self.steps = 0

    def reset(self, qpos: dict[str, float], gravity: float) -> None:
        self.x, self.v = qpos["joint"], 0.0

    def step(self, efforts: dict[str, float]) -> None:
        self.steps += 1
        pushed = efforts.get("joint", 0.0)
        if self.speed is not None:
            self.v = self.speed * np.sign(pushed)
        elif self.v == 0.0 and abs(pushed) <= self.friction:
            return
        else:
            self.v += DT * (pushed - self.friction * (np.sign(self.v) or np.sign(pushed)))
        self.x = min(max(self.x + DT * self.v, 0.0), 1.0)

    def positions(self) -> dict[str, float]:
        return {"joint": self.x}


DT = 1.0 / 240.0
TRIED = {
    "name": "joint", "type": "prismatic", "lower": 0.0, "upper": 1.0, "friction": 1.0, "mimic": None,
    "open": {}, "effort": 5.0, "speed": 1.0, "tolerance": 0.01,
    "trial": {"start": 0.5, "seconds": 1.0, "expected": 0.05},
}  # fmt: skip
TRIALS = {"timestep": DT, "drive_seconds": 4.0, "joints": [TRIED]}


def test_the_effort_at_which_a_joint_gives_way_is_bisected():
    found = bisect(OneJoint(), TRIALS, TRIED)
    moves = 0.1 * TRIED["trial"]["expected"]  # by which it counts as giving way: 0.5 (f - 1) t^2
    assert found == pytest.approx(1.0 + 2.0 * moves, abs=2.0**-9)


def test_a_joint_at_its_end_is_pressed_a_while():
    engine = OneJoint()
    engine.x = 1.0
    assert push(engine, TRIALS, TRIED, 1.0) == 0.0
    assert engine.steps == pytest.approx(0.25 / DT, abs=1)


@pytest.mark.parametrize(("share", "seconds"), [(0.99e-3, 0.5), (1.01e-3, 4.0)])
def test_a_joint_that_hardly_moves_is_pushed_no_longer(share, seconds):
    engine = OneJoint(speed=share * TRIED["speed"])
    left = push(engine, TRIALS, TRIED, 1.0)
    assert engine.steps * DT == pytest.approx(seconds, abs=2 * DT)
    assert left == pytest.approx(1.0 - engine.x)


@pytest.mark.parametrize(("seconds", "arrives"), [(3.9, True), (4.1, False)])
def test_a_joint_has_four_seconds_for_its_range(plan, seconds, arrives):
    """At the speed at which it would take so long."""
    engine = OneJoint(speed=1.0 / seconds)
    left = push(engine, asdict(plan) | {"joints": [TRIED]}, TRIED, 1.0)
    assert (left <= 1e-9) == arrives


def test_a_missing_engine_is_skipped_with_a_sentence(folder, tmp_path):
    """An interpreter without any packages stands for an environment without the engine."""
    bare = tmp_path / "python"
    bare.write_text(f'#!/bin/sh\nexec "{sys.executable}" -c \'print("{{\\"missing\\": \\"newton\\"}}")\'\n')
    bare.chmod(0o755)
    (check,) = ask_engines(folder, (EngineChoice(name="newton", python=str(bare)),), 60.0)
    assert check.verdict == "not_applicable"
    assert "pip install newton" in check.message
    report = Report(package="x", checks=(check,))
    assert report.passed
    assert "skipped: no module newton" in describe_report(report)
    twice = replace(report, checks=(check, replace(check, id="V999")))
    assert f"  {check.id}, V999: {check.message}" in describe_report(twice).splitlines()


def test_a_package_without_mjcf_is_nothing_to_an_engine_that_reads_it(folder, tmp_path):
    shutil.copytree(folder, tmp_path / "urdf_only")
    (tmp_path / "urdf_only" / "mobility.mjcf.xml").unlink()
    (check,) = ask_engines(tmp_path / "urdf_only", (EngineChoice(name="mujoco"),), 60.0)
    assert (check.verdict, "no mobility.mjcf.xml" in check.message) == ("not_applicable", True)


def test_an_engine_that_dies_or_hangs_is_a_failure(folder, tmp_path):
    for script, timeout, said in (("kill -SEGV $$", 60.0, "SIGSEGV"), ("exec sleep 60", 0.5, "0.5 s")):
        python = tmp_path / "python"
        python.write_text(f"#!/bin/sh\n{script}\n")
        python.chmod(0o755)
        checks: tuple[CheckResult, ...] = ask_engines(
            folder, (EngineChoice(name="pybullet", python=str(python)),), timeout
        )
        assert {check.verdict for check in checks} == {"fail"}
        assert said in checks[0].message


def test_engines_are_chosen_by_name():
    assert choose_engines("mujoco, sapien", ()) == (EngineChoice(name="mujoco"), EngineChoice(name="sapien"))
    chosen = choose_engines("pybullet", (f"pybullet={sys.executable}",))
    assert chosen == (EngineChoice(name="pybullet", python=sys.executable),)
    for names, pythons, said in (
        ("bullet", (), "unknown engine bullet"),
        ("mujoco", ("newton=/usr/bin/python3",), "NAME in --engines"),
        ("mujoco", ("mujoco=/no/such/python",), "no such file"),
    ):
        with pytest.raises(ArtigenError, match=said):
            choose_engines(names, pythons)
