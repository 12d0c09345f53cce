"""`artigen export`: an asset folder to a simulation package."""

import sys
from pathlib import Path

import tyro

from artigen.cli.arguments import Out


def export(asset: tyro.conf.Positional[Path], out: Out, overwrite: bool = False) -> int:  # noqa: FBT001, FBT002
    """Meshes, collision, mass and URDF for an asset that has voxels.

    Args:
        asset: Asset folder (asset.json and arrays), as `artigen.io.write_asset` leaves it.
        out: The package folder to make.
        overwrite: Replace the folder if it exists.
    """
    from artigen import __version__
    from artigen.io import read_asset
    from sim_export.export import export_asset
    from sim_export.write import write_package

    provenance = {"generator": f"artigen {__version__} export", "source": asset.resolve().name}
    exported = export_asset(read_asset(asset), provenance=provenance)
    folder = write_package(exported.package, out, "replace" if overwrite else "refuse")
    sys.stdout.write(f"{folder}\n")
    return 0
