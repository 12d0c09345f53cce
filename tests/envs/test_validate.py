"""Validation: one report, the same bytes every time, and engines that die cost their own checks only."""

import gc
import os
import shutil
import signal
from pathlib import Path

import pytest

from artigen.files.wavefront import ObjText
from artigen.runtime.workers import Outcome, Worker
from envs.config import ValidateConfig
from envs.titles import TITLES
from envs.validate import REPORT_FILE, list_titles, validate, without_seconds
from envs.worker import run_dynamics, run_static
from sim_export.errors import PackageError
from sim_export.files.write import manifest_problems
from sim_export.package import Hull
from sim_export.report import report_from_json, report_to_json

pytest.importorskip("sapien")
pytestmark = pytest.mark.sim
SILENT = ValidateConfig(output="none")


class DoomedWorker(Worker):
    """A worker in whose child something happens instead of the checks."""

    def __init__(self, doomed, action, argument, timeout):
        super().__init__()
        self.doomed, self.action, self.argument, self.timeout = doomed, action, argument, timeout

    def call(self, function, item, timeout):
        if function is not self.doomed:
            return super().call(function, item, timeout)
        return super().call(self.action, self.argument, self.timeout)


@pytest.mark.slow
def test_the_report_is_written_and_the_same_every_time(folder):
    worker = Worker()
    try:
        report = validate(folder, worker=worker)
        first = (folder / REPORT_FILE).read_bytes()
        validate(folder, worker=worker)
    finally:
        worker.close()
    assert (folder / REPORT_FILE).read_bytes() == first
    assert report_from_json(first.decode()) == without_seconds(report)
    assert manifest_problems(folder) == ()
    assert {check.level for check in report.checks} == {"L0", "L1", "L2", "L3"}
    ids = [check.id for check in report.checks]
    assert ids == sorted(set(ids))
    assert set(TITLES) < set(ids)
    assert sum(check.seconds for check in report.checks) > 0.0
    assert {"sapien", "mujoco", "numpy", "artigen"} <= dict(report.versions).keys()
    assert "not installed" not in dict(report.versions).values()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("action", "argument", "timeout", "reason", "stopped"),
    [
        (signal.raise_signal, int(signal.SIGABRT), 60.0, "the worker process died: signal SIGABRT", False),
        (os._exit, 7, 60.0, "the worker process died: exit code 7", False),
        (signal.sigwait, [signal.SIGUSR1], 0.2, "took longer than 0.2 s and was stopped", True),
    ],
)
@pytest.mark.parametrize("doomed", [run_static, run_dynamics])
def test_checks_that_were_not_done_say_why(folder, doomed, action, argument, timeout, reason, *, stopped):
    """After a death or a time limit no check is said to have failed because of another one."""
    worker = DoomedWorker(doomed, action, argument, timeout)
    try:
        report = validate(folder, SILENT, worker)
    finally:
        worker.close()
    levels = ("L3",) if doomed is run_dynamics else ("L0", "L1", "L2")
    own = [check for check in report.checks if check.level in levels]
    assert {check.message for check in own} == {f"not run: {reason}"}
    assert set(TITLES if doomed is run_dynamics else list_titles()) == {check.id for check in own}
    assert (report.passed, report.stopped) == (False, stopped)
    if doomed is run_static:
        above = {check.message for check in report.checks if check.level == "L3"}
        assert above == {f"not run: checks L0 to L2 were not done ({reason})"}
    again = report_from_json(report_to_json(report))
    assert (again.stopped, again.checks) == (stopped, report.checks)


def test_memory_does_not_grow_with_the_number_of_packages(folder: Path, tmp_path: Path):
    def kept(number: int) -> int:
        run_static(shutil.copytree(folder, tmp_path / str(number)))
        gc.collect()
        return sum(type(one) in (ObjText, Hull) for one in gc.get_objects())

    assert kept(0) == kept(1) == kept(2) > 0


def test_by_default_no_process_is_started(folder, monkeypatch):
    """A script without a main guard would run again in it."""
    monkeypatch.setattr(Worker, "_start", lambda worker: pytest.fail("a process was started"))
    assert {check.level for check in validate(folder, SILENT).checks} == {"L0", "L1", "L2", "L3"}


def test_validation_waits_two_minutes_for_an_engine_and_ten_for_a_robot(folder, monkeypatch):
    waited = []

    def hang(_worker: Worker, function: object, _item: object, timeout: float) -> Outcome:
        waited.append(timeout)
        done = () if function is run_static else None
        return Outcome(value=done, error="took too long", stopped=True)

    monkeypatch.setattr(Worker, "call", hang)
    assert not validate(folder, ValidateConfig(output="none", tasks="run"), Worker()).passed
    assert waited == [120.0, 120.0, 600.0]


def test_what_cannot_be_parsed_is_not_simulated(tmp_path):
    (tmp_path / "mobility.urdf").write_text("<robot")
    report = validate(tmp_path, SILENT)
    assert not report.passed
    assert {check.message for check in report.checks if check.level == "L3"} == {"not run: V001 failed"}
    assert list(tmp_path.iterdir()) == [tmp_path / "mobility.urdf"]


def test_a_folder_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(PackageError, match="no such folder"):
        validate(tmp_path / "nothing", SILENT)
