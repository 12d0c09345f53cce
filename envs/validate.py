"""Validates a package folder: checks L0 to L3, and optionally L4 and L5, in one report."""

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
)

REPORT_FILE = "validation.json"
ENGINES = ("artigen", "coal", "mujoco", "numpy", "sapien", "scipy", "trimesh", "yourdfpy")
SEED = 0
"""Recorded seed: checks draw no random numbers, and poses come from a fixed Sobol sequence."""


def validate(folder: Path, cfg: ValidateConfig | None = None, worker: Worker | None = None) -> Report:
    """Runs every check on a package folder in a supervised child process.

    A crash of the child becomes a failed check. The report contains the time of each check; the file does
    not, so that repeated validation gives the same bytes.

    Args:
        folder: A package, or any folder in PartNet-Mobility's layout.
        cfg: Thresholds, time limits, and whether ``validation.json`` is written.
        worker: Process to reuse across packages; by default a new one is started and stopped.

    Raises:
        PackageError: If the folder does not exist; problems inside it are reported by the checks.
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


def without_seconds(report: Report) -> Report:
    """The report without durations, as it is written: equal packages give equal reports."""
    return replace(report, checks=tuple(replace(check, seconds=0.0) for check in report.checks))


def engine_versions() -> tuple[tuple[str, str], ...]:
    """Versions of all libraries that affect the results, by name."""
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
    """L4 checks, if requested."""
    if cfg.tasks == "none":
        return ()
    return failed_tasks("V001 failed") if _unreadable(static) else run()


def _engines(job: CheckJob, static: tuple[CheckResult, ...], cfg: ValidateConfig) -> tuple[CheckResult, ...]:
    """L5 checks of the requested engines."""
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
