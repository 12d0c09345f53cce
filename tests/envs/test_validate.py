"""Validation: one report, the same bytes every time, and engines that die cost their own checks only."""

import os
import signal
from pathlib import Path

import pytest
from sample_packages import SAMPLE_PARTS, build_package

from artigen.runtime.workers import Outcome, Worker
from envs.config import ValidateConfig
from envs.titles import TITLES
from envs.validate import REPORT_FILE, call_checks, validate, without_seconds
from envs.worker import run_dynamics, run_static
from sim_export.errors import PackageError
from sim_export.files.write import manifest_problems, write_package
from sim_export.report import report_from_json

pytest.importorskip("sapien")
pytestmark = pytest.mark.sim
SILENT = ValidateConfig(output="none")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    package = build_package(SAMPLE_PARTS)
    return write_package(package, tmp_path_factory.mktemp("validate") / "cabinet")


class DoomedWorker(Worker):
    """A worker in whose child something happens instead of the checks."""

    def __init__(self, action, argument, timeout):
        super().__init__()
        self.action, self.argument, self.timeout = action, argument, timeout

    def call(self, function, item, timeout):
        return super().call(self.action, self.argument, self.timeout)


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


@pytest.mark.parametrize(
    ("action", "argument", "timeout", "reason"),
    [
        (signal.raise_signal, int(signal.SIGABRT), 60.0, "signal SIGABRT"),
        (os._exit, 7, 60.0, "exit code 7"),
        (signal.sigwait, [signal.SIGUSR1], 0.2, "took longer than 0.2 s"),
    ],
)
def test_the_death_of_an_engine_is_a_failed_v301(folder, action, argument, timeout, reason):
    worker = DoomedWorker(action, argument, timeout)
    try:
        results = call_checks(worker, run_dynamics, folder, TITLES, timeout)
    finally:
        worker.close()
    assert [result.id for result in results] == list(TITLES)
    assert {result.verdict for result in results} == {"fail"}
    assert reason in results[0].message
    assert {result.message for result in results[1:]} == {"not run: V301 failed"}


def test_the_death_of_the_static_half_is_a_failed_v001(folder):
    worker = DoomedWorker(os._exit, 3, 60.0)
    try:
        report = validate(folder, SILENT, worker)
    finally:
        worker.close()
    assert [check.id for check in report.checks] == ["V001", *TITLES]
    assert "exit code 3" in report.checks[0].message
    assert report.checks[1].message == "not run: V001 failed"


def test_validation_waits_two_minutes_for_an_engine_and_ten_for_a_robot(folder, monkeypatch):
    waited = []

    def hang(_worker: Worker, function: object, _item: object, timeout: float) -> Outcome:
        waited.append(timeout)
        done = () if function is run_static else None
        return Outcome(value=done, error="took too long")

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
