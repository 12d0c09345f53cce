"""`artigen usd`: packages as SimReady folders."""

import sys
from datetime import date as calendar
from importlib.util import find_spec

from tqdm import tqdm

from artigen.cli.arguments import Out, Packages
from artigen.errors import ArtigenError


def usd(packages: Packages, out: Out, date: str | None = None, license: str = "Apache-2.0") -> int:
    """Writes packages as USD for Isaac Sim, Isaac Lab and Newton: one SimReady folder for each.

    Args:
        packages: Packages, or folders that hold some at any depth.
        out: Folder for the folders; those that are there already are replaced.
        date: When they were made, which SimReady asks for: YYYY-MM-DD; today if not said.
        license: Under which the objects may be used.
    """
    if find_spec("pxr") is None:
        raise ArtigenError('USD is written by usd-core, which is not installed: pip install "artigen[usd]"')
    from sim_export.files.folders import find_packages
    from sim_export.files.read import read_package
    from sim_export.usd.write import asset_name, write_usd

    made = date or calendar.today().isoformat()
    try:
        calendar.fromisoformat(made)
    except ValueError as error:
        raise ArtigenError(f"date {made!r}: expected YYYY-MM-DD") from error
    found = [(folder, read_package(folder, appearance=False)) for folder in find_packages(packages)]
    names = [asset_name(package) for _, package in found]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        same = ", ".join(str(folder) for (folder, _), name in zip(found, names, strict=True) if name == twice)
        raise ArtigenError(f"{same}: all would be written to {out / twice}; give them one at a time")
    for folder, _ in tqdm(found, unit="package", disable=len(found) == 1):
        write_usd(read_package(folder), out, date=made, license=license)
    sys.stdout.write(f"{len(found)} packages as USD in {out}\n")
    return 0
