"""Validates a package folder: checks L0 to L3, and optionally L4 and L5, in one report."""

from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from artigen.runtime.workers import InProcess, Worker
from sim_export.errors import PackageError
from sim_export.report import Report, write_report

from .config import ValidateConfig
from .titles import TASK_TITLES, TITLES, not_run
from .worker import run_dynamics, run_static, run_tasks

REPORT_FILE = "validation.json"
ENGINES = ("artigen", "coal", "mujoco", "numpy", "sapien", "scipy", "trimesh", "yourdfpy")
READABLE = "V001"
"""The first check, which all levels above L2 require."""
TIMEOUT = 120.0
"""Time limit (seconds) for the static and for the dynamic checks."""
LONG_TIMEOUT = 600.0
"""Time limit (seconds) for the L4 checks, and for one engine of L5."""


def validate(folder: Path, cfg: ValidateConfig | None = None, worker: Worker | None = None) -> Report:
    """Runs every check on a package folder.

    The report contains the time of each check; the file does not, so that repeated validation gives the same
    bytes.

    Args:
        folder: A package, or any folder in PartNet-Mobility's layout.
        cfg: What is run, and whether ``validation.json`` is written.
        worker: Supervised process that runs the checks: crashes and time limits become failed checks that say
            so. By default, the checks run in this process, without either.

    Raises:
        PackageError: If the folder does not exist; problems inside it are reported by the checks.
    """
    cfg, folder = cfg or ValidateConfig(), Path(folder)
    if not folder.is_dir():
        raise PackageError(f"{folder}: no such folder")
    worker = worker or InProcess()
    static = worker.call(run_static, folder, TIMEOUT)
    stopped = static.stopped
    checks = not_run(list_titles(), str(static.error)) if static.value is None else static.value
    unreadable = any(check.id == READABLE and check.verdict == "fail" for check in checks)
    barred = f"{READABLE} failed" if unreadable else None
    if static.value is None:
        barred = f"checks L0 to L2 were not done ({static.error})"
    upper = [(run_dynamics, TITLES, TIMEOUT)]
    upper += [(run_tasks, TASK_TITLES, LONG_TIMEOUT)] if cfg.tasks == "run" else []
    for run, titles, timeout in upper:
        if barred is not None:
            checks += not_run(titles, barred)
            continue
        outcome = worker.call(run, folder, timeout)
        checks += not_run(titles, str(outcome.error)) if outcome.value is None else outcome.value
        stopped |= outcome.stopped
    if cfg.engines:
        from .engines.witness import ask_engines, not_asked

        checks += (
            ask_engines(folder, cfg.engines, LONG_TIMEOUT)
            if barred is None
            else not_asked(cfg.engines, barred)
        )
    ordered = tuple(sorted(checks, key=lambda check: check.id))
    versions = tuple((name, _version(name)) for name in ENGINES)
    report = Report(package=folder.resolve().name, checks=ordered, versions=versions, stopped=stopped)
    if cfg.output == "package":
        write_report(without_seconds(report), folder / REPORT_FILE)
    return report


def list_titles() -> dict[str, str]:
    """Ids and titles of the checks L0 to L2."""
    from sim_export.checks.suite import find_checks

    return {spec.id: spec.title for spec in find_checks()}


def without_seconds(report: Report) -> Report:
    """The report without durations, as it is written: equal packages give equal reports."""
    return replace(report, checks=tuple(replace(check, seconds=0.0) for check in report.checks))


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
