"""`artigen usd`: packages to OpenUSD assets."""

import sys
from typing import Literal

from artigen.cli.arguments import Out, Packages


def usd(packages: Packages, out: Out, existing: Literal["refuse", "replace"] = "refuse") -> int:
    """Writes packages as USD for Isaac Sim, Isaac Lab and Newton, in the layout of SimReady assets.

    Needs usd-core: pip install "artigen[usd]".

    Args:
        packages: Packages, or folders that hold some at any depth.
        out: Folder for the assets; each gets a folder of its own, named after its package in lower case.
        existing: What to do where an asset is there already.
    """
    from sim_export.files.folders import find_packages
    from sim_export.files.read import read_package
    from sim_export.usd.write import require_usd, write_usd

    require_usd()
    for folder in find_packages(packages):
        sys.stdout.write(f"{write_usd(read_package(folder), out, existing)}\n")
    return 0
