"""`artigen preview`: pictures of packages."""

from pathlib import Path

from artigen.cli.arguments import Out, Packages


def preview(packages: Packages, out: Out = Path("preview.png")) -> int:
    """Draws packages: one in detail (closed, half open, open, exploded, collision), several as a sheet.

    Args:
        packages: Package folders.
        out: The PNG to write.
    """
    from sim_export.picture.preview import write_preview

    write_preview(packages, out)
    return 0
