"""Tar files with reproducible bytes, and the offsets of their members."""

import io
import tarfile
from collections.abc import Iterator, Mapping
from pathlib import Path

from artigen.datasets.packing import PackingError, tar_info

END = bytes(2 * tarfile.BLOCKSIZE)


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
        raise PackingError(f"{path}: cannot be read as a shard ({error})") from error


def _read(tar: tarfile.TarFile, member: tarfile.TarInfo) -> bytes:
    stream = tar.extractfile(member)
    data = b"" if stream is None else stream.read()
    if len(data) != member.size:
        raise tarfile.ReadError(f"{member.name} is truncated")
    return data
