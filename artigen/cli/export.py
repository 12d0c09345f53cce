"""`artigen export`: writes an asset or a package as a package, or in formats of other simulators."""

import sys
from pathlib import Path
from typing import Annotated, Literal

import tyro

from artigen.cli.arguments import Out


def export(
    asset: tyro.conf.Positional[Path],
    out: Out,
    existing: Literal["refuse", "replace"] = "refuse",
    formats: Annotated[tuple[str, ...], tyro.conf.arg(name="for")] = ("package",),
    visual_format: Literal["obj", "glb"] | None = None,
) -> int:
    """Export an asset of your own (parts, joints and 64^3 voxels), or a package, for simulators.

    Args:
        asset: Asset folder (asset.json and arrays) as written by `artigen.io.write_asset`, or a package.
        out: Package folder to write; other formats lie beside it, such as OUT_usd.
        existing: Refuse or replace what is already there.
        formats: package, usd, glb, mjcf_actuators (a package with a servo on every joint of its MJCF),
            robosuite (a fixture for robosuite, RoboCasa and LIBERO), or one of an extension.
        visual_format: ``glb`` adds one GLB per link and mobility_glb.urdf, which shows them; by default as a
            package has it already.
    """
    from artigen.api.object import load, open_asset, write_formats
    from artigen.io import JSON_NAME

    found = open_asset(asset) if (asset / JSON_NAME).is_file() else load(asset)
    _, files = write_formats(found, out, formats, existing, visual_format)
    sys.stdout.write("".join(f"{path}\n" for path in files))
    return 0
