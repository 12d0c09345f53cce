"""Training data of the sketch network as a stream: processes make objects and batches beside the training.

Makers draw objects of the grammar and photograph every second one; batchers turn tables into the batches of
steps; an album holds all photos on the training device.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Int

from artigen.examples.shards import load_shard, save_shard
from artigen.examples.sketch import (
    ALONE,
    TABLES,
    WINDOW,
    SketchBatch,
    Table,
    head_of,
    make_table,
    pack_tables,
    unpack_tables,
)
from artigen.examples.sketch_photos import CELL, EDGE, PhotoBatch, take_photo
from artigen.shapes.draw import draw_shape
from artigen.sketch.batch import RowBatch, make_batch, sample_request
from artigen.sketch.request import RequestRows, empty_request
from artigen.sketch.words import CATEGORIES

Arrays = dict[str, np.ndarray]
OFTEN = CATEGORIES[:9]
"""Categories of which two objects are drawn for one of every other."""
FIRST = 2_000_000
"""Seed of the makers' first object."""
CHUNK = 32
"""Objects with photos in one file of a maker, beside as many without."""
SPOTS = 64
"""Rows for the parts in view of a photo."""
LOOK = 2.0
"""Seconds after which batchers look for new objects."""


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """Objects and rows of the batches of one step."""

    shown: int = 128
    """Whole tables with photos."""
    plain: int = 14000
    """Rows of whole tables without photos."""
    most: int = 192
    """Most tables without photos."""
    read: int = 320
    """Headers and finishes with photos."""
    told: int = 384
    """Headers and finishes without photos."""


def make_objects(folder: Path, number: int, makers: int) -> None:
    """Writes files of tables and photos without end."""
    torch.set_num_threads(1)
    rng = np.random.default_rng([FIRST, number])
    wishes = _list_wishes(number, makers)
    done = 0
    while True:
        plain, shown, photos = [], [], []
        while len(photos) < CHUNK:
            shape = draw_shape(*next(wishes))
            table = make_table(shape)
            if table is None:
                continue
            if len(plain) < len(shown):
                plain.append(table)
            elif len((photo := take_photo(shape, rng)).spots) <= SPOTS:
                shown.append(table)
                photos.append(photo)
        spots = np.zeros((len(photos), SPOTS, 3), dtype=np.float32)
        for row, photo in zip(spots, photos, strict=True):
            row[: len(photo.spots)] = photo.spots
        name = f"{number:02d}-{done:05d}"
        save_shard(folder / f"shown-{name}.npz", pack_tables(shown), packed=False)
        save_shard(folder / f"plain-{name}.npz", pack_tables(plain), packed=False)
        album = {
            "image": np.stack([photo.rgba for photo in photos]).transpose(0, 3, 1, 2),
            "labels": np.stack([photo.labels for photo in photos]),
            "spots": spots,
            "count": np.array([len(photo.spots) for photo in photos]),
            "view": np.stack([photo.view for photo in photos]).astype(np.float32),
        }
        save_shard(folder / f"photos-{name}.npz", album, packed=False)
        done += 1


def _list_wishes(number: int, makers: int) -> Iterator[tuple[str, int]]:
    """Categories and seeds of one maker."""
    seed = FIRST + number
    while True:
        yield from ((category, seed) for category in CATEGORIES)
        yield from ((category, seed + 1_000_000_000) for category in OFTEN)
        seed += makers


class Pool:
    """Tables, and their order by length."""

    def __init__(self) -> None:
        self.tables: list[Table] = []
        self.heads: list[Table] = []
        self.sort()

    def add(self, tables: Sequence[Table]) -> None:
        """Adds tables; `sort` makes them available."""
        self.tables += tables
        self.heads += [head_of(table) for table in tables]

    def sort(self) -> None:
        """Sorts all tables by length."""
        lengths = np.array([len(table) for table in self.tables], dtype=int)
        self.order = np.argsort(lengths, kind="stable")
        self.lengths = lengths[self.order]

    def pick(self, count: int, rng: np.random.Generator) -> Int[np.ndarray, "K"]:
        """Random tables."""
        return rng.integers(len(self.order), size=count)

    def pick_alike(self, at: int, count: int, rng: np.random.Generator) -> Int[np.ndarray, "K"]:
        """Random tables of about the length of the one at a place in the order."""
        first = max(0, min(at - WINDOW * count // 2, len(self.order) - WINDOW * count))
        some = self.order[first : first + WINDOW * count]
        return rng.choice(some, min(count, len(some)), replace=False)

    def pick_rows(self, rows: int, most: int, rng: np.random.Generator) -> Int[np.ndarray, "K"]:
        """Random tables of similar length with about ``rows`` rows together."""
        ends = np.cumsum(self.lengths)
        at = int(np.searchsorted(ends, rng.random() * ends[-1]))
        return self.pick_alike(at, int(np.clip(rows // (self.lengths[at] + 5), 2, most)), rng)


def make_batches(
    folder: Path, before: Path | None, loaded: Sequence[str], out: Any, sizes: Sizes, number: int
) -> None:
    """Puts the batches of steps, as arrays by name, into a queue without end.

    Args:
        folder: Folder of the makers.
        before: Folder of tables without photos that were made before.
        loaded: Names of the files whose photos the album holds, in its order; it grows.
        out: The queue.
        sizes: Sizes of the batches.
        number: Number of this batcher.
    """
    rng = np.random.default_rng([number, 7])
    plain, shown, read, encoded = Pool(), Pool(), set[Path](), 0.0
    while True:
        if time.monotonic() - encoded > LOOK:
            new = sorted({*folder.glob("plain-*.npz"), *(before.glob("*.npz") if before else ())} - read)
            for path in new:
                plain.add(unpack_tables(load_shard(path, TABLES)))
            for name in list(loaded)[len(shown.tables) // CHUNK :]:
                shown.add(unpack_tables(load_shard(folder / f"shown-{name}.npz", TABLES)))
            read |= set(new)
            plain.sort()
            shown.sort()
            encoded = time.monotonic()
        if min(len(shown.order), len(plain.order)) < 4 * sizes.shown:
            time.sleep(0.5)
            continue
        out.put(_make_step(plain, shown, sizes, rng))


def _make_step(plain: Pool, shown: Pool, sizes: Sizes, rng: np.random.Generator) -> dict[str, Arrays]:
    """The four batches of a step; photos are numbers in the album."""
    whole = shown.pick_alike(int(rng.integers(len(shown.order))), sizes.shown, rng)
    requests = [
        empty_request() if rng.random() < ALONE else sample_request(shown.tables[index], rng)
        for index in whole
    ]
    heads = shown.pick(sizes.read, rng)
    any_pool = plain if rng.random() * (len(plain.order) + len(shown.order)) < len(plain.order) else shown
    some = [any_pool.tables[index] for index in any_pool.pick_rows(sizes.plain, sizes.most, rng)]
    told = any_pool.pick(sizes.told, rng)
    return {
        "shown": _pack([shown.tables[index] for index in whole], requests) | {"photos": whole},
        "plain": _pack(some, [sample_request(table, rng) for table in some]),
        "read": _pack([shown.heads[index] for index in heads], [empty_request()] * len(heads))
        | {"photos": heads},
        "told": _pack(
            [any_pool.heads[index] for index in told],
            [sample_request(any_pool.tables[index], rng) for index in told],
        ),
    }


def _pack(tables: Sequence[Table], requests: Sequence[RequestRows]) -> Arrays:
    """A batch of rows in few bytes."""
    arrays = {name: value.numpy() for name, value in vars(make_batch(tables, requests)).items()}
    return {name: value if value.dtype == bool else value.astype(np.int16) for name, value in arrays.items()}


class Album:
    """All photos on the device, in the order of their arrival."""

    def __init__(self, most: int, device: torch.device) -> None:
        cells = EDGE // CELL
        self.image = torch.empty((most, 4, EDGE, EDGE), dtype=torch.uint8, device=device)
        self.labels = torch.empty((most, cells, cells), dtype=torch.uint8, device=device)
        self.spots = torch.empty((most, SPOTS, 3), device=device)
        self.count = torch.empty(most, dtype=torch.int64, device=device)
        self.view = torch.empty((most, 3), device=device)
        self.size = 0

    def load(self, path: Path) -> bool:
        """Adds the photos of a file of a maker; False if there is no room for them."""
        stored = load_shard(path, ("image", "labels", "spots", "count", "view"))
        here = slice(self.size, self.size + len(stored["count"]))
        if here.stop > len(self.count):
            return False
        for name, values in stored.items():
            getattr(self, name)[here] = torch.from_numpy(values).to(self.count.device)
        self.size = here.stop
        return True

    def take(self, photos: Int[torch.Tensor, "K"], mirror: torch.Generator | None) -> PhotoBatch:
        """A batch of photos, half of them mirrored if there is a generator."""
        image, labels = self.image[photos].float() / 255.0, self.labels[photos].long()
        spots, view = self.spots[photos], self.view[photos]
        if mirror is not None:
            flip = torch.rand(len(photos), generator=mirror, device=image.device) < 0.5
            image = torch.where(flip[:, None, None, None], image.flip(3), image)
            labels = torch.where(flip[:, None, None], labels.flip(2), labels)
            sign = torch.where(flip, -1.0, 1.0)[:, None]
            spots = torch.cat([spots[..., :1], spots[..., 1:2] * sign[..., None], spots[..., 2:]], dim=2)
            view = torch.cat([view[:, :1] * sign, view[:, 1:]], dim=1)
        return PhotoBatch(
            image=image,
            labels=labels,
            kinds=spots[..., 0].long(),
            centers=spots[..., 1:],
            given=torch.arange(SPOTS, device=image.device) < self.count[photos][:, None],
            view=view,
        )


def unpack(arrays: Arrays, album: Album, mirror: torch.Generator | None) -> SketchBatch:
    """A batch on the device of the album, with its photos."""
    device = album.count.device
    tensors = {name: torch.from_numpy(value).to(device) for name, value in arrays.items()}
    photos = tensors.pop("photos", None)
    rows = RowBatch(
        **{name: value if value.dtype == torch.bool else value.long() for name, value in tensors.items()}
    )
    return SketchBatch(rows=rows, photos=None if photos is None else album.take(photos, mirror))
