"""`artigen restyle`: packages in other finishes."""

import sys
from dataclasses import replace
from typing import Literal

from artigen.cli.arguments import Count, Out, Packages
from artigen.errors import ArtigenError


def restyle(
    packages: Packages,
    out: Out,
    seed: int = 0,
    count: Count = 1,
    style: str | None = None,
    existing: Literal["refuse", "replace"] = "refuse",
) -> int:
    """Write packages in other finishes, as they are sold together; geometry, collision and masses stay.

    Args:
        packages: Package folders, or folders that contain packages at any depth.
        out: Output folder; looks get subfolders NAME-lSEED.
        seed: Seed of the first look.
        count: Number of looks of each package, of consecutive seeds.
        style: A style of the kind, such as navy or steel; sampled from the seed if unset.
        existing: Refuse or replace packages that are already there.
    """
    from artigen.api.object import load
    from artigen.api.restyle import restyle as restyle_object
    from sim_export.files.folders import find_packages
    from sim_export.files.write import write_package

    if seed < 0 or count < 1:
        raise ArtigenError(f"{count} looks from seed {seed}: expected at least one, and no seed below 0")
    for folder in find_packages(packages):
        obj = load(folder)
        for number in range(seed, seed + count):
            package = restyle_object(obj, number, style).package
            named = replace(package, name=f"{package.name}-l{number}")
            sys.stdout.write(f"{write_package(named, out / named.name, existing)}\n")
    return 0
