"""Finds packages below folders."""

from collections.abc import Sequence
from pathlib import Path

from sim_export.errors import PackageError

URDF = "mobility.urdf"


def find_packages(folders: Sequence[Path]) -> tuple[Path, ...]:
    """The folders that are packages, and below those that are not all packages at any depth, sorted by path.

    Hidden folders, where packages are being written, are passed over.

    Raises:
        PackageError: If a folder is missing, or neither is a package nor holds one.
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
    """The folder itself if it is a package, else all below it; none where there is none."""
    if (folder / URDF).is_file():
        return [folder]
    places = (path.parent for path in folder.rglob(URDF))
    return sorted(p for p in places if not any(n.startswith(".") for n in p.relative_to(folder).parts))
