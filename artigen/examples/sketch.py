"""Examples of the sketch network: tables and photos in shards, and batches of them.

Worker processes make the shards before training begins. A batch holds objects of similar length, with or
without pictures. Every time an object is used, a new request for it is sampled, from vague to exact.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Int

from artigen.examples.shards import ShardConfig, ShardJob, load_shard, make_shards, save_shard, split_rows
from artigen.examples.sketch_photos import (
    EDGE,
    PackedPhoto,
    PhotoBatch,
    gather_photos,
    pack_photos,
    take_photos,
    unpack_photos,
)
from artigen.models.batch import TensorBatch
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.sketch.batch import RowBatch, make_batch, sample_request
from artigen.sketch.request import empty_request
from artigen.sketch.rows import ROW_KINDS, sketch_to_rows
from artigen.sketch.rules import MAX_ROWS
from artigen.sketch.sketch import SketchError, write_sketch

Table = Int[np.ndarray, "T W"]
TABLES = ("tables", "lengths")
"""Arrays of the tables in a shard."""
SHARD = 100
"""Seeds per shard, each drawn for all categories."""
TIMEOUT = 1800.0
"""Seconds after which a shard counts as failed."""
READ, HEADS = 0.5, 16
"""Share of batches that hold pictures with headers and finishes alone, and number of pictures in each."""
TOLD, TOLD_HEADS = 0.1, 64
"""The same for headers and finishes without pictures, from which the network learns how common they are."""
PICTURED, ALONE = 0.8, 0.6
"""Share of the other batches with pictures, and share of their objects without any other request."""
WINDOW = 6
"""A batch is sampled from this many times its size of objects that are adjacent by length."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SketchExample:
    """An object as a table, with its photo."""

    table: Table
    photo: PackedPhoto | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class SketchBatch(TensorBatch):
    """A batch of objects, with or without pictures."""

    rows: RowBatch
    photos: PhotoBatch | None


def draw_batches(examples: Sequence[SketchExample], rows: int, seed: int) -> Iterator[SketchBatch]:
    """Endless batches of about ``rows`` rows, of objects of similar length, most with pictures.

    A share of `TOLD` of the batches holds `TOLD_HEADS` headers and finishes alone. If there are pictures, a
    share of `READ` holds `HEADS` of these with pictures.
    """
    rng = np.random.default_rng(seed)
    shown = [(head_of(example.table), example.photo) for example in examples if example.photo is not None]
    order = np.argsort([len(example.table) for example in examples], kind="stable")
    lengths = np.array([len(examples[index].table) for index in order])
    ends = np.cumsum(lengths)
    while True:
        chance = rng.random()
        if chance < TOLD:
            some = [examples[index].table for index in rng.integers(len(examples), size=TOLD_HEADS)]
            requests = [sample_request(table, rng) for table in some]
            yield SketchBatch(rows=make_batch([head_of(table) for table in some], requests), photos=None)
            continue
        if shown and chance < TOLD + READ:
            some = [shown[index] for index in rng.integers(len(shown), size=HEADS)]
            yield SketchBatch(
                rows=make_batch([head for head, _ in some], [empty_request()] * len(some)),
                photos=gather_photos([photo for _, photo in some]),
            )
            continue
        at = int(np.searchsorted(ends, rng.random() * ends[-1]))
        count = max(2, min(rows // (lengths[at] + 5), 48))
        near = order[max(0, at - WINDOW * count // 2) : at + WINDOW * count // 2 + 1]
        picked = [examples[index] for index in rng.choice(near, min(count, len(near)), replace=False)]
        photos = [example.photo for example in picked if example.photo is not None]
        pictured = len(photos) == len(picked) and rng.random() < PICTURED
        requests = [
            empty_request() if pictured and rng.random() < ALONE else sample_request(example.table, rng)
            for example in picked
        ]
        yield SketchBatch(
            rows=make_batch([example.table for example in picked], requests),
            photos=gather_photos(photos) if pictured else None,
        )


def head_of(table: Table) -> Table:
    """The rows before the first part: the header and the finishes."""
    return table[: int((table[:, 0] == ROW_KINDS.index("part")).argmax())]


def make_examples(
    folder: Path,
    first: int,
    shards: int,
    *,
    categories: tuple[str, ...],
    count: int,
    workers: int,
    photos: bool,
) -> list[SketchExample]:
    """Makes the shards that are missing and reads all.

    Args:
        first: Seed of the first object of each category.
        count: Seeds per shard, each drawn for all categories.

    Raises:
        SourceError: If a shard cannot be made or read.
    """
    cfg = ShardConfig(
        categories=categories,
        first_seed=first,
        objects=count * len(categories),
        image_size=EDGE if photos else 0,
        timeout=TIMEOUT,
    )
    paths = make_shards(folder, shards, cfg, make_sketch_shard, workers=workers)
    return [example for path in paths for example in read_sketch_shard(path)]


def make_sketch_shard(job: ShardJob[ShardConfig]) -> Path:
    """Draws the objects of one shard and writes tables and photos; objects without a table are left out."""
    objects = job.objects()
    rng = np.random.default_rng([objects[0][1], 1])
    tables, photos = [], []
    for category, seed in objects:
        shape = draw_shape(category, seed)
        table = make_table(shape)
        if table is not None:
            tables.append(table)
            photos += take_photos([shape], rng) if job.cfg.image_size else []
    save_shard(job.path, pack_tables(tables) | (pack_photos(photos) if photos else {}), packed=True)
    return job.path


def read_sketch_shard(path: Path) -> list[SketchExample]:
    """The examples of a shard.

    Raises:
        SourceError: If the file is damaged or no shard.
    """
    arrays = load_shard(path, TABLES)
    tables = unpack_tables(arrays)
    photos = unpack_photos(arrays) if "pictures" in arrays else [None] * len(tables)
    return [SketchExample(table=t, photo=p) for t, p in zip(tables, photos, strict=True)]


def make_table(shape: Shape) -> Table | None:
    """The table of an object; None if it cannot be written, or is too long."""
    try:
        table = sketch_to_rows(write_sketch(shape))
    except SketchError:
        return None
    return table if len(table) < MAX_ROWS else None


def pack_tables(tables: Sequence[Table]) -> dict[str, np.ndarray]:
    """Tables as the arrays `TABLES`."""
    lengths = np.array([len(table) for table in tables])
    return {"tables": np.concatenate(tables).astype(np.int16), "lengths": lengths}


def unpack_tables(arrays: Mapping[str, np.ndarray]) -> list[Table]:
    """Inverts `pack_tables`."""
    return split_rows(arrays["tables"].astype(np.int64), arrays["lengths"])
