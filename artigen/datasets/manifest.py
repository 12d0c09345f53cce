"""The manifest of a data set (a row per object in ``manifest.parquet``), its description, and the index of
shared files.

The metadata of the schema make `datasets` of Hugging Face show ``thumbnail`` as an image.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, get_args

from artigen.datasets.duplicates import Duplicate
from artigen.datasets.packing import PackingError, need
from artigen.datasets.samples import Sample
from artigen.errors import explain
from artigen.types import PartLabel

MANIFEST = "manifest.parquet"
SHARED_INDEX = "shared.parquet"
COLUMNS: Mapping[str, str] = {
    "id": "string",
    "category": "string",
    "source": "string",
    "seed": "int64",
    "style": "string",
    "generator": "string",
    "model": "string",
    "draws": "int32",
    "topology": "string",
    "depth": "float64",
    "width": "float64",
    "height": "float64",
    "mass": "float64",
    **{f"{label}s": "int32" for label in get_args(PartLabel) if label not in ("base", "shelf")},
    "shelves": "int32",
    "joint_kinds": "list<string>",
    "handle_annotations": "int32",
    "links": "int32",
    "hulls": "int32",
    "triangles": "int32",
    "passed": "bool",
    "checks_passed": "int32",
    "checks_failed": "list<string>",
    "checks_not_applicable": "list<string>",
    "geometry": "string",
    "package": "string",
    "files": "int32",
    "unpacked_bytes": "int64",
    "packed_bytes": "int64",
    "shared": "list<string>",
    "shard": "string",
    "offset": "int64",
    "size": "int64",
    "thumbnail": "image",
    "descriptor": "binary",
}
"""Columns and their types. ``packed_bytes`` is the size of the archive of the object's own files, ``shared``
lists the SHA-256 of its shared files. Its sample is bytes ``offset`` to ``offset + size`` of its shard."""
SHARED_COLUMNS: Mapping[str, str] = {
    "sha256": "string",
    "shard": "string",
    "offset": "int64",
    "size": "int64",
}


@dataclass(frozen=True, kw_only=True)
class Failure:
    """An object that was drawn and left out of the data set."""

    id: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class About:
    """Name and origin of a data set, and the objects left out."""

    name: str
    title: str
    description: str
    license: str
    creator: str
    url: str
    date: str
    """Date of publication; nothing else in a data set depends on the time of its making."""
    generator: str
    recipes: tuple[tuple[str, str], ...]
    """File name and text of each."""
    digest: str
    """Digest of the recipe; an existing data set with the same digest is not made again."""
    duplicates: tuple[Duplicate, ...] = ()
    failures: tuple[Failure, ...] = ()
    near: float = 0.0


def sample_row(sample: Sample, **place: object) -> dict[str, Any]:
    """The row of a sample; ``place`` holds the columns of its position in the shard and its appearance."""
    value = asdict(sample)
    depth, width, height = sample.extents
    counts = {_plural(one.label): one.count for one in sample.counts if one.label != "base"}
    row = {name: value[name] for name in COLUMNS if name in value and name != "shared"}
    return row | counts | place | {
        "depth": depth,
        "width": width,
        "height": height,
        "joint_kinds": [one.joint.type for one in sample.joints],
        "handle_annotations": len(sample.handles),
        "shared": sorted({one.sha256 for one in sample.shared}),
    }  # fmt: skip


def _plural(label: str) -> str:
    return "shelves" if label == "shelf" else f"{label}s"


class TableWriter:
    """A parquet file that is written in pieces; a context manager."""

    def __init__(self, path: Path, columns: Mapping[str, str]) -> None:
        self._columns = columns
        self._schema = make_schema(columns)
        self._writer = need("pyarrow.parquet").ParquetWriter(path, self._schema, compression="zstd")

    def __enter__(self) -> "TableWriter":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._writer.close()

    def write(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Appends rows, each with every column."""
        pa = need("pyarrow")
        columns = {name: [row[name] for row in rows] for name in self._columns}
        self._writer.write_table(pa.table(columns, schema=self._schema))


def make_schema(columns: Mapping[str, str]) -> Any:
    """The schema of a table, with the metadata that Hugging Face's `datasets` reads."""
    pa = need("pyarrow")
    known = {name: getattr(pa, name)() for name in ("string", "binary", "int32", "int64", "float64")}
    known |= {
        "bool": pa.bool_(),
        "list<string>": pa.list_(pa.string()),
        "image": pa.struct({"bytes": pa.binary(), "path": pa.string()}),
    }
    features = {name: _feature(kind) for name, kind in columns.items()}
    info = json.dumps({"info": {"features": features}})
    return pa.schema([pa.field(name, known[kind]) for name, kind in columns.items()]).with_metadata(
        {"huggingface": info}
    )


def _feature(kind: str) -> dict[str, Any]:
    if kind == "image":
        return {"_type": "Image"}
    if kind == "list<string>":
        return {"feature": {"dtype": "string", "_type": "Value"}, "_type": "List"}
    return {"dtype": kind, "_type": "Value"}


def read_table(path: Path, columns: Sequence[str] | None = None) -> Any:
    """The columns of a manifest as a `pyarrow.Table`.

    Raises:
        PackingError: If the file cannot be read, or lacks a column.
    """
    pa = need("pyarrow")
    try:
        return need("pyarrow.parquet").read_table(path, columns=None if columns is None else list(columns))
    except (OSError, pa.ArrowException) as error:
        raise PackingError(f"{path}: cannot be read as a table ({explain(error)})") from error
