"""`artigen export`: converts an asset folder to a simulation package."""

import sys
from pathlib import Path
from typing import Literal

import tyro

from artigen.cli.arguments import Out


def export(
    asset: tyro.conf.Positional[Path], out: Out, existing: Literal["refuse", "replace"] = "refuse"
) -> int:
    """Export an asset of your own (parts, joints and 64^3 voxels) as a package.

    Args:
        asset: Asset folder (asset.json and arrays) as written by `artigen.io.write_asset`.
        out: Package folder to write.
        existing: Refuse or replace a package that is already there.
    """
    from artigen import __version__
    from artigen.io import read_asset
    from sim_export.export import export_asset
    from sim_export.files.write import check_place, write_package

    check_place(out, existing)
    provenance = {"generator": f"artigen {__version__} export", "source": asset.resolve().name}
    exported = export_asset(read_asset(asset), provenance=provenance)
    folder = write_package(exported.package, out, existing)
    sys.stdout.write(f"{folder}\n")
    return 0
