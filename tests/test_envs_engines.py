"""Other engines as witnesses: the plan's laws, seeded defects, boundaries of thresholds, missing engines."""

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_packages import SAMPLE_PARTS, build_package

from artigen.cli.validate import choose_engines, describe
from artigen.errors import ArtigenError
from envs.config import EngineChoice
from envs.engines.judge import HELD, REST_DRIFT, SLIPPED, judge
from envs.engines.plan import HOLD, SLIP, EnginePlan, make_plan, travelled
from envs.engines.witness import ask_engines, run_engine
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.report import CheckResult, Report

STEPS = 200


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_package(build_package(SAMPLE_PARTS), tmp_path_factory.mktemp("engines") / "cabinet")


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
    again = json.loads(json.dumps(plan.as_json()))
    assert [joint["name"] for joint in again["joints"]] == [joint.name for joint in plan.joints]
    tried = [joint for joint in plan.joints if joint.trial is not None]
    assert tried
    for joint in tried:
        assert joint.trial is not None
        assert joint.trial.held == pytest.approx(HOLD * joint.friction)
        assert joint.trial.slipped == pytest.approx(SLIP * joint.friction)
        assert joint.lower < joint.trial.start < joint.upper
        assert joint.trial.start + joint.trial.expected < joint.upper


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
        ("rest", "drift", REST_DRIFT * span, 1.0, "V504"),
        ("range", "open_gap", joint.tolerance, 1.0, "V505"),
        ("range", "close_gap", joint.tolerance, 1.0, "V505"),
        ("friction", "held", HELD, 1.0, "V506"),
        ("friction", "slipped", SLIPPED, -1.0, "V506"),
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
    assert "skipped: no module newton" in describe(report)


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
        ("bullet", (), "no engine bullet"),
        ("mujoco", ("newton=/usr/bin/python3",), "NAME of --engines"),
        ("mujoco", ("mujoco=/no/such/python",), "no such file"),
    ):
        with pytest.raises(ArtigenError, match=said):
            choose_engines(names, pythons)
