"""Validates a package folder: checks L0 to L3, and L4 and L5 on request, as one report."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from artigen.runtime.workers import Worker
from sim_export.errors import PackageError
from sim_export.report import CheckResult, Report, write_report

from .config import ValidateConfig
from .worker import (
    CheckJob,
    call_dynamics,
    call_static,
    call_tasks,
    failed_dynamics,
    failed_tasks,
    run_dynamics,
    run_static,
    run_tasks,
)

REPORT_FILE = "validation.json"
ENGINES = ("artigen", "coal", "mujoco", "numpy", "sapien", "scipy", "trimesh", "yourdfpy")
SEED = 0
"""No check draws random numbers of its own; poses come from a fixed Sobol sequence."""


def validate(folder: Path, cfg: ValidateConfig | None = None, worker: Worker | None = None) -> Report:
    """Runs every check on a package folder in a supervised child process.

    A crash of the child becomes a failed check. The report holds the time of each check; the file does
    not, so that validating twice gives the same bytes.

    Args:
        folder: a package, or any folder in PartNet-Mobility's layout.
        cfg: thresholds, time limit, and whether ``validation.json`` is written.
        worker: a process to reuse for package after package; without one a process is started and ended.

    Raises:
        PackageError: if there is no such folder; problems inside it are reported by the checks.
    """
    cfg = ValidateConfig() if cfg is None else cfg
    job = _job(folder, cfg)
    own = Worker() if worker is None else worker
    try:
        static = call_static(own, job, cfg.timeout)
        dynamic = (
            failed_dynamics("V001 failed") if _unreadable(static) else call_dynamics(own, job, cfg.timeout)
        )
        tasks = _tasks(partial(call_tasks, own, job, cfg.task_timeout), static, cfg)
    finally:
        if worker is None:
            own.close()
    return _finish(folder, static + dynamic + tasks + _engines(job, static, cfg), cfg)


def validate_here(folder: Path, cfg: ValidateConfig | None = None) -> Report:
    """`validate` in the present process, for callers that already run supervised: an engine may end it."""
    cfg = ValidateConfig() if cfg is None else cfg
    job = _job(folder, cfg)
    static = run_static(job)
    dynamic = failed_dynamics("V001 failed") if _unreadable(static) else run_dynamics(job)
    tasks = _tasks(partial(run_tasks, job), static, cfg)
    return _finish(folder, static + dynamic + tasks + _engines(job, static, cfg), cfg)


def without_seconds(report: Report) -> Report:
    """The report as it is written: equal packages give equal reports."""
    return replace(report, checks=tuple(replace(check, seconds=0.0) for check in report.checks))


def engine_versions() -> tuple[tuple[str, str], ...]:
    """Versions of everything whose behaviour the verdict rests on, by name."""
    return tuple((name, _version(name)) for name in ENGINES)


def _job(folder: Path, cfg: ValidateConfig) -> CheckJob:
    if not Path(folder).is_dir():
        raise PackageError(f"{folder}: no such folder")
    return CheckJob(folder=Path(folder), checks=cfg.checks, dynamics=cfg.dynamics)


def _unreadable(static: tuple[CheckResult, ...]) -> bool:
    return any(check.id == "V001" and check.verdict == "fail" for check in static)


def _tasks(
    run: Callable[[], tuple[CheckResult, ...]], static: tuple[CheckResult, ...], cfg: ValidateConfig
) -> tuple[CheckResult, ...]:
    """Checks L4 where they are asked for."""
    if cfg.tasks == "none":
        return ()
    return failed_tasks("V001 failed") if _unreadable(static) else run()


def _engines(job: CheckJob, static: tuple[CheckResult, ...], cfg: ValidateConfig) -> tuple[CheckResult, ...]:
    """Checks L5 of the engines that are asked."""
    if not cfg.engines:
        return ()
    from .engines.witness import ask_engines, not_asked

    if _unreadable(static):
        return not_asked(cfg.engines, "V001 failed")
    return ask_engines(job.folder, cfg.engines, cfg.engine_timeout)


def _finish(folder: Path, checks: tuple[CheckResult, ...], cfg: ValidateConfig) -> Report:
    ordered = tuple(sorted(checks, key=lambda check: check.id))
    report = Report(
        package=Path(folder).resolve().name, checks=ordered, versions=engine_versions(), seed=SEED
    )
    if cfg.output == "package":
        write_report(without_seconds(report), Path(folder) / REPORT_FILE)
    return report


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
