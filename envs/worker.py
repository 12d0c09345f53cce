"""The checks that `envs.validate` runs in a supervised child process.

The child imports SAPIEN and MuJoCo once and processes one package after the other.
"""

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sim_export.report import CheckResult


def run_static(folder: Path) -> tuple[CheckResult, ...]:
    """Checks L0 to L2, in this process.

    What was kept of other packages is dropped first: memory does not grow with their number.
    """
    from artigen.files.wavefront import forget_files
    from sim_export.checks.suite import run_checks
    from sim_export.geometry.primitives import forget_hulls

    forget_files()
    forget_hulls()
    with quiet_libraries():
        return run_checks(folder)


def run_dynamics(folder: Path) -> tuple[CheckResult, ...]:
    """Checks L3, in this process."""
    with quiet_libraries():
        from sim_export.files.read import read_package

        from .dynamics import check_dynamics

        return check_dynamics(folder, read_package(folder))


def run_tasks(folder: Path) -> tuple[CheckResult, ...]:
    """Checks L4, in this process."""
    with quiet_libraries():
        from .maniskill.checks import check_tasks

        return check_tasks(folder)


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
