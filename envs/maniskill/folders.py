"""Finds packages in folders and decides whether tasks may use them."""

from collections.abc import Sequence
from pathlib import Path

from artigen.errors import ArtigenError
from sim_export.errors import PackageError
from sim_export.files.folders import find_packages as package_folders
from sim_export.report import report_from_json

REPORT_FILE = "validation.json"


class TaskError(ArtigenError):
    """A task cannot be built from these packages: names what was found and what was needed."""


def find_packages(packages: str | Path | Sequence[str | Path]) -> tuple[Path, ...]:
    """Package folders out of folders that are packages or hold some at any depth, or a list of these.

    Raises:
        TaskError: if one of them holds no package.
    """
    given = [packages] if isinstance(packages, str | Path) else list(packages)
    if not given:
        raise TaskError("packages is an empty list; give a folder of packages")
    try:
        return package_folders([Path(entry) for entry in given])
    except PackageError as error:
        raise TaskError(f"{error}; artigen convert, shape and export write packages") from error


def demand_validation(folders: Sequence[Path]) -> None:
    """Raises `TaskError` unless every package holds a ``validation.json`` that says it passed."""
    missing = [folder for folder in folders if not (folder / REPORT_FILE).is_file()]
    if missing:
        raise TaskError(
            f"{len(missing)} of {len(folders)} packages have no {REPORT_FILE}, {missing[0]} is the first; "
            "run artigen validate on them, or pass validation='any' to use them as they are"
        )
    for folder in folders:
        report = report_from_json((folder / REPORT_FILE).read_text())
        if not report.passed:
            failed = ", ".join(f"{check.id} ({check.title})" for check in report.failures)
            raise TaskError(
                f"{folder}: the package failed validation: {failed}; repair it or take it out of the folder, "
                "or pass validation='any' to use it as it is"
            )
