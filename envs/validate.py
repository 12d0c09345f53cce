"""Validates a package folder: checks L0 to L3, and optionally L4 and L5, in one report."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from artigen.runtime.workers import Worker
from sim_export.errors import PackageError
from sim_export.report import CheckResult, Report, write_report

from .config import ValidateConfig
from .titles import TASK_TITLES, TITLES, not_run
from .worker import run_dynamics, run_static, run_tasks

REPORT_FILE = "validation.json"
ENGINES = ("artigen", "coal", "mujoco", "numpy", "sapien", "scipy", "trimesh", "yourdfpy")
READABLE = {"V001": "well-formed"}
"""The first check, which all levels above L2 require."""
TIMEOUT = 120.0
"""Time limit (seconds) for the static and for the dynamic checks."""
LONG_TIMEOUT = 600.0
"""Time limit (seconds) for the L4 checks, and for one engine of L5."""


def validate(folder: Path, cfg: ValidateConfig | None = None, worker: Worker | None = None) -> Report:
    """Runs every check on a package folder in a supervised child process.

    A crash of the child becomes a failed check. The report contains the time of each check; the file does
    not, so that repeated validation gives the same bytes.

    Args:
        folder: A package, or any folder in PartNet-Mobility's layout.
        cfg: What is run, and whether ``validation.json`` is written.
        worker: Process to reuse across packages; by default a new one is started and stopped.

    Raises:
        PackageError: If the folder does not exist; problems inside it are reported by the checks.
    """
    cfg, folder = cfg or ValidateConfig(), Path(folder)
    if not folder.is_dir():
        raise PackageError(f"{folder}: no such folder")
    own = Worker() if worker is None else worker
    try:
        checks = call_checks(own, run_static, folder, READABLE, TIMEOUT)
        unreadable = any(check.id in READABLE and check.verdict == "fail" for check in checks)
        upper = [(run_dynamics, TITLES, TIMEOUT)]
        upper += [(run_tasks, TASK_TITLES, LONG_TIMEOUT)] if cfg.tasks == "run" else []
        for run, titles, timeout in upper:
            checks += (
                not_run(titles, "V001 failed")
                if unreadable
                else call_checks(own, run, folder, titles, timeout)
            )
    finally:
        if worker is None:
            own.close()
    if cfg.engines:
        from .engines.witness import ask_engines, not_asked

        checks += (
            not_asked(cfg.engines, "V001 failed")
            if unreadable
            else ask_engines(folder, cfg.engines, LONG_TIMEOUT)
        )
    ordered = tuple(sorted(checks, key=lambda check: check.id))
    versions = tuple((name, _version(name)) for name in ENGINES)
    report = Report(package=folder.resolve().name, checks=ordered, versions=versions)
    if cfg.output == "package":
        write_report(without_seconds(report), folder / REPORT_FILE)
    return report


def call_checks(
    worker: Worker,
    run: Callable[[Path], tuple[CheckResult, ...]],
    folder: Path,
    titles: Mapping[str, str],
    timeout: float,
) -> tuple[CheckResult, ...]:
    """Checks in the child; a crash or timeout fails the first of ``titles``, and the others are not run."""
    outcome = worker.call(run, folder, timeout)
    if outcome.value is not None:
        return outcome.value
    return not_run(titles, str(outcome.error), first=next(iter(titles)))


def without_seconds(report: Report) -> Report:
    """The report without durations, as it is written: equal packages give equal reports."""
    return replace(report, checks=tuple(replace(check, seconds=0.0) for check in report.checks))


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
