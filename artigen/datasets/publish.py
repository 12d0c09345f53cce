"""`write_dataset`: packed objects to a data set: shards, shared files, manifest, card, metadata.

Everything is written to a scratch folder and moved into place, ``dataset.json`` last, so that a folder with
that file is complete. The same objects give the same bytes, whatever the order of their making.
"""

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from tarfile import TarFile
from typing import Any

from tqdm import tqdm

from artigen.datasets.card import COLUMNS as CARD_COLUMNS
from artigen.datasets.card import card_text, draw_sheet
from artigen.datasets.croissant import croissant_text
from artigen.datasets.manifest import (
    COLUMNS,
    MANIFEST,
    SHARED_COLUMNS,
    SHARED_INDEX,
    About,
    TableWriter,
    read_table,
    sample_row,
)
from artigen.datasets.packing import add_member, digest, digest_file, open_tar, unpack_files
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
    write_folder,
)

SCRATCH = ".partial"
SHARED_BYTES = 256 * 2**20
"""Size in bytes after which another tar of shared files begins."""
SHEET = "images/objects.webp"
SHEET_COLUMNS, SHEET_ROWS = 4, 12
EXAMPLE = "example"
"""Folder of the one object that is stored unpacked."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PackedObject:
    """An object ready to be put into a shard."""

    sample: Sample
    thumbnail: bytes
    archive: bytes
    descriptor: bytes


def order_objects(ids: Sequence[str], is_full: Callable[[str], bool]) -> list[str]:
    """Ids in an order that mixes categories and depends on the ids alone.

    The first one satisfies ``is_full`` if any does: readers infer the schema from the first samples, so these
    should have no empty list.
    """
    mixed = sorted(ids, key=lambda one: digest(one.encode()))
    first = next((one for one in mixed if is_full(one)), None)
    return mixed if first is None else [first, *(one for one in mixed if one != first)]


def is_full(sample: Sample) -> bool:
    """Whether joints, handles, shared files and inapplicable checks are all non-empty."""
    return bool(sample.joints and sample.handles and sample.shared and sample.checks_not_applicable)


def write_dataset(
    out: Path,
    ids: Sequence[str],
    load: Callable[[str], PackedObject],
    fetch: Callable[[str], bytes],
    about: About,
    *,
    per_shard: int,
) -> Path:
    """Writes a data set.

    Args:
        out: Folder of the data set; other files in it stay.
        ids: Ids of all objects, in the order of `order_objects`.
        fetch: Returns the content of a shared file by its SHA-256.

    Returns:
        ``out``.
    """
    scratch = out / SCRATCH
    shutil.rmtree(scratch, ignore_errors=True)
    for folder in (SHARDS, SHARED, "images", "recipes"):
        (scratch / folder).mkdir(parents=True)
    thumbnails: list[bytes] = []
    contents: set[str] = set()
    bar = tqdm(total=len(ids), unit="object", desc="packed", disable=None)
    with TableWriter(scratch / MANIFEST, COLUMNS) as manifest, bar:
        for number, start in enumerate(range(0, len(ids), per_shard)):
            rows = []
            name = f"objects-{number:05d}.tar"
            with open_tar(scratch / SHARDS / name) as tar:
                for one in ids[start : start + per_shard]:
                    packed = load(one)
                    rows.append(_add_object(tar, name, packed))
                    contents |= {file.sha256 for file in packed.sample.shared}
                    if len(thumbnails) < SHEET_COLUMNS * SHEET_ROWS:
                        thumbnails.append(packed.thumbnail)
                    bar.update()
            manifest.write(rows)
    _write_shared(scratch, sorted(contents), fetch)
    for name, text in about.recipes:
        (scratch / "recipes" / name).write_text(text)
    (scratch / SHEET).write_bytes(draw_sheet(thumbnails, SHEET_COLUMNS))
    first = load(ids[0])
    write_folder(
        unpack_files(first.archive, first.sample.shared, fetch, listed=first.sample.listed), scratch / EXAMPLE
    )
    stored = _list_files(scratch)
    table = read_table(scratch / MANIFEST, CARD_COLUMNS).to_pydict()
    texts = {
        "README.md": card_text(table, stored, about, example=EXAMPLE, sheet=SHEET, shown=len(thumbnails)),
        "croissant.json": croissant_text(len(ids), stored, about),
    }
    for name, text in texts.items():
        (scratch / name).write_text(text)
        stored[name] = {"bytes": len(text.encode()), "sha256": digest(text.encode())}
    (scratch / INDEX).write_text(_index_text(about, len(ids), stored))
    return _move(scratch, out)


def _add_object(tar: TarFile, shard: str, packed: PackedObject) -> dict[str, Any]:
    """Appends the members of an object; returns its row."""
    sample = packed.sample
    offset = tar.offset
    add_member(tar, f"{sample.id}.{JSON}", sample_json(sample))
    add_member(tar, f"{sample.id}.{ARCHIVE}", packed.archive)
    add_member(tar, f"{sample.id}.{THUMBNAIL}", packed.thumbnail)
    return sample_row(
        sample,
        packed_bytes=len(packed.archive),
        shard=shard,
        offset=offset,
        size=tar.offset - offset,
        thumbnail={"bytes": packed.thumbnail, "path": f"{sample.id}.{THUMBNAIL}"},
        descriptor=packed.descriptor,
    )


def _write_shared(scratch: Path, contents: Sequence[str], fetch: Callable[[str], bytes]) -> None:
    """Writes shared files in the order of their SHA-256, as ``<sha256>.png``, and their index."""
    with TableWriter(scratch / SHARED_INDEX, SHARED_COLUMNS) as index:
        number, at = 0, 0
        while at < len(contents) or number == 0:
            name, rows = f"shared-{number:05d}.tar", []
            with open_tar(scratch / SHARED / name) as tar:
                while at < len(contents) and tar.offset < SHARED_BYTES:
                    data = fetch(contents[at])
                    offset = add_member(tar, f"{contents[at]}.png", data)
                    rows.append({"sha256": contents[at], "shard": name, "offset": offset, "size": len(data)})
                    at += 1
            index.write(rows)
            number += 1


def _list_files(scratch: Path) -> dict[str, dict[str, Any]]:
    """Size and SHA-256 of every file."""
    return {
        path.relative_to(scratch).as_posix(): {"bytes": path.stat().st_size, "sha256": digest_file(path)}
        for path in sorted(scratch.rglob("*"))
        if path.is_file()
    }


def _index_text(about: About, count: int, stored: Mapping[str, Mapping[str, Any]]) -> str:
    """Text of ``dataset.json``: every file of the data set, and the objects left out."""
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
        "count": count,
        "duplicates": [asdict(one) for one in about.duplicates],
        "failures": [asdict(one) for one in about.failures],
        "files": dict(sorted(stored.items())),
    }
    return json.dumps(value, indent=1) + "\n"


def _move(scratch: Path, out: Path) -> Path:
    """Moves everything into place, the index last; replaces folders of an earlier data set."""
    (out / INDEX).unlink(missing_ok=True)
    for path in sorted(scratch.iterdir(), key=lambda one: one.name == INDEX):
        target = out / path.name
        if target.is_dir():
            shutil.rmtree(target)
        path.replace(target)
    scratch.rmdir()
    return out
