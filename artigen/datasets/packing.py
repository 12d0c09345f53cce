"""Packs folders as samples: own files in one compressed archive, images separately by their hash.

`unpack_files` inverts `pack_files` byte for byte, and equal files give equal bytes.
"""

import hashlib
import io
import json
import tarfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path, PurePosixPath
from types import ModuleType

from artigen.errors import ArtigenError, explain

LISTING = "manifest.json"
"""The file with the SHA-256 of the others; it is left out if it can be computed from them."""
UNLISTED = frozenset({LISTING, "validation.json"})
SHARED_SUFFIXES = frozenset({".png", ".jpg", ".jpeg"})
"""Suffixes of files that many objects have in common."""
LEVEL = 19
"""Compression level of zstd: the highest that every decoder supports."""
END = bytes(2 * tarfile.BLOCKSIZE)


class PackingError(ArtigenError):
    """A sample is damaged, or lacks a file that is shared."""


@dataclass(frozen=True, kw_only=True)
class SharedFile:
    """A file of an object that is stored outside its archive."""

    path: str
    sha256: str


@dataclass(frozen=True, kw_only=True, eq=False)
class PackedFiles:
    """The files of a folder: an archive of its own files, and its shared files."""

    archive: bytes
    shared: tuple[SharedFile, ...]
    listed: bool
    """Whether the folder has a listing that can be computed from its other files."""
    contents: Mapping[str, bytes]
    """Contents of the shared files, by SHA-256."""


def digest(data: bytes) -> str:
    """SHA-256 in hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()


def digest_file(path: Path) -> str:
    """SHA-256 of a file in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def list_files(files: Mapping[str, bytes]) -> bytes:
    """The listing (`LISTING`) of a folder with these files."""
    hashes = {path: digest(files[path]) for path in sorted(files) if path not in UNLISTED}
    return (json.dumps(hashes, indent=1) + "\n").encode()


def read_folder(folder: Path) -> dict[str, bytes]:
    """All files of a folder by their path in it."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def pack_files(files: Mapping[str, bytes]) -> PackedFiles:
    """Packs the files of a folder, given by their path in it."""
    listed = LISTING in files and files[LISTING] == list_files(files)
    shared, contents, own = [], {}, {}
    for path in sorted(files):
        if PurePosixPath(path).suffix.lower() in SHARED_SUFFIXES:
            name = digest(files[path])
            shared.append(SharedFile(path=path, sha256=name))
            contents[name] = files[path]
        elif path != LISTING or not listed:
            own[path] = files[path]
    packed = need("zstandard").ZstdCompressor(level=LEVEL).compress(tar_bytes(own))
    return PackedFiles(archive=packed, shared=tuple(shared), listed=listed, contents=contents)


def unpack_files(
    archive: bytes, shared: tuple[SharedFile, ...], fetch: Callable[[str], bytes], *, listed: bool
) -> dict[str, bytes]:
    """The files of a folder by their path, from its archive and shared files.

    Args:
        fetch: Returns the content of a shared file by its SHA-256.
        listed: Whether to add the listing, which was left out.

    Raises:
        PackingError: If the archive is damaged, or a path leads out of the folder.
    """
    zstd = need("zstandard")
    try:
        plain = zstd.ZstdDecompressor().decompress(archive)
        with tarfile.open(fileobj=io.BytesIO(plain)) as tar:
            files = {member.name: tar.extractfile(member).read() for member in tar}  # type: ignore[union-attr]
    except (zstd.ZstdError, tarfile.TarError, AttributeError) as error:
        raise PackingError(f"the archive of a sample is damaged ({error})") from error
    files |= {one.path: fetch(one.sha256) for one in shared}
    for path in files:
        if PurePosixPath(path).is_absolute() or ".." in PurePosixPath(path).parts:
            raise PackingError(f"the path {path} of a sample leads out of its folder")
    if listed:
        files[LISTING] = list_files(files)
    return dict(sorted(files.items()))


def tar_bytes(files: Mapping[str, bytes]) -> bytes:
    """Files as a tar: sorted, with fixed times, owners and modes."""
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w", format=tarfile.USTAR_FORMAT) as tar:
        for path in sorted(files):
            tar.addfile(tar_info(path, len(files[path])), io.BytesIO(files[path]))
    return stream.getvalue()


def tar_info(path: str, size: int) -> tarfile.TarInfo:
    """The header of a file; the same for the same path and size."""
    info = tarfile.TarInfo(path)
    info.size, info.mtime, info.uid, info.gid, info.mode = size, 0, 0, 0, 0o644
    info.uname = info.gname = ""
    return info


def need(module: str, extra: str = "dataset") -> ModuleType:
    """The module of that name.

    Raises:
        ArtigenError: If it is not installed; says how to install it.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        raise ArtigenError(
            f'{error.name} is not installed, data sets need it: pip install "artigen[{extra}]"'
        ) from error


def open_tar(path: Path) -> tarfile.TarFile:
    """A new tar file for `add_member`."""
    return tarfile.open(path, "w", format=tarfile.USTAR_FORMAT)


def add_member(tar: tarfile.TarFile, path: str, data: bytes) -> int:
    """Appends a file; returns the offset of its first byte."""
    info = tar_info(path, len(data))
    at = tar.offset + len(info.tobuf(tarfile.USTAR_FORMAT))
    tar.addfile(info, io.BytesIO(data))
    return at


def read_members(data: bytes, where: str) -> dict[str, bytes]:
    """The members of a piece of a tar file.

    Raises:
        PackingError: If it does not begin with a member, or ends within one; ``where`` names the piece.
    """
    try:
        with tarfile.open(fileobj=io.BytesIO(data + END)) as tar:
            return {member.name: _read(tar, member) for member in tar}
    except tarfile.TarError as error:
        raise PackingError(f"{where}: no members of a tar ({error})") from error


def iterate_samples(path: Path) -> Iterator[tuple[str, Mapping[str, bytes]]]:
    """Key and members (by their suffix after the key's dot) of every sample of a shard, in order.

    Raises:
        PackingError: If the file is missing or damaged.
    """
    try:
        with path.open("rb") as file, tarfile.open(fileobj=file, mode="r|") as tar:
            key, members = "", {}
            for member in tar:
                own, _, name = member.name.partition(".")
                if own != key and members:
                    yield key, members
                    members = {}
                key = own
                members[name] = _read(tar, member)
            if members:
                yield key, members
    except (OSError, tarfile.TarError) as error:
        raise PackingError(f"{path}: cannot be read as a shard ({explain(error)})") from error


def _read(tar: tarfile.TarFile, member: tarfile.TarInfo) -> bytes:
    stream = tar.extractfile(member)
    data = b"" if stream is None else stream.read()
    if len(data) != member.size:
        raise tarfile.ReadError(f"{member.name} is truncated")
    return data
