"""Finds packages below folders."""

from collections.abc import Sequence
from pathlib import Path

from sim_export.errors import PackageError

URDF = "mobility.urdf"


def find_packages(folders: str | Path | Sequence[str | Path]) -> tuple[Path, ...]:
    """Package folders among ``folders`` (one, or several), and packages at any depth below the others, sorted
    by path.

    Hidden folders, in which packages are being written, are skipped; so are files beside folders, such as the
    journal in ``out/*``.

    Raises:
        PackageError: If there is no folder, one is missing, or neither is a package nor contains one.
    """
    found: list[Path] = []
    given = [Path(folder) for folder in ([folders] if isinstance(folders, str | Path) else folders)]
    if all(path.is_file() for path in given):
        named = ", ".join(map(str, given[:3])) or "nothing"
        raise PackageError(f"{named}: expected the folder of a package, or a folder of packages")
    for folder in given:
        if folder.is_file():
            continue
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


def name_folders(folders: Sequence[Path]) -> tuple[str, ...]:
    """The shortest name of each folder that no other one has: its own, with as many above it as needed."""
    names = []
    for folder in folders:
        parts = folder.absolute().parts
        depth = 1
        while (
            depth < len(parts)
            and sum(other.absolute().parts[-depth:] == parts[-depth:] for other in folders) > 1
        ):
            depth += 1
        names.append("/".join(parts[-depth:]))
    return tuple(names)


def pick_folder(folders: Sequence[Path], name: str) -> Path:
    """The folder whose path ends with ``name``, such as ``Oven_3`` or ``train/Oven_3``.

    Raises:
        PackageError: If there is none, or there are several.
    """
    wanted = Path(name).parts
    found = [folder for folder in folders if wanted and folder.absolute().parts[-len(wanted) :] == wanted]
    if len(found) != 1:
        listed = ", ".join(str(folder) for folder in (found or folders)[:5])
        raise PackageError(
            f"object {name!r}: {len(found)} of {len(folders)} have that name, expected one; there are "
            f"{listed}" + (" and others" if len(found or folders) > 5 else "")
        )
    return found[0]
