"""Validation in a supervised child process, because a physics engine may abort its process.

The worker is spawned once, imports SAPIEN and MuJoCo once, processes one package after the other, and is
replaced after a crash or a timeout. Either becomes a failed check that names the signal, the exit code or the
limit.
"""

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from artigen.runtime.workers import Worker
from sim_export.report import CheckResult

from .config import DynamicsConfig


def run_static(folder: Path) -> tuple[CheckResult, ...]:
    """Checks L0 to L2, in this process."""
    from sim_export.checks.suite import run_checks

    with quiet_libraries():
        return run_checks(folder)


def run_dynamics(folder: Path) -> tuple[CheckResult, ...]:
    """Checks L3, in this process."""
    with quiet_libraries():
        from sim_export.files.read import read_package

        from .dynamics import check_dynamics

        return check_dynamics(folder, read_package(folder), DynamicsConfig())


def run_tasks(folder: Path) -> tuple[CheckResult, ...]:
    """Checks L4, in this process."""
    with quiet_libraries():
        import sapien.physx

        from .maniskill.checks import check_tasks

        sapien.physx.clear_cache()  # as in `envs.package.load_package`
        return check_tasks(folder)


def call_static(worker: Worker, folder: Path, timeout: float) -> tuple[CheckResult, ...]:
    """Checks L0 to L2 in the child; a crash fails V001, the first check."""
    outcome = worker.call(run_static, folder, timeout)
    if outcome.value is not None:
        return outcome.value
    return (
        CheckResult(
            id="V001", level="L0", title="well-formed", verdict="fail",
            message=f"the static checks did not finish: {outcome.error}",
        ),
    )  # fmt: skip


def call_dynamics(worker: Worker, folder: Path, timeout: float) -> tuple[CheckResult, ...]:
    """Checks L3 in the child; a crash fails V301, and the others count as not run."""
    outcome = worker.call(run_dynamics, folder, timeout)
    if outcome.value is not None:
        return outcome.value
    return failed_dynamics(f"{outcome.error}", first="V301")


def call_tasks(worker: Worker, folder: Path, timeout: float) -> tuple[CheckResult, ...]:
    """Checks L4 in the child; a crash fails V401, and the others count as not run."""
    outcome = worker.call(run_tasks, folder, timeout)
    return failed_tasks(f"{outcome.error}") if outcome.value is None else outcome.value


def failed_tasks(reason: str) -> tuple[CheckResult, ...]:
    """All L4 checks as failures with one reason."""
    from .titles import TASK_TITLES, not_run

    return tuple(not_run(check, reason) for check in TASK_TITLES)


def failed_dynamics(reason: str, *, first: str | None = None) -> tuple[CheckResult, ...]:
    """All L3 checks as failures: ``first`` with the ``reason``, the others as not run because of it."""
    from .titles import TITLES, not_run

    return tuple(
        not_run(check, reason) if check == first or first is None else not_run(check, f"{first} failed")
        for check in TITLES
    )


@contextmanager
def quiet_libraries() -> Iterator[None]:
    """Suppresses output that C++ libraries write directly to the standard error.

    All relevant information is returned as values; qhull alone prints fifty lines for a flat mesh.
    """
    kept, sink = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(sink, 2)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Failed to find system libvulkan")
            yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(sink)
