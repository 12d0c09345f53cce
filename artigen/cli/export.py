"""`artigen export`: an asset folder to a simulation package."""

import sys
from pathlib import Path
from typing import Literal

import tyro

from artigen.cli.arguments import Out


def export(
    asset: tyro.conf.Positional[Path], out: Out, existing: Literal["refuse", "replace"] = "refuse"
) -> int:
    """Meshes, collision, mass and URDF for an asset that has voxels.

    Args:
        asset: Asset folder (asset.json and arrays), as `artigen.io.write_asset` leaves it.
        out: The package folder to make.
        existing: What to do where the folder already holds a package.
    """
    from artigen import __version__
    from artigen.io import read_asset
    from sim_export.export import export_asset
    from sim_export.files.write import write_package

    provenance = {"generator": f"artigen {__version__} export", "source": asset.resolve().name}
    exported = export_asset(read_asset(asset), provenance=provenance)
    folder = write_package(exported.package, out, existing)
    sys.stdout.write(f"{folder}\n")
    return 0
