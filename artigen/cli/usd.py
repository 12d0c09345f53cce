"""`artigen usd`: converts packages to OpenUSD assets."""

import sys
from typing import Literal

from artigen.api.names import choose_name
from artigen.cli.arguments import Out, Packages
from artigen.errors import ArtigenError


def usd(
    packages: Packages, out: Out, existing: Literal["refuse", "replace"] = "refuse", name: str | None = None
) -> int:
    """Write packages as OpenUSD for Isaac Sim, Isaac Lab and Newton, in the SimReady layout.

    Requires usd-core: pip install "artigen[usd]".

    Args:
        packages: Package folders, or folders that contain packages at any depth.
        out: Output folder; each asset gets a subfolder named after its package, in lower case. Of packages
            with one name, the second gets the suffix _2, and so on.
        existing: Refuse or replace an asset that is already there.
        name: Name of the asset; only for one package.
    """
    from dataclasses import replace

    from sim_export.files.folders import find_packages
    from sim_export.files.read import read_package
    from sim_export.usd.names import asset_name, free_name
    from sim_export.usd.write import require_usd, write_usd

    require_usd()
    folders = find_packages(packages)
    given = choose_name(name, 0, 1)
    if given is not None and len(folders) != 1:
        raise ArtigenError(f"name {given}: expected one package, got {len(folders)}; omit --name")
    used: set[str] = set()
    for folder in folders:
        package = read_package(folder)
        package = replace(package, name=free_name(given or package.name, used))
        used.add(asset_name(package.name))
        sys.stdout.write(f"{write_usd(package, out, existing)}\n")
    return 0
