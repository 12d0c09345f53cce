"""Objects of other people, whatever their layout: PartNet-Mobility folders, any URDF, object.json."""

from pathlib import Path
from typing import Literal

from artigen.datasets.acd import read_acd
from artigen.datasets.partnet_annotation import read_json
from artigen.datasets.partnet_mobility import read_object
from artigen.datasets.source_object import ReaderConfig, SourceObject
from artigen.datasets.urdf_object import read_urdf_object
from artigen.errors import SourceError

Layout = Literal["PartNet-Mobility", "URDF", "object.json"]
ANNOTATION = "mobility_v2.json"
TREE = "object.json"
MAIN = "mobility.urdf"
COMMON_NAMES = ("mobility", "model", "robot", "object", "main", "urdf", "mobility_annotation_gapartnet")
"""Names of files that many objects share; such an object is called as its folder is."""


def find_layout(source: Path) -> Layout | None:
    """How an object is laid out; None where a path is none.

    A package that artigen wrote has PartNet's annotation without its meshes: its URDF counts.
    """
    if source.is_file():
        return "URDF" if source.suffix.lower() == ".urdf" else "object.json" if source.name == TREE else None
    if (source / ANNOTATION).is_file() and not _is_package(source):
        return "PartNet-Mobility"
    if (source / TREE).is_file():
        return "object.json"
    return "URDF" if _find_urdf(source) else None


def _is_package(folder: Path) -> bool:
    meta = folder / "meta.json"
    value = read_json(meta) if meta.is_file() else None
    return isinstance(value, dict) and "format" in value


def _find_urdf(folder: Path) -> Path | None:
    """The URDF of a folder that holds one object: the main one, or the only one."""
    files = sorted((*folder.glob("*.urdf"), *folder.glob("urdf/*.urdf")))
    return folder / MAIN if (folder / MAIN).is_file() else files[0] if len(files) == 1 else None


def find_sources(paths: tuple[Path, ...]) -> list[Path]:
    """The objects among ``paths``, and those directly inside of any other folder."""
    found: list[Path] = []
    for path in paths:
        inside = (
            [] if find_layout(path) else [child for child in sorted(path.glob("*")) if find_layout(child)]
        )
        found += inside or [path]
    return found


def name_source(source: Path) -> str:
    """What the package of an object is called: its file, or its folder where files all have one name."""
    if source.is_file() and source.stem.lower() not in COMMON_NAMES:
        return source.stem
    return source.resolve().parent.name if source.is_file() else source.resolve().name


def read_source(source: Path, scratch: Path, cfg: ReaderConfig | None = None) -> SourceObject:
    """Reads one object, whatever its layout.

    Args:
        source: a folder or file.
        scratch: folder for meshes that cannot stay as they are; needed until the package is written.
        cfg: how it is read.

    Raises:
        SourceError: the object cannot be read; one sentence names file, element and value.
    """
    cfg, name = cfg or ReaderConfig(), name_source(source)
    match find_layout(source):
        case "URDF":
            file = source if source.is_file() else _find_urdf(source)
            assert file is not None
            return read_urdf_object(file, scratch, cfg, name=name)
        case "object.json":
            return read_acd(source if source.is_file() else source / TREE, scratch, cfg, name=name)
        case "PartNet-Mobility":
            return read_object(source, cfg)
        case _:
            raise SourceError(
                f"{source}: is no object: expected a URDF, or a folder with {MAIN} or one other URDF, "
                f"with {ANNOTATION} and its meshes (PartNet-Mobility), or with {TREE} (ACD)"
            )
