"""`write_dataset`: packed objects to a data set: shards, shared files, manifest, card, metadata.

Everything is written to a scratch folder and moved into place, ``dataset.json`` last: a folder is a data set
whole or not at all. The same objects give the same bytes, in whatever order they were made.
"""

import hashlib
import json
import shutil
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from artigen.datasets.card import card_text, draw_sheet
from artigen.datasets.croissant import croissant_text
from artigen.datasets.duplicates import Duplicate
from artigen.datasets.manifest import (
    COLUMNS,
    MANIFEST,
    SHARED_COLUMNS,
    SHARED_INDEX,
    TableWriter,
    sample_row,
)
from artigen.datasets.samples import Sample, sample_json
from artigen.datasets.shards import (
    ARCHIVE,
    FORMAT,
    INDEX,
    JSON,
    SHARDS,
    SHARED,
    THUMBNAIL,
    VERSION,
    open_shards,
)
from artigen.datasets.tars import TarWriter

SCRATCH = ".partial"
SHARED_BYTES = 256 * 2**20
"""Size after which another tar of shared files begins."""
SHEET = "images/objects.webp"
SHEET_COLUMNS, SHEET_ROWS = 4, 12
EXAMPLE = "example"
"""Folder of the one object that is there unpacked."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PackedObject:
    """An object ready to be put into a shard."""

    sample: Sample
    thumbnail: bytes
    archive: bytes
    descriptor: bytes


@dataclass(frozen=True, kw_only=True)
class Failure:
    """An object that was drawn and is not in the data set."""

    id: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class About:
    """What a data set says of itself."""

    name: str
    title: str
    description: str
    license: str
    creator: str
    url: str
    date: str
    """Of publication; nothing else in a data set depends on when it was made."""
    generator: str
    recipes: tuple[tuple[str, str], ...]
    """File name and text of each."""
    digest: str
    """Of the recipe; a data set of the same is not made again."""
    duplicates: tuple[Duplicate, ...] = ()
    failures: tuple[Failure, ...] = ()
    near: float = 0.0


def order_objects(ids: Sequence[str], is_full: Callable[[str], bool]) -> list[str]:
    """Ids in an order that mixes categories and follows from the ids alone.

    The first is one of which ``is_full`` holds, if there is any: readers take the schema from the first
    samples, so these should have something in every list.
    """
    mixed = sorted(ids, key=lambda one: hashlib.sha256(one.encode()).hexdigest())
    first = next((one for one in mixed if is_full(one)), None)
    return mixed if first is None else [first, *(one for one in mixed if one != first)]


def is_full(sample: Sample) -> bool:
    """Whether every list that tells of the object has something in it."""
    return bool(sample.joints and sample.handles and sample.shared and sample.checks_not_applicable)


def write_dataset(
    out: Path,
    ids: Sequence[str],
    load: Callable[[str], PackedObject],
    fetch: Callable[[str], bytes],
    about: About,
    *,
    per_shard: int,
    on_step: Callable[[int, int], None] | None = None,
) -> Path:
    """Writes a data set.

    Args:
        out: Its folder; what else lies in it stays.
        ids: Of all objects, in the order of `order_objects`.
        load: An object by its id.
        fetch: A shared file by its SHA-256.
        about: What it says of itself.
        per_shard: Objects per shard.
        on_step: Told how many objects are written, of how many.
    """
    scratch = out / SCRATCH
    shutil.rmtree(scratch, ignore_errors=True)
    for folder in (SHARDS, SHARED, "images", "recipes"):
        (scratch / folder).mkdir(parents=True)
    thumbnails: list[bytes] = []
    contents: set[str] = set()
    with TableWriter(scratch / MANIFEST, COLUMNS) as manifest:
        for number, start in enumerate(range(0, len(ids), per_shard)):
            rows = []
            name = f"objects-{number:05d}.tar"
            with TarWriter(scratch / SHARDS / name) as tar:
                for one in ids[start : start + per_shard]:
                    packed = load(one)
                    rows.append(_add_object(tar, name, packed))
                    contents |= {file.sha256 for file in packed.sample.shared}
                    if len(thumbnails) < SHEET_COLUMNS * SHEET_ROWS:
                        thumbnails.append(packed.thumbnail)
                    if on_step is not None:
                        on_step(start + len(rows), len(ids))
            manifest.write(rows)
    _write_shared(scratch, sorted(contents), fetch)
    for name, text in about.recipes:
        (scratch / "recipes" / name).write_text(text)
    (scratch / SHEET).write_bytes(draw_sheet(thumbnails, SHEET_COLUMNS))
    _write_index(scratch, about, ids)
    open_shards(scratch)[ids[0]].unpack(scratch / EXAMPLE)
    stats_of = open_shards(scratch)
    (scratch / "README.md").write_text(card_text(stats_of, about, EXAMPLE, SHEET))
    (scratch / "croissant.json").write_text(croissant_text(stats_of, about))
    _write_index(scratch, about, ids)
    return _move(scratch, out)


def _add_object(tar: TarWriter, shard: str, packed: PackedObject) -> dict[str, Any]:
    """Appends the members of an object; returns its row."""
    sample = packed.sample
    offset = tar.tell()
    tar.add(f"{sample.id}.{JSON}", sample_json(sample))
    tar.add(f"{sample.id}.{ARCHIVE}", packed.archive)
    tar.add(f"{sample.id}.{THUMBNAIL}", packed.thumbnail)
    return sample_row(
        sample,
        packed_bytes=len(packed.archive),
        shard=shard,
        offset=offset,
        size=tar.tell() - offset,
        thumbnail={"bytes": packed.thumbnail, "path": f"{sample.id}.{THUMBNAIL}"},
        descriptor=packed.descriptor,
    )


def _write_shared(scratch: Path, contents: Sequence[str], fetch: Callable[[str], bytes]) -> None:
    """Shared files in the order of their SHA-256, as ``<sha256>.png``, and where they lie."""
    with TableWriter(scratch / SHARED_INDEX, SHARED_COLUMNS) as index:
        number, at = 0, 0
        while at < len(contents) or number == 0:
            name, rows = f"shared-{number:05d}.tar", []
            with TarWriter(scratch / SHARED / name) as tar:
                while at < len(contents) and tar.tell() < SHARED_BYTES:
                    data = fetch(contents[at])
                    offset = tar.add(f"{contents[at]}.png", data)
                    rows.append({"sha256": contents[at], "shard": name, "offset": offset, "size": len(data)})
                    at += 1
            index.write(rows)
            number += 1


def _write_index(scratch: Path, about: About, ids: Sequence[str]) -> None:
    """``dataset.json``: every file of the data set with size and SHA-256, and what was left out."""
    files = {}
    for path in sorted(scratch.rglob("*")):
        name = path.relative_to(scratch).as_posix()
        if path.is_file() and name != INDEX:
            files[name] = {"bytes": path.stat().st_size, "sha256": _hash_file(path)}
    value = {
        "format": FORMAT,
        "version": VERSION,
        "name": about.name,
        "title": about.title,
        "description": about.description,
        "license": about.license,
        "creator": about.creator,
        "url": about.url,
        "date": about.date,
        "generator": about.generator,
        "recipe": about.digest,
        "near": about.near,
        "count": len(ids),
        "duplicates": [asdict(one) for one in about.duplicates],
        "failures": [asdict(one) for one in about.failures],
        "files": files,
    }
    (scratch / INDEX).write_text(json.dumps(value, indent=1) + "\n")


def _hash_file(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _move(scratch: Path, out: Path) -> Path:
    """Moves everything into place, the index last; folders of a data set that was there before make way."""
    (out / INDEX).unlink(missing_ok=True)
    for path in sorted(scratch.iterdir(), key=lambda one: one.name == INDEX):
        target = out / path.name
        if target.is_dir():
            shutil.rmtree(target)
        path.replace(target)
    scratch.rmdir()
    return out
