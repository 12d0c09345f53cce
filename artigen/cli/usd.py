"""`artigen usd`: packages to OpenUSD assets."""

import sys
from typing import Literal

from artigen.cli.arguments import Out, Packages


def usd(packages: Packages, out: Out, existing: Literal["refuse", "replace"] = "refuse") -> int:
    """Write packages as OpenUSD for Isaac Sim, Isaac Lab and Newton, in the SimReady layout.

    Requires usd-core: pip install "artigen[usd]".

    Args:
        packages: Package folders, or folders that contain packages at any depth.
        out: Output folder; each asset gets a subfolder named after its package, in lower case.
        existing: Refuse or replace an asset that is already there.
    """
    from sim_export.files.folders import find_packages
    from sim_export.files.read import read_package
    from sim_export.usd.write import require_usd, write_usd

    require_usd()
    for folder in find_packages(packages):
        sys.stdout.write(f"{write_usd(read_package(folder), out, existing)}\n")
    return 0
