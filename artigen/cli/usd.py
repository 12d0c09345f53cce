"""`artigen usd`: packages to OpenUSD assets."""

import sys
from pathlib import Path
from typing import Literal

from artigen.cli.arguments import Out, Packages
from artigen.errors import ArtigenError

URDF = "mobility.urdf"


def usd(packages: Packages, out: Out, existing: Literal["refuse", "replace"] = "refuse") -> int:
    """Writes packages as USD for Isaac Sim, Isaac Lab and Newton, in the layout of SimReady assets.

    Needs usd-core: pip install "artigen[usd]".

    Args:
        packages: Package folders, or folders that hold some.
        out: Folder for the assets; each gets a folder of its own, named after its package in lower case.
        existing: What to do where an asset is there already.
    """
    from sim_export.files.read import read_package
    from sim_export.usd.write import require_usd, write_usd

    require_usd()
    for folder in find_packages(packages):
        sys.stdout.write(f"{write_usd(read_package(folder), out, existing)}\n")
    return 0


def find_packages(folders: Packages) -> tuple[Path, ...]:
    """The package folders among ``folders``, and in those that are none, in the order of their names.

    Raises:
        ArtigenError: If a folder neither is a package nor holds one.
    """
    if not folders:
        raise ArtigenError("no package is given; give package folders, or folders that hold some")
    found: list[Path] = []
    for folder in folders:
        inside = [folder]
        if not (folder / URDF).is_file():
            inside = [file.parent for file in folder.glob(f"[!.]*/{URDF}")]
        if not inside:
            raise ArtigenError(f"{folder}: is no package and holds none (there is no {URDF}, nor */{URDF})")
        found += sorted(inside)
    return tuple(found)
