"""Tar files with reproducible bytes, and the offsets of their members."""

import io
import tarfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType

from artigen.datasets.packing import PackingError, tar_info

BLOCK = tarfile.BLOCKSIZE
END = bytes(2 * BLOCK)


class TarWriter:
    """Appends members to a new tar file and says where they lie; a context manager."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("wb")

    def __enter__(self) -> "TarWriter":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self._file.write(END)
        self._file.close()

    def add(self, path: str, data: bytes) -> int:
        """Appends a file; returns the offset of its first byte."""
        self._file.write(tar_info(path, len(data)).tobuf(tarfile.USTAR_FORMAT))
        at = self._file.tell()
        self._file.write(data)
        self._file.write(bytes(-len(data) % BLOCK))
        return at

    def tell(self) -> int:
        """Where the next member begins."""
        return self._file.tell()


def read_members(data: bytes, where: str) -> dict[str, bytes]:
    """The members of a piece of a tar file.

    Raises:
        PackingError: If it does not begin with a member, or ends within one; names the piece as ``where``.
    """
    try:
        with tarfile.open(fileobj=io.BytesIO(data + END)) as tar:
            return {member.name: _read(tar, member) for member in tar}
    except tarfile.TarError as error:
        raise PackingError(f"{where}: no members of a tar ({error})") from error


def iterate_samples(path: Path) -> Iterator[tuple[str, Mapping[str, bytes]]]:
    """Key and members (by what follows the key's dot) of every sample of a shard, front to back.

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
        raise tarfile.ReadError(f"{member.name} is cut short")
    return data
