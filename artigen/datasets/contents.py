"""What a source consists of: its file and all files that it names, as one hash."""

import hashlib
import re
from collections.abc import Iterator
from pathlib import Path

from artigen.datasets.joints_file import joints_path
from artigen.datasets.mesh_scene import SUFFIXES
from artigen.files.mtl import clean_name

NAMED = re.compile(
    r"""\b(?:filename|file|url)\s*=\s*["']([^"']+)["']|<uri>\s*([^<]+?)\s*<|"uri"\s*:\s*"([^"]{1,200})\""""
)
"""Attributes of URDF and MJCF, elements of SDF and keys of glTF that name files."""
FOLDERS = re.compile(r"""\b(?:meshdir|texturedir|assetdir)\s*=\s*["']([^"']+)["']""")
"""Attributes of MJCF that name the folders of such files."""
NAMING = {".urdf", ".xacro", ".xml", ".mjcf", ".sdf", ".world", ".gltf", ".dae", ".glb", ".obj", ".mtl"}
"""Files that may name others."""
MOST_BYTES = 400_000_000
"""Longer files are not searched for names; readers refuse them."""
BESIDE = "meta.json"
"""File beside a URDF that may state the category."""


def digest_source(source: Path) -> str:
    """SHA-256 of an object's content: equal content has equal hashes, wherever it lies.

    Counted are all files below a folder; of a file, itself and what it names, directly or through others (a
    URDF its OBJ, that its MTL, that its images). Files that cannot be read count by their names.
    """
    if source.is_dir():
        found = {file.relative_to(source).as_posix(): file for file in source.rglob("*") if file.is_file()}
    else:
        found = dict(_list_used(source))
    digest = hashlib.sha256()
    for name in sorted(found):
        digest.update(name.encode() + b"\0")
        digest.update(_hash(found[name]))
    return digest.hexdigest()


def _list_used(source: Path) -> Iterator[tuple[str, Path]]:
    """A file and all files that it needs, each once, by the names under which they are needed."""
    waiting, seen = [(source.name, source)], {source}
    while waiting:
        name, file = waiting.pop()
        yield name, file
        for other, path in _list_named(file) if file.suffix.lower() in NAMING else ():
            if path not in seen:
                seen.add(path)
                waiting.append((other, path))


def _list_named(file: Path) -> Iterator[tuple[str, Path]]:
    """Names in a file and the first existing file of each, or where it would be."""
    text = _read(file).decode(errors="replace")
    if file.suffix.lower() in (".obj", ".mtl"):
        rows = (line.strip().partition(" ") for line in text.splitlines())
        keys = ("mtllib", "map_", "bump", "norm")
        names = [clean_name(value) for key, _, value in rows if key.startswith(keys)]
        folders = [file.parent]
    else:
        names = ["".join(found) for found in NAMED.findall(text)] + [BESIDE]
        above = [file.parent, *file.parent.absolute().parents]
        folders = [*above, *(file.parent / folder for folder in FOLDERS.findall(text))]
    names += [joints_path(file).name] if file.suffix.lower() in SUFFIXES else []
    for name in dict.fromkeys(names):
        _, _, rest = name.rpartition("://")
        inner = rest.partition("/")[2] if "://" in name else ""
        places = [folder / path for folder in folders for path in (rest, inner) if path]
        yield name, next((place for place in places if place.is_file()), places[0])


def _hash(file: Path) -> bytes:
    """SHA-256 of a file, read piece by piece; that of nothing for what is none, such as a device."""
    try:
        if file.is_file():
            with file.open("rb") as stream:
                return hashlib.file_digest(stream, "sha256").digest()
    except OSError:
        pass
    return hashlib.sha256(b"").digest()


def _read(file: Path) -> bytes:
    """The text of a file that may name others; nothing for one that is too long, or no file."""
    try:
        return file.read_bytes() if file.is_file() and file.stat().st_size <= MOST_BYTES else b""
    except OSError:
        return b""
