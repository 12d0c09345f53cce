"""Finds and reads source objects of any layout: PartNet-Mobility folders, URDFs, MJCFs, USD, object.json."""

from collections.abc import Callable
from pathlib import Path
from typing import Literal

from artigen.datasets.acd import read_acd
from artigen.datasets.mechanism_object import read_mechanism
from artigen.datasets.mjcf import is_mjcf, list_mjcf_objects, read_mjcf
from artigen.datasets.partnet_annotation import read_json
from artigen.datasets.partnet_mobility import read_object
from artigen.datasets.source_object import ReaderConfig, SourceObject
from artigen.datasets.urdf_file import read_urdf
from artigen.datasets.usd import SUFFIXES, list_usd_objects, read_usd
from artigen.errors import SourceError

Layout = Literal["PartNet-Mobility", "URDF", "MJCF", "USD", "object.json"]
ANNOTATION = "mobility_v2.json"
TREE = "object.json"
MAIN = "mobility.urdf"
OTHERS = {
    ".xacro": "xacro is read after it is expanded: `xacro FILE > out.urdf`",
    ".sdf": "SDF is not read, expected URDF, MJCF or USD",
    ".world": "SDF is not read, expected URDF, MJCF or USD",
    ".glb": "a GLB has no joints, expected a URDF, MJCF or USD that names it",
    ".obj": "an OBJ has no joints, expected a URDF, MJCF or USD that names it",
}
"""What to do with files that hold no object."""
COMMON_NAMES = (
    "mobility", "model", "robot", "object", "main", "urdf", "mjcf", "xml", "mobility_annotation_gapartnet",
)  # fmt: skip
"""Generic names of files and folders; such an object takes the name of the next folder above."""


def find_layout(source: Path) -> Layout | None:
    """The layout of an object; None if the path is no object.

    A package written by artigen has PartNet's annotation without its meshes, so its URDF counts.
    """
    if source.is_file():
        if source.suffix.lower() in (".urdf", *SUFFIXES):
            return "URDF" if source.suffix.lower() == ".urdf" else "USD"
        return "object.json" if source.name == TREE else "MJCF" if is_mjcf(source) else None
    if (source / ANNOTATION).is_file() and not _is_package(source):
        return "PartNet-Mobility"
    if (source / TREE).is_file():
        return "object.json"
    if _find_urdf(source):
        return "URDF"
    return "MJCF" if _find_mjcf(source) else "USD" if _find_usd(source) else None


def _is_package(folder: Path) -> bool:
    meta = folder / "meta.json"
    value = read_json(meta) if meta.is_file() else None
    return isinstance(value, dict) and "format" in value


def _find_urdf(folder: Path) -> Path | None:
    """The URDF of a folder with one object: the main one, or the only one."""
    files = sorted((*folder.glob("*.urdf"), *folder.glob("urdf/*.urdf")))
    return folder / MAIN if (folder / MAIN).is_file() else files[0] if len(files) == 1 else None


def _find_mjcf(folder: Path) -> Path | None:
    """The MJCF of a folder that holds one."""
    files = [file for file in sorted(folder.glob("*.xml")) if is_mjcf(file)]
    return files[0] if len(files) == 1 else None


def _find_usd(folder: Path) -> Path | None:
    """The stage of a folder that holds one."""
    files = [file for file in sorted(folder.glob("*")) if file.suffix.lower() in SUFFIXES]
    return files[0] if len(files) == 1 else None


def find_sources(paths: tuple[Path, ...]) -> list[Path]:
    """The objects among ``paths``, and those directly inside any other folder."""
    found: list[Path] = []
    for path in paths:
        inside = (
            [] if find_layout(path) else [child for child in sorted(path.glob("*")) if find_layout(child)]
        )
        found += inside or [path]
    return found


def name_source(source: Path) -> str:
    """Name of an object's package: that of its file or folder, or of the first folder above with a name that
    is not generic."""
    path = source.parent.resolve() / source.name if source.is_symlink() else source.resolve()
    names = [path.stem if source.is_file() else path.name, *(folder.name for folder in path.parents)]
    told = (name for name in names if name and name.lower() not in COMMON_NAMES)
    return next(told, names[0])


def list_objects(source: Path) -> tuple[str, ...]:
    """Names of the objects in a file that holds several; none where it holds one.

    Raises:
        SourceError: If the file cannot be read.
    """
    match find_layout(source):
        case "MJCF":
            return list_mjcf_objects(_pick(source, _find_mjcf))
        case "USD":
            return list_usd_objects(_pick(source, _find_usd))
        case _:
            return ()


def _pick(source: Path, find: Callable[[Path], Path | None]) -> Path:
    """A source that is a file, or the file in it."""
    file = source if source.is_file() else find(source)
    assert file is not None
    return file


def read_source(source: Path, scratch: Path, cfg: ReaderConfig | None = None) -> SourceObject:
    """Reads one object, whatever its layout.

    Args:
        scratch: Folder for converted meshes, needed until the package is written.

    Raises:
        SourceError: If the object cannot be read; the message names file, element and value.
    """
    cfg, name = cfg or ReaderConfig(), name_source(source)
    match find_layout(source):
        case "URDF":
            found = read_urdf(_pick(source, _find_urdf))
        case "MJCF":
            found = read_mjcf(_pick(source, _find_mjcf), cfg.body)
        case "USD":
            found = read_usd(_pick(source, _find_usd), cfg.body)
        case "object.json":
            return read_acd(source if source.is_file() else source / TREE, scratch, cfg, name=name)
        case "PartNet-Mobility":
            return read_object(source, cfg)
        case _:
            if source.suffix.lower() in OTHERS:
                raise SourceError(f"{source}: {OTHERS[source.suffix.lower()]}")
            raise SourceError(
                f"{source}: is no object: expected a URDF, MJCF or USD, or a folder with {MAIN} or one "
                f"other of these, with {ANNOTATION} and its meshes (PartNet-Mobility), or with {TREE} (ACD)"
            )
    return read_mechanism(found, scratch, cfg, name=name)
