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
    from artigen.api.object import open_asset

    exported = open_asset(asset).export(out, existing=existing)
    sys.stdout.write(f"{exported.folder}\n")
    return 0
