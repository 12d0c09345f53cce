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
    call_dynamics,
    call_static,
    call_tasks,
    failed_dynamics,
    failed_tasks,
)

REPORT_FILE = "validation.json"
ENGINES = ("artigen", "coal", "mujoco", "numpy", "sapien", "scipy", "trimesh", "yourdfpy")
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
    cfg = ValidateConfig() if cfg is None else cfg
    folder = _existing(folder)
    own = Worker() if worker is None else worker
    try:
        static = call_static(own, folder, TIMEOUT)
        dynamic = (
            failed_dynamics("V001 failed") if _unreadable(static) else call_dynamics(own, folder, TIMEOUT)
        )
        tasks = _tasks(partial(call_tasks, own, folder, LONG_TIMEOUT), static, cfg)
    finally:
        if worker is None:
            own.close()
    return _finish(folder, static + dynamic + tasks + _engines(folder, static, cfg), cfg)


def without_seconds(report: Report) -> Report:
    """The report without durations, as it is written: equal packages give equal reports."""
    return replace(report, checks=tuple(replace(check, seconds=0.0) for check in report.checks))


def engine_versions() -> tuple[tuple[str, str], ...]:
    """Versions of all libraries that affect the results, by name."""
    return tuple((name, _version(name)) for name in ENGINES)


def _existing(folder: Path) -> Path:
    if not Path(folder).is_dir():
        raise PackageError(f"{folder}: no such folder")
    return Path(folder)


def _unreadable(static: tuple[CheckResult, ...]) -> bool:
    return any(check.id == "V001" and check.verdict == "fail" for check in static)


def _tasks(
    run: Callable[[], tuple[CheckResult, ...]], static: tuple[CheckResult, ...], cfg: ValidateConfig
) -> tuple[CheckResult, ...]:
    """L4 checks, if requested."""
    if cfg.tasks == "none":
        return ()
    return failed_tasks("V001 failed") if _unreadable(static) else run()


def _engines(folder: Path, static: tuple[CheckResult, ...], cfg: ValidateConfig) -> tuple[CheckResult, ...]:
    """L5 checks of the requested engines."""
    if not cfg.engines:
        return ()
    from .engines.witness import ask_engines, not_asked

    if _unreadable(static):
        return not_asked(cfg.engines, "V001 failed")
    return ask_engines(folder, cfg.engines, LONG_TIMEOUT)


def _finish(folder: Path, checks: tuple[CheckResult, ...], cfg: ValidateConfig) -> Report:
    ordered = tuple(sorted(checks, key=lambda check: check.id))
    report = Report(package=Path(folder).resolve().name, checks=ordered, versions=engine_versions())
    if cfg.output == "package":
        write_report(without_seconds(report), Path(folder) / REPORT_FILE)
    return report


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
