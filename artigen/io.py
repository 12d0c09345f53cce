"""Assets as folders: ``asset.json`` for named values, ``asset.npz`` for arrays.

Equal assets give equal bytes, and a folder appears whole or not at all. Reading is strict: an unknown
key is an error, because a misspelt key would otherwise silently mean a default.
"""

import json
import shutil
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path

import numpy as np

from artigen.errors import SourceError, explain
from artigen.types import JOINT_TYPES, PART_LABELS, Asset, Gaussians, Joint, Part, SurfaceSamples, VoxelGrid

FORMAT = "artigen-asset-1"
JOINT_KEYS = ("type", "axis", "origin", "lower", "upper", "pitch")
"""Keys of a joint in ``asset.json``."""
JSON_NAME = "asset.json"
ARRAYS_NAME = "asset.npz"
_HOLDERS = {"voxels": VoxelGrid, "surface": SurfaceSamples, "gaussians": Gaussians}


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """Yields an empty folder that replaces ``folder`` when the block succeeds.

    An older ``folder`` is replaced. If the block fails, no half-written folder is left.

    Raises:
        FileExistsError: If ``folder`` is a file.
    """
    if folder.exists() and not folder.is_dir():
        raise FileExistsError(f"{folder}: is a file, expected a folder or nothing")
    folder.parent.mkdir(parents=True, exist_ok=True)
    scratch = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", suffix=".partial", dir=folder.parent))
    try:
        inner = scratch / "new"
        inner.mkdir()
        yield inner
        old = folder.rename(scratch / "old") if folder.exists() else None
        try:
            inner.rename(folder)
        except OSError:
            if old is not None:
                old.rename(folder)
            raise
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def write_whole(path: Path, content: str | bytes) -> Path:
    """Writes a file, whole or not at all, and returns its path; a missing folder is made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    scratch = path.with_name(f".{path.name}")
    try:
        scratch.write_bytes(content.encode() if isinstance(content, str) else content)
        return scratch.replace(path)
    finally:
        scratch.unlink(missing_ok=True)


def write_asset(asset: Asset, folder: Path) -> None:
    """Writes an asset as a folder, replacing an older one in one step.

    Raises:
        OSError: If writing fails; nothing is left behind.
    """
    with whole_folder(folder) as scratch:
        (scratch / JSON_NAME).write_text(json.dumps(_to_json(asset), indent=1) + "\n", encoding="utf-8")
        write_arrays(_to_arrays(asset), scratch / ARRAYS_NAME)


def read_asset(folder: Path) -> Asset:
    """Reads what `write_asset` wrote.

    Raises:
        SourceError: If a file is missing, damaged or malformed; names the file, the field and its value.
    """
    path = folder / JSON_NAME
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as err:
        raise SourceError(f"{path}: cannot be read: {explain(err)}") from err
    arrays = read_arrays(folder / ARRAYS_NAME)
    known = {f"{name}.{field}" for name, kind in _HOLDERS.items() for field in _array_names(kind)}
    if unknown := sorted(set(arrays) - known):
        raise SourceError(f"{folder / ARRAYS_NAME}: unknown arrays {', '.join(unknown)}")
    try:
        names = {field.name for field in fields(Asset)} - set(_HOLDERS)
        _check_keys(value, names | {"format", "resolution"}, "asset")
        _chosen(value, "format", (FORMAT,))
        resolution = 0 if value["resolution"] is None else _typed(value, "resolution", int)
        voxels, surface, gaussians = (_take(name, kind, arrays) for name, kind in _HOLDERS.items())
        return Asset(
            name=_typed(value, "name", str),
            category=_typed(value, "category", str),
            scale=float(_typed(value, "scale", (int, float))),
            parts=tuple(_read_part(item, index) for index, item in enumerate(_typed(value, "parts", list))),
            voxels=None if voxels is None else VoxelGrid(resolution=resolution, **voxels),
            surface=None if surface is None else SurfaceSamples(**surface),
            gaussians=None if gaussians is None else Gaussians(**gaussians),
            notes=tuple(_typed({"notes": note}, "notes", str) for note in _typed(value, "notes", list)),
        )
    except (ValueError, TypeError) as err:
        raise SourceError(f"{path}: {err}") from err


def write_arrays(arrays: dict[str, np.ndarray], path: Path) -> None:
    """Writes a .npz whose bytes depend on the arrays alone: sorted names, fixed date, no compression."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        for name in sorted(arrays):
            info = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
            with archive.open(info, "w", force_zip64=True) as stream:
                np.lib.format.write_array(stream, np.ascontiguousarray(arrays[name]), allow_pickle=False)


def read_arrays(path: Path) -> dict[str, np.ndarray]:
    """Reads a .npz of plain arrays; pickles are rejected.

    Raises:
        SourceError: If the file is missing or damaged.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile) as err:
        raise SourceError(f"{path}: arrays cannot be read: {explain(err)}") from err


def _array_names(kind: type) -> list[str]:
    return [field.name for field in fields(kind) if field.name != "resolution"]


def _to_arrays(asset: Asset) -> dict[str, np.ndarray]:
    return {
        f"{name}.{field}": getattr(holder, field)
        for name, kind in _HOLDERS.items()
        if (holder := getattr(asset, name)) is not None
        for field in _array_names(kind)
    }


def _to_json(asset: Asset) -> dict[str, object]:
    return {
        "format": FORMAT,
        "name": asset.name,
        "category": asset.category,
        "scale": asset.scale,
        "resolution": None if asset.voxels is None else asset.voxels.resolution,
        "parts": [
            {
                "name": part.name,
                "label": part.label,
                "parent": part.parent,
                "box": part.box.tolist(),
                "joint": {
                    name: value.tolist() if isinstance(value, np.ndarray) else value
                    for name in JOINT_KEYS
                    for value in [getattr(part.joint, name)]
                },
            }
            for part in asset.parts
        ],
        "notes": list(asset.notes),
    }


def _check_keys(value: object, names: set[str], where: str) -> None:
    if not isinstance(value, dict):
        raise TypeError(f"{where}: holds {type(value).__name__}, expected an object")
    unknown, missing = sorted(set(value) - names), sorted(names - set(value))
    if unknown or missing:
        problems = [f"unknown keys {', '.join(unknown)}"] if unknown else []
        problems += [f"missing keys {', '.join(missing)}"] if missing else []
        raise ValueError(f"{where}: {'; '.join(problems)}; allowed are {', '.join(sorted(names))}")


def _typed(value: dict, key: str, kind: type | tuple[type, ...]):
    if not isinstance(value[key], kind) or isinstance(value[key], bool):
        raise TypeError(f"{key!r} holds {value[key]!r}")
    return value[key]


def _chosen(value: dict, key: str, allowed: tuple):
    if value[key] not in allowed:
        raise ValueError(f"{key!r} is {value[key]!r}, expected one of {', '.join(allowed)}")
    return value[key]


def _read_part(item: object, index: int) -> Part:
    where = f"part {index}"
    _check_keys(item, {field.name for field in fields(Part)}, where)
    assert isinstance(item, dict)
    _check_keys(item["joint"], set(JOINT_KEYS), f"{where} joint")
    numbers = {key: float(_typed(item["joint"], key, (int, float))) for key in ("lower", "upper", "pitch")}
    joint = Joint(
        type=_chosen(item["joint"], "type", JOINT_TYPES),
        axis=np.array(item["joint"]["axis"], dtype=np.float64),
        origin=np.array(item["joint"]["origin"], dtype=np.float64),
        lower=numbers["lower"],
        upper=numbers["upper"],
        pitch=numbers["pitch"],
    )
    return Part(
        name=_typed(item, "name", str),
        label=_chosen(item, "label", PART_LABELS),
        parent=_typed(item, "parent", int),
        joint=joint,
        box=np.array(item["box"], dtype=np.float64),
    )


def _take(name: str, kind: type, arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray] | None:
    """The arrays of one holder, None when the asset had none."""
    names = _array_names(kind)
    found = {field: arrays[f"{name}.{field}"] for field in names if f"{name}.{field}" in arrays}
    if found and (missing := sorted(set(names) - set(found))):
        raise ValueError(f"{ARRAYS_NAME}: {name} lacks {', '.join(missing)}")
    return found or None
