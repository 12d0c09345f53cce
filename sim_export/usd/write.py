"""Writes a package as a folder that SimReady's `Robotics-Prop` profile accepts.

``<name>/usd/<name>.usd`` contains everything but images. These are in ``textures`` beside it, named by
content; the thumbnail is in ``.thumbs``. The USD file is binary, a third of the size of the same layer as
text and several times faster to open. No file contains a time or an absolute path; equal packages give equal
bytes.
"""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

from pathlib import Path

from sim_export.errors import PackageError
from sim_export.files.obj import png_bytes
from sim_export.files.write import Overwrite, check_free, write_files
from sim_export.package import SimPackage
from sim_export.picture.image import render_package
from sim_export.picture.viewpoint import Viewpoint
from sim_export.usd.names import asset_name
from sim_export.usd.stage import stage_files

FOLDER = "usd"
THUMBNAIL = 256
"""Edge (pixels) of the thumbnail, prescribed by SimReady."""


def write_usd(package: SimPackage, out: Path, overwrite: Overwrite = "refuse") -> Path:
    """Writes a package as USD to its own folder in ``out`` and returns the path of the USD file.

    Args:
        package: The package.
        out: Folder for USD assets; the asset's folder has the package's name in lower case.
        overwrite: ``refuse`` raises if the asset's folder exists; ``replace`` replaces an existing USD asset,
            but never another kind of folder.

    Raises:
        PackageError: If usd-core is missing, the package has no visuals, the folder exists or cannot be
            written, or a source mesh or an image cannot be read.
        InvalidKinematics: If links and joints are not a tree.
    """
    name = asset_name(package.name)
    folder = Path(out) / name
    main = folder / FOLDER / f"{name}.usd"
    check_free(folder, overwrite)
    if folder.exists() and not main.is_file():
        raise PackageError(
            f"{folder}: is no USD asset (it has no {FOLDER}/{name}.usd), so it is not replaced"
        )
    write_files(usd_files(package), folder)
    return main


def usd_files(package: SimPackage) -> dict[str, bytes]:
    """All files of the USD asset by their path in its folder; raises as `write_usd`."""
    require_usd()
    if not any(link.visuals for link in package.links):
        raise PackageError(
            f"package {package.name!r} has no visuals, and an asset needs a picture of itself; "
            "read the package with its appearance"
        )
    name = asset_name(package.name)
    thumbnail = render_package(package, Viewpoint(width=THUMBNAIL, height=THUMBNAIL))
    files = {f"{FOLDER}/{path}": content for path, content in stage_files(package).items()}
    return files | {f"{FOLDER}/.thumbs/256x256/{name}.usd.png": png_bytes(thumbnail)}


def require_usd() -> None:
    """Raises `PackageError` if `usd-core` is not installed."""
    try:
        import pxr  # noqa: F401
    except ImportError as err:
        raise PackageError(
            'USD files need usd-core, which is not installed: pip install "artigen[usd]"'
        ) from err
