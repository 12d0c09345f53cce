"""Formats of export beside the package, by name: those of this project and of extensions."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import FunctionType
from typing import TYPE_CHECKING, Literal

from artigen.errors import ArtigenError
from artigen.plugins import find_plugins

if TYPE_CHECKING:
    from sim_export.package import SimPackage

Existing = Literal["refuse", "replace"]
Exporter = Callable[["SimPackage", Path, Existing], Path]
"""Writes a package for ``out/fridge`` beside it, such as to ``out/fridge_usd``; returns the main file."""


def find_exporters() -> Mapping[str, Exporter]:
    """Every format by name, sorted."""
    found = {
        "glb": write_glb_file,
        "mjcf_actuators": write_actuated,
        "robosuite": write_fixture,
        "usd": write_usd_asset,
    }
    for plugin in find_plugins("artigen.exporters", FunctionType):
        if plugin.name in found:
            raise ArtigenError(
                f"{plugin.origin}: export format {plugin.name!r} exists already; name it otherwise"
            )
        found[plugin.name] = plugin.value
    return dict(sorted(found.items()))


def find_exporter(name: str) -> Exporter:
    """The format of a name.

    Raises:
        ArtigenError: If there is none.
    """
    known = find_exporters()
    if name not in known:
        raise ArtigenError(f"export format {name!r}: expected package, {', '.join(known)}")
    return known[name]


def write_usd_asset(package: "SimPackage", folder: Path, existing: Existing) -> Path:
    """An OpenUSD asset below ``FOLDER_usd``."""
    from sim_export.usd.write import write_usd

    return write_usd(package, folder.with_name(f"{folder.name}_usd"), existing)


def write_glb_file(package: "SimPackage", folder: Path, existing: Existing) -> Path:
    """A file ``FOLDER.glb``."""
    from sim_export.files.glb import write_glb
    from sim_export.files.write import check_free

    path = folder.with_name(f"{folder.name}.glb")
    check_free(path, existing)
    write_glb(package, path)
    return path


def write_actuated(package: "SimPackage", folder: Path, existing: Existing) -> Path:
    """A package ``FOLDER_actuators``, in whose MJCF every joint has a servo."""
    from sim_export.files.mjcf import mjcf_text
    from sim_export.files.write import MANIFEST, check_place, manifest_text, package_files, write_files
    from sim_export.motion.ignored_pairs import ignored_pairs

    beside, path = folder.with_name(f"{folder.name}_actuators"), "mobility.mjcf.xml"
    check_place(beside, existing)
    files = package_files(package)
    files[path] = mjcf_text(package, ignored_pairs(package), actuators=True).encode()
    write_files(files | {MANIFEST: manifest_text(files).encode()}, beside)
    return beside / path


def write_fixture(package: "SimPackage", folder: Path, existing: Existing) -> Path:
    """A folder ``FOLDER_robosuite`` with a package and ``model.xml``, a fixture of robosuite."""
    from sim_export.files.fixture import MODEL, fixture_files
    from sim_export.files.write import check_place, write_files

    beside = folder.with_name(f"{folder.name}_robosuite")
    check_place(beside, existing)
    write_files(fixture_files(package), beside)
    return beside / MODEL
