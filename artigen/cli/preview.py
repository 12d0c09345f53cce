"""`artigen preview`: pictures of packages."""

from pathlib import Path
from typing import Literal

from artigen.api.splats import draw_splats
from artigen.cli.arguments import Out, Packages
from artigen.errors import ArtigenError


def preview(
    packages: Packages, out: Out = Path("preview.png"), light: Literal["quick", "catalogue"] = "quick"
) -> int:
    """Render one package in detail (closed, open, exploded, collision) or several as a contact sheet.

    Gaussians, where a package has them, are shown below the meshes from the same cameras.

    Args:
        packages: Package folders, or folders that contain packages at any depth.
        out: File to write: a .png; a .gif of opening and closing; or, for one package, a .glb with its
            textured meshes and one node per link.
        light: Light of a .png: quick, or that of a catalogue (needs Mitsuba 3, and seconds to minutes).
    """
    from sim_export.files.folders import find_packages

    if out.suffix not in (".png", ".gif", ".glb"):
        raise ArtigenError(f"{out}: expected a file that ends with .png, .gif or .glb")
    packages = find_packages(packages)
    if out.suffix == ".glb":
        from sim_export.files.glb import write_glb
        from sim_export.files.read import read_package

        if len(packages) != 1:
            raise ArtigenError(f"{out}: a GLB holds one package, got {len(packages)}")
        write_glb(read_package(packages[0]), out)
        return 0
    if out.suffix == ".gif":
        from sim_export.picture.animation import write_animation

        write_animation(packages, out, draw_splats=draw_splats)
        return 0
    from sim_export.picture.preview import PreviewConfig, write_preview

    write_preview(packages, out, PreviewConfig(light=light), draw_splats=draw_splats)
    return 0
