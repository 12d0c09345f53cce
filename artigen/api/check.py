"""Checks of many packages."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from artigen.runtime.runner import Runner, run_jobs
from artigen.runtime.workers import Worker

if TYPE_CHECKING:
    from envs.config import ValidateConfig
    from sim_export.report import Report


def validate_packages(folders: Sequence[Path], cfg: "ValidateConfig", runner: Runner) -> "Iterator[Report]":
    """Yields the report of every package as it is done; see `envs.validate.validate`."""
    return run_jobs(partial(_validate, cfg=cfg), folders, runner)


def _validate(worker: Worker, folder: Path, *, cfg: "ValidateConfig") -> "Report":
    from envs.validate import validate

    return validate(folder, cfg, worker)
