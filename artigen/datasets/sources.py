"""Finds and reads source objects of any layout: PartNet-Mobility folders, URDFs, xacros, MJCFs, USD, SDFs,
mesh files with their joints, object.json."""

from pathlib import Path
from typing import Literal

from artigen.datasets import mesh_scene, sdf
from artigen.datasets.acd import read_acd
from artigen.datasets.joints_file import joints_path
from artigen.datasets.mechanism_object import read_mechanism
from artigen.datasets.mjcf import is_mjcf, list_mjcf_objects, read_mjcf
from artigen.datasets.partnet_annotation import read_json
from artigen.datasets.partnet_mobility import read_object
from artigen.datasets.source_object import ReaderConfig, SourceObject
from artigen.datasets.urdf_file import read_urdf
from artigen.datasets.usd import SUFFIXES, list_usd_objects, read_usd
from artigen.errors import SourceError

Layout = Literal["PartNet-Mobility", "URDF", "MJCF", "USD", "SDF", "mesh with joints", "object.json"]
ANNOTATION = "mobility_v2.json"
TREE = "object.json"
MAIN = "mobility.urdf"
BY_SUFFIX: dict[str, Layout] = {
    ".urdf": "URDF",
    ".xacro": "URDF",
    **dict.fromkeys(SUFFIXES, "USD"),
    **dict.fromkeys(sdf.SUFFIXES, "SDF"),
}
COMMON_NAMES = (
    "mobility", "model", "robot", "object", "main", "urdf", "mjcf", "xml", "mobility_annotation_gapartnet",
)  # fmt: skip
"""Generic names of files and folders; such an object takes the name of the next folder above."""


def find_layout(source: Path) -> Layout | None:
    """The layout of an object; None if the path is no object.

    A package written by artigen has PartNet's annotation without its meshes, so its URDF counts.
    """
    if source.is_file():
        kind = source.suffix.lower()
        if kind in mesh_scene.SUFFIXES:
            return "mesh with joints" if joints_path(source).is_file() else None
        if kind in BY_SUFFIX:
            return BY_SUFFIX[kind]
        return "object.json" if source.name == TREE else "MJCF" if is_mjcf(source) else None
    if (source / ANNOTATION).is_file() and not _is_package(source):
        return "PartNet-Mobility"
    if (source / TREE).is_file():
        return "object.json"
    if _find_urdf(source):
        return "URDF"
    found = (
        _find_mjcf(source),
        *(_find_one(source, layout) for layout in ("USD", "SDF", "mesh with joints")),
    )
    file = next((file for file in found if file is not None), None)
    return None if file is None else find_layout(file)


def _is_package(folder: Path) -> bool:
    meta = folder / "meta.json"
    value = read_json(meta) if meta.is_file() else None
    return isinstance(value, dict) and "format" in value


def _find_urdf(folder: Path) -> Path | None:
    """The URDF of a folder with one object: the main one, or the only one; else the only xacro."""
    for ends in (".urdf", ".urdf.xacro"):
        files = sorted((*folder.glob(f"*{ends}"), *folder.glob(f"urdf/*{ends}")))
        if files:
            break
    return folder / MAIN if (folder / MAIN).is_file() else files[0] if len(files) == 1 else None


def _find_mjcf(folder: Path) -> Path | None:
    """The MJCF of a folder that holds one."""
    files = [file for file in sorted(folder.glob("*.xml")) if is_mjcf(file)]
    return files[0] if len(files) == 1 else None


def _find_one(folder: Path, layout: Layout) -> Path | None:
    """The file of a layout in a folder that holds one."""
    files = [file for file in sorted(folder.glob("*")) if file.is_file() and find_layout(file) == layout]
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
    stem = path.name.removesuffix(".xacro").rpartition(".")[0] or path.stem
    names = [stem if source.is_file() else path.name, *(folder.name for folder in path.parents)]
    told = (name for name in names if name and name.lower() not in COMMON_NAMES)
    return next(told, names[0])


def list_objects(source: Path) -> tuple[str, ...]:
    """Names of the objects in a file that holds several; none where it holds one.

    Raises:
        SourceError: If the file cannot be read.
    """
    match find_layout(source):
        case "MJCF":
            return list_mjcf_objects(_pick(source, "MJCF"))
        case "USD":
            return list_usd_objects(_pick(source, "USD"))
        case "SDF":
            return sdf.list_sdf_objects(_pick(source, "SDF"))
        case _:
            return ()


def _pick(source: Path, layout: Layout) -> Path:
    """A source that is a file, or the file in it."""
    if source.is_file():
        return source
    match layout:
        case "URDF":
            file = _find_urdf(source)
        case "MJCF":
            file = _find_mjcf(source)
        case _:
            file = _find_one(source, layout)
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
            found = read_urdf(_pick(source, "URDF"), cfg.arguments)
        case "MJCF":
            found = read_mjcf(_pick(source, "MJCF"), cfg.body)
        case "USD":
            found = read_usd(_pick(source, "USD"), cfg.body)
        case "SDF":
            found = sdf.read_sdf(_pick(source, "SDF"), cfg.body)
        case "mesh with joints":
            found = mesh_scene.read_mesh_scene(_pick(source, "mesh with joints"))
        case "object.json":
            return read_acd(source if source.is_file() else source / TREE, scratch, cfg, name=name)
        case "PartNet-Mobility":
            return read_object(source, cfg)
        case _:
            if source.is_file() and source.suffix.lower() in mesh_scene.SUFFIXES:
                mesh_scene.read_mesh_scene(source)  # says what is missing
            raise SourceError(
                f"{source}: is no object: expected a URDF, MJCF, USD, SDF or mesh file, or a folder with "
                f"{MAIN} or one other of these, with {ANNOTATION} and its meshes (PartNet-Mobility), or with "
                f"{TREE} (ACD)"
            )
    return read_mechanism(found, scratch, cfg, name=name)
