"""`artigen render`: pictures of packages with exact labels."""

import sys

import tyro

from artigen.api.render import RenderSettings, render_labelled
from artigen.cli.arguments import Out, Packages

SETTINGS = RenderSettings()


def render(packages: Packages, out: Out, cfg: tyro.conf.OmitArgPrefixes[RenderSettings] = SETTINGS) -> int:
    """Render packages in random states and views, with depth, masks, boxes, joints and cameras as COCO.

    Args:
        packages: Package folders, or folders that contain packages at any depth.
        out: Output folder for images, depth, parts and coco.json.
        cfg: Number, size and seed of the pictures.
    """
    from sim_export.files.folders import find_packages

    count = sum(1 for _ in render_labelled(find_packages(packages), out, cfg))
    sys.stdout.write(f"{count} labelled pictures in {out / 'coco.json'}\n")
    return 0
