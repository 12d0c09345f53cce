"""Finds and reads source objects of any layout: PartNet-Mobility folders, URDFs, MJCFs, object.json."""

from pathlib import Path
from typing import Literal

from artigen.datasets.acd import read_acd
from artigen.datasets.mechanism_object import read_mechanism
from artigen.datasets.mjcf import is_mjcf, list_mjcf_objects, read_mjcf
from artigen.datasets.partnet_annotation import read_json
from artigen.datasets.partnet_mobility import read_object
from artigen.datasets.source_object import ReaderConfig, SourceObject
from artigen.datasets.urdf_file import read_urdf
from artigen.errors import SourceError

Layout = Literal["PartNet-Mobility", "URDF", "MJCF", "object.json"]
ANNOTATION = "mobility_v2.json"
TREE = "object.json"
MAIN = "mobility.urdf"
COMMON_NAMES = (
    "mobility", "model", "robot", "object", "main", "urdf", "mjcf", "xml", "mobility_annotation_gapartnet",
)  # fmt: skip
"""Generic names of files and folders; such an object takes the name of the next folder above."""


def find_layout(source: Path) -> Layout | None:
    """The layout of an object; None if the path is no object.

    A package written by artigen has PartNet's annotation without its meshes, so its URDF counts.
    """
    if source.is_file():
        if source.suffix.lower() == ".urdf":
            return "URDF"
        return "object.json" if source.name == TREE else "MJCF" if is_mjcf(source) else None
    if (source / ANNOTATION).is_file() and not _is_package(source):
        return "PartNet-Mobility"
    if (source / TREE).is_file():
        return "object.json"
    return "URDF" if _find_urdf(source) else "MJCF" if _find_mjcf(source) else None


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
    if find_layout(source) != "MJCF":
        return ()
    file = source if source.is_file() else _find_mjcf(source)
    assert file is not None
    return list_mjcf_objects(file)


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
            file = source if source.is_file() else _find_urdf(source)
            assert file is not None
            return read_mechanism(read_urdf(file), scratch, cfg, name=name)
        case "MJCF":
            file = source if source.is_file() else _find_mjcf(source)
            assert file is not None
            return read_mechanism(read_mjcf(file, cfg.body), scratch, cfg, name=name)
        case "object.json":
            return read_acd(source if source.is_file() else source / TREE, scratch, cfg, name=name)
        case "PartNet-Mobility":
            return read_object(source, cfg)
        case _:
            raise SourceError(
                f"{source}: is no object: expected a URDF or MJCF, or a folder with {MAIN} or one other "
                f"URDF or MJCF, with {ANNOTATION} and its meshes (PartNet-Mobility), or with {TREE} (ACD)"
            )
