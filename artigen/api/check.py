"""Checks of many packages."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from artigen.api.batch import Part, take_part
from artigen.runtime.runner import Runner, run_jobs
from artigen.runtime.workers import Worker

if TYPE_CHECKING:
    from envs.config import ValidateConfig
    from sim_export.report import Report


def list_folders(folders: Sequence[Path], part: Part | None = None) -> tuple[Path, ...]:
    """The packages in folders, at any depth, or a part of them; a folder without any stands for itself.

    Raises:
        PackageError: If a folder does not exist.
    """
    from sim_export.errors import PackageError
    from sim_export.files.folders import list_packages

    missing = [str(folder) for folder in folders if not folder.is_dir()]
    if missing:
        raise PackageError(f"no such folder: {', '.join(missing)}")
    return tuple(take_part([one for folder in folders for one in list_packages(folder) or [folder]], part))


def validate_packages(folders: Sequence[Path], cfg: "ValidateConfig", runner: Runner) -> "Iterator[Report]":
    """Yields the report of every package as it is done; see `envs.validate.validate`."""
    return run_jobs(partial(_validate, cfg=cfg), folders, runner)


def _validate(worker: Worker, folder: Path, *, cfg: "ValidateConfig") -> "Report":
    from envs.validate import validate

    return validate(folder, cfg, worker)
