"""Where packages lie below folders."""

from collections.abc import Sequence
from pathlib import Path

from sim_export.errors import PackageError

URDF = "mobility.urdf"


def find_packages(folders: Sequence[Path]) -> tuple[Path, ...]:
    """The folders that are packages, and all packages below those that are not, sorted by path.

    Raises:
        PackageError: If a folder is missing, or neither is a package nor holds one.
    """
    found: list[Path] = []
    for folder in folders:
        if not folder.is_dir():
            raise PackageError(f"{folder}: no such folder")
        inside = [folder] if (folder / URDF).is_file() else sorted(p.parent for p in folder.rglob(URDF))
        if not inside:
            raise PackageError(
                f"{folder}: no {URDF} in it or below; expected a package, or a folder of packages"
            )
        found += inside
    return tuple(dict.fromkeys(found))
