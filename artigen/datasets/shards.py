"""`open_shards`: objects of a data set, streamed in the order of its shards or looked up by id."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from artigen.datasets.manifest import MANIFEST, SHARED_INDEX, read_table
from artigen.datasets.packing import PackingError, digest, iterate_samples, read_members, unpack_files
from artigen.datasets.samples import Sample, sample_from_json
from artigen.errors import explain
from artigen.io import whole_folder

FORMAT = "artigen-dataset"
VERSION = 1
INDEX = "dataset.json"
"""The file that makes a folder a data set; written last."""
SHARDS = "shards"
SHARED = "shared"
JSON, THUMBNAIL, ARCHIVE = "json", "webp", "tar.zst"
"""Members of a sample: suffixes after its id and a dot."""
CACHED = 512
"""Most shared files kept in memory."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredObject:
    """An object as stored in a shard; its package is unpacked on demand."""

    id: str
    members: Mapping[str, bytes]
    shards: "Shards"

    @cached_property
    def sample(self) -> Sample:
        """Description of the object."""
        return sample_from_json(self._member(JSON))

    @property
    def record(self) -> dict[str, Any]:
        """Description of the object as plain JSON values."""
        return json.loads(self._member(JSON))

    @property
    def thumbnail(self) -> bytes:
        """Picture of the object, closed and open, as WebP."""
        return self._member(THUMBNAIL)

    def files(self) -> dict[str, bytes]:
        """All files of the package by their path in it, byte for byte as packed."""
        sample = self.sample
        return unpack_files(
            self._member(ARCHIVE), sample.shared, self.shards.shared_file, listed=sample.listed
        )

    def unpack(self, folder: Path | str) -> Path:
        """Writes the package as a folder, which replaces an older one; returns its path."""
        return write_folder(self.files(), Path(folder))

    def _member(self, name: str) -> bytes:
        if name not in self.members:
            raise PackingError(f"the shard holds no {name} of it, only {', '.join(sorted(self.members))}")
        return self.members[name]


class Shards:
    """A data set on disk: iterable, and a mapping from ids to objects. See `open_shards`."""

    def __init__(self, folder: Path, index: Mapping[str, Any]) -> None:
        self.folder = folder
        self.index = index
        self._fetch = lru_cache(maxsize=CACHED)(self._read_shared)

    def __len__(self) -> int:
        return int(self.index["count"])

    def __iter__(self) -> Iterator[StoredObject]:
        """Every object, shard after shard."""
        for path in self.paths:
            for key, members in iterate_samples(path):
                yield StoredObject(id=key, members=members, shards=self)

    def __contains__(self, name: object) -> bool:
        return name in self._places

    def __getitem__(self, name: str) -> StoredObject:
        """The object of an id.

        Raises:
            KeyError: If there is none.
        """
        if name not in self._places:
            raise KeyError(f"{self.folder}: no object {name!r}; .ids lists all {len(self)}")
        shard, offset, size = self._places[name]
        data = _read_piece(self.folder / SHARDS / shard, offset, size)
        members = read_members(data, f"{shard} at {offset}")
        own = {path.partition(".")[2]: data for path, data in members.items()}
        return StoredObject(id=name, members=own, shards=self)

    @property
    def ids(self) -> tuple[str, ...]:
        """All ids in the order of the shards."""
        return tuple(self._places)

    @property
    def paths(self) -> tuple[Path, ...]:
        """The tar files of the objects, in order."""
        return tuple(self.folder / name for name in self.index["files"] if name.startswith(f"{SHARDS}/"))

    def manifest(self, *columns: str) -> Any:
        """The manifest as a `pyarrow.Table`, or some of its columns."""
        return read_table(self.folder / MANIFEST, columns or None)

    def shared_file(self, sha256: str) -> bytes:
        """The content of a shared file.

        Raises:
            PackingError: If the file is missing, or does not match its hash.
        """
        return self._fetch(sha256)

    @cached_property
    def _places(self) -> dict[str, tuple[str, int, int]]:
        table = self.manifest("id", "shard", "offset", "size").to_pydict()
        rows = zip(table["shard"], table["offset"], table["size"], strict=True)
        return dict(zip(table["id"], rows, strict=True))

    @cached_property
    def shared_places(self) -> dict[str, tuple[str, int, int]]:
        """Tar file, offset and size of every shared file, by SHA-256."""
        table = read_table(self.folder / SHARED_INDEX).to_pydict()
        rows = zip(table["shard"], table["offset"], table["size"], strict=True)
        return dict(zip(table["sha256"], rows, strict=True))

    def _read_shared(self, sha256: str) -> bytes:
        if sha256 not in self.shared_places:
            raise PackingError(f"{self.folder}: the shared file {sha256} is in no tar of {SHARED}/")
        name, offset, size = self.shared_places[sha256]
        data = _read_piece(self.folder / SHARED / name, offset, size)
        if digest(data) != sha256:
            raise PackingError(f"{self.folder / SHARED / name}: the file {sha256} was changed")
        return data


def write_folder(files: Mapping[str, bytes], folder: Path) -> Path:
    """Writes files by their path as a folder that appears whole; returns its path."""
    with whole_folder(folder) as scratch:
        for path, data in files.items():
            (scratch / path).parent.mkdir(parents=True, exist_ok=True)
            (scratch / path).write_bytes(data)
    return folder


def open_shards(folder: Path | str) -> Shards:
    """Opens a data set that `artigen dataset` has made.

    Raises:
        PackingError: If the folder holds no data set, or one of another version.
    """
    folder = Path(folder)
    path = folder / INDEX
    try:
        index = json.loads(path.read_text())
        form, version = index["format"], index["version"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise PackingError(f"{folder}: no data set, its {INDEX} cannot be read ({explain(error)})") from error
    if (form, version) != (FORMAT, VERSION):
        raise PackingError(f"{path}: format {form} {version}, this reads {FORMAT} {VERSION}")
    return Shards(folder, index)


def _read_piece(path: Path, offset: int, size: int) -> bytes:
    try:
        with path.open("rb") as file:
            file.seek(offset)
            data = file.read(size)
    except OSError as error:
        raise PackingError(f"{path}: cannot be read ({error.strerror})") from error
    if len(data) != size:
        raise PackingError(f"{path}: ends before byte {offset + size}")
    return data
