"""Training examples of the sketch network: tables and photos in shards, and batches of them.

Worker processes make the shards before training begins. A batch holds objects of similar length, with or
without pictures. Every time an object is used, a new request for it is sampled, from vague to exact.
"""

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Int

from artigen.errors import SourceError
from artigen.runtime.workers import Outcome, Worker, run_supervised
from artigen.shapes.draw import draw_shape
from artigen.sketch.batch import RowBatch, ask_for, make_batch
from artigen.sketch.request import nothing_asked
from artigen.sketch.rows import ROW_KINDS, sketch_to_rows
from artigen.sketch.rules import MAX_ROWS
from artigen.sketch.sketch import SketchError, write_sketch
from artigen.train.sketch_photos import (
    PackedPhoto,
    PhotoBatch,
    gather_photos,
    read_photos,
    take_photo,
    write_photos,
)

logger = logging.getLogger(__name__)
Table = Int[np.ndarray, "T W"]
SHARD = 100
"""Seeds per shard, each drawn for all categories."""
TIMEOUT = 1800.0
"""Seconds after which a shard counts as failed."""
READ, HEADS = 0.5, 16
"""Share of batches that hold pictures with headers and finishes alone, and number of pictures in each."""
TOLD, TOLD_HEADS = 0.1, 64
"""The same for headers and finishes without pictures: what an object of a category has if nothing else is
known."""
PICTURED, ALONE = 0.8, 0.6
"""Share of the other batches with pictures, and share of their objects without any other request."""
WINDOW = 6
"""A batch is sampled from this many times its size of objects that are adjacent by length."""


@dataclass(frozen=True, kw_only=True)
class _ShardJob:
    folder: Path
    number: int
    first: int
    count: int
    photos: bool
    categories: tuple[str, ...]

    def path(self, what: str) -> Path:
        return self.folder / f"{what}-{self.number:03d}.npz"

    @property
    def done(self) -> bool:
        return self.path("tables").is_file() and (not self.photos or self.path("photos").is_file())


@dataclass(frozen=True, kw_only=True, eq=False)
class SketchExample:
    """An object as a table, with its photo."""

    table: Table
    photo: PackedPhoto | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class SketchBatch:
    """A batch of objects, with or without pictures."""

    rows: RowBatch
    photos: PhotoBatch | None

    def to(self, device: torch.device | str) -> "SketchBatch":
        """The batch on another device."""
        photos = None if self.photos is None else self.photos.to(device)
        return SketchBatch(rows=self.rows.to(device), photos=photos)


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
            asked = [ask_for(table, rng) for table in some]
            yield SketchBatch(rows=make_batch([head_of(table) for table in some], asked), photos=None)
            continue
        if shown and chance < TOLD + READ:
            some = [shown[index] for index in rng.integers(len(shown), size=HEADS)]
            yield SketchBatch(
                rows=make_batch([head for head, _ in some], [nothing_asked()] * len(some)),
                photos=gather_photos([photo for _, photo in some]),
            )
            continue
        at = int(np.searchsorted(ends, rng.random() * ends[-1]))
        count = max(2, min(rows // (lengths[at] + 5), 48))
        near = order[max(0, at - WINDOW * count // 2) : at + WINDOW * count // 2 + 1]
        picked = [examples[index] for index in rng.choice(near, min(count, len(near)), replace=False)]
        photos = [example.photo for example in picked if example.photo is not None]
        pictured = len(photos) == len(picked) and rng.random() < PICTURED
        asked = [
            nothing_asked() if pictured and rng.random() < ALONE else ask_for(example.table, rng)
            for example in picked
        ]
        yield SketchBatch(
            rows=make_batch([example.table for example in picked], asked),
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
        folder: Folder of the shards.
        first: Seed of the first object of each category.
        shards: Number of shards.
        categories: Categories of the objects.
        count: Seeds per shard, each drawn for all categories.
        workers: Number of processes that make shards.
        photos: Whether photos of the objects are made as well.

    Raises:
        SourceError: If a shard cannot be made or read.
    """
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [
        _ShardJob(
            folder=folder,
            number=index,
            first=first + index * count,
            count=count,
            photos=photos,
            categories=categories,
        )
        for index in range(shards)
    ]
    missing = [job for job in jobs if not job.done]
    for done, outcome in enumerate(run_supervised(_make_shard, missing, workers=workers), start=1):
        if outcome.value is None:
            raise SourceError(f"{folder}: a shard could not be made: {outcome.error}")
        logger.info("%d of %d shards made", done, len(missing))
    return [example for job in jobs for example in _read_shard(job)]


def _make_shard(worker: Worker, job: _ShardJob) -> Outcome[int]:
    return worker.call(_write_shard, job, TIMEOUT)


def _write_shard(job: _ShardJob) -> int:
    """Draws objects of the categories and writes their tables and photos; too long tables are left out."""
    tables, photos = [], []
    rng = np.random.default_rng([job.first, 1])
    for seed in range(job.first, job.first + job.count):
        for category in job.categories:
            shape = draw_shape(category, seed)
            try:
                table = sketch_to_rows(write_sketch(shape))
            except SketchError:
                continue
            if len(table) < MAX_ROWS:
                tables.append(table.astype(np.int16))
                photos += [take_photo(shape, rng)] if job.photos else []
    if job.photos:
        write_photos(job.path("photos"), photos)
    path = job.path("tables")
    scratch = path.with_name("." + path.name)
    ends = np.cumsum([len(table) for table in tables])
    np.savez_compressed(scratch, rows=np.concatenate(tables), ends=ends)
    scratch.replace(path)
    return len(tables)


def _read_shard(job: _ShardJob) -> list[SketchExample]:
    path = job.path("tables")
    try:
        with np.load(path) as stored:
            rows, ends = stored["rows"].astype(np.int64), stored["ends"]
    except (OSError, ValueError, KeyError) as error:
        raise SourceError(f"{path}: is no shard of tables ({error}); delete it to make it again") from error
    tables = np.split(rows, ends[:-1])
    if not job.photos:
        return [SketchExample(table=table) for table in tables]
    photos = read_photos(job.path("photos"))
    if len(photos) != len(tables):
        raise SourceError(
            f"{path}: {len(tables)} tables, but {len(photos)} photos; delete both files to make them again"
        )
    return [SketchExample(table=t, photo=p) for t, p in zip(tables, photos, strict=True)]
