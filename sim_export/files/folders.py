"""Finds packages below folders."""

from collections.abc import Sequence
from pathlib import Path

from sim_export.errors import PackageError

URDF = "mobility.urdf"


def find_packages(folders: Sequence[Path]) -> tuple[Path, ...]:
    """Package folders among ``folders``, and packages at any depth below the others, sorted by path.

    Hidden folders, in which packages are being written, are skipped.

    Raises:
        PackageError: If a folder is missing, or neither is a package nor contains one.
    """
    found: list[Path] = []
    for folder in folders:
        if not folder.is_dir():
            raise PackageError(f"{folder}: no such folder")
        inside = list_packages(folder)
        if not inside:
            raise PackageError(
                f"{folder}: no {URDF} in it or below; expected a package, or a folder of packages"
            )
        found += inside
    return tuple(dict.fromkeys(found))


def list_packages(folder: Path) -> list[Path]:
    """The folder itself if it is a package, else all packages below it."""
    if (folder / URDF).is_file():
        return [folder]
    places = (path.parent for path in folder.rglob(URDF))
    return sorted(p for p in places if not any(n.startswith(".") for n in p.relative_to(folder).parts))
