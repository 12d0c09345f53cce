"""Validation in a supervised child process, because a physics engine may abort the one it runs in.

The worker is spawned once, pays for importing SAPIEN and MuJoCo once, takes package after package,
and is replaced after a crash or a time-out. What happens in it becomes a failed check that names the
signal, the exit code or the limit.
"""

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from artigen.runtime.workers import Worker
from sim_export.checks import CheckConfig
from sim_export.report import CheckResult

from .config import DynamicsConfig


@dataclass(frozen=True, kw_only=True)
class CheckJob:
    """One half of the validation of one package, as it travels to the child."""

    folder: Path
    checks: CheckConfig
    dynamics: DynamicsConfig


def run_static(job: CheckJob) -> tuple[CheckResult, ...]:
    """Checks L0 to L2, in this process."""
    from sim_export.checks.suite import run_checks

    with quiet_libraries():
        return run_checks(job.folder, cfg=job.checks)


def run_dynamics(job: CheckJob) -> tuple[CheckResult, ...]:
    """Checks L3, in this process."""
    with quiet_libraries():
        from sim_export.files.read import read_package

        from .dynamics import check_dynamics

        return check_dynamics(job.folder, read_package(job.folder), job.dynamics)


def run_tasks(job: CheckJob) -> tuple[CheckResult, ...]:
    """Checks L4, in this process."""
    with quiet_libraries():
        import sapien.physx

        from .maniskill.checks import check_tasks

        sapien.physx.clear_cache()  # as in `envs.package.load_package`
        return check_tasks(job.folder)


def call_static(worker: Worker, job: CheckJob, timeout: float) -> tuple[CheckResult, ...]:
    """Checks L0 to L2 in the child; its death is a failed V001, the first check that was not made."""
    outcome = worker.call(run_static, job, timeout)
    if outcome.value is not None:
        return outcome.value
    return (
        CheckResult(
            id="V001", level="L0", title="well-formed", verdict="fail",
            message=f"the static checks did not finish: {outcome.error}",
        ),
    )  # fmt: skip


def call_dynamics(worker: Worker, job: CheckJob, timeout: float) -> tuple[CheckResult, ...]:
    """Checks L3 in the child; its death is a failed V301, and the others count as not run."""
    outcome = worker.call(run_dynamics, job, timeout)
    if outcome.value is not None:
        return outcome.value
    return failed_dynamics(f"{outcome.error}", first="V301")


def call_tasks(worker: Worker, job: CheckJob, timeout: float) -> tuple[CheckResult, ...]:
    """Checks L4 in the child; its death is a failed V401, and the others count as not run."""
    outcome = worker.call(run_tasks, job, timeout)
    return failed_tasks(f"{outcome.error}") if outcome.value is None else outcome.value


def failed_tasks(reason: str) -> tuple[CheckResult, ...]:
    """All L4 checks as failures for one reason."""
    from .titles import TASK_TITLES, not_run

    return tuple(not_run(check, reason) for check in TASK_TITLES)


def failed_dynamics(reason: str, *, first: str | None = None) -> tuple[CheckResult, ...]:
    """All L3 checks as failures: ``first`` for the ``reason`` itself, the others because of it."""
    from .titles import TITLES, not_run

    return tuple(
        not_run(check, reason) if check == first or first is None else not_run(check, f"{first} failed")
        for check in TITLES
    )


@contextmanager
def quiet_libraries() -> Iterator[None]:
    """Keeps what C++ libraries write straight to the standard error out of the user's terminal.

    Everything worth knowing comes back as a value; qhull alone prints fifty lines for a flat mesh.
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
