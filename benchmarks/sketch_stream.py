"""Training data of the sketch network as a stream: processes photograph objects beside the training.

Tables made before are plain examples; makers change and photograph these objects, and add them, without end.
All rows and photos stay on the training device, where `Store` puts batches together; `list_steps` lists what
each batch holds.
"""

import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Bool, Int
from sketch_changes import change_shape
from torch import Tensor

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
from artigen.examples.sketch_photos import CELL, EDGE, Photo, PhotoBatch, take_photos
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.sketch.batch import PLACES, RowBatch, make_batch, sample_request
from artigen.sketch.request import RequestRows, empty_request
from artigen.sketch.rows import ROW_KINDS, WIDTH, number_axis, rows_to_sketch
from artigen.sketch.sketch import read_sketch
from artigen.sketch.words import CATEGORIES

Arrays = dict[str, np.ndarray]
CHUNK = 32
"""Objects in one file of a maker."""
TOGETHER = 4
"""Objects that are photographed at once; the pictures of more do not fit into a processor's cache."""
SPOTS = 64
"""Rows for the parts in view of a photo."""
NICE = 10
"""Niceness of the makers: the training comes first."""
LOOK = 2.0
"""Seconds after which new photos are looked for."""
PHOTOS = ("image", "labels", "spots", "count", "view")
ROWS: dict[str, tuple[torch.dtype, int]] = {
    "rows": (torch.int16, WIDTH),
    "predicted": (torch.bool, WIDTH),
    "axes": (torch.int8, WIDTH),
    "part": (torch.uint8, 0),
    "piece": (torch.uint8, 0),
    "low": (torch.int16, 4),
    "high": (torch.int16, 4),
    "named": (torch.bool, 0),
    "ranged": (torch.bool, 0),
    "anchor": (torch.int16, 4),
    "anchored": (torch.bool, 0),
}
"""What `RowBatch` holds of every row of a table: type and columns, 0 for a single value."""
END, PADDING = ROW_KINDS.index("end"), {"axes": -1}
"""Kind of the rows that pad a table, and their values other than 0."""
OFTEN = CATEGORIES[:9]
"""Categories of which two objects are drawn for one of every other."""
FIRST, SEEDS = 6_000_000, 25
"""Seed of the first object, and seeds of a file of tables, each drawn for all categories."""


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """Objects and rows of the batches of one step."""

    shown: int = 128
    """Whole tables with photos."""
    plain: int = 20000
    """Rows of whole tables without photos, in every second step."""
    most: int = 320
    """Most of these tables."""
    read: int = 320
    """Headers and finishes with photos."""
    told: int = 512
    """Headers and finishes without photos, in the other steps."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Recipe:
    """What a batch consists of."""

    tables: Int[np.ndarray, "B"]
    """Numbers of the objects in `Store`."""
    heads: bool
    """Whether only headers and finishes are taken."""
    photos: bool
    length: int
    """Rows of the longest object with its request."""
    rows: Int[np.ndarray, "B R W"]
    """Rows of the requests, padded."""
    known: Bool[np.ndarray, "B R W"]
    counts: Int[np.ndarray, "B"]
    """Number of rows of each request."""


def pack_rows(tables: Sequence[Table]) -> Arrays:
    """The arrays `ROWS` of tables, end to end, and their lengths."""
    none = RequestRows(rows=np.zeros((0, WIDTH), dtype=int), known=np.zeros((0, WIDTH), dtype=bool))
    batch = make_batch(tables, [none] * len(tables))
    lengths = np.array([len(table) for table in tables])
    own = np.arange(batch.rows.shape[1]) < lengths[:, None]
    packed = {
        name: getattr(batch, name).to(kind)[torch.from_numpy(own)].numpy() for name, (kind, _) in ROWS.items()
    }
    return packed | {"lengths": lengths, "heads": np.array([len(head_of(table)) for table in tables])}


def list_tables(folder: Path, files: int) -> list[Path]:
    """The files of plain tables."""
    return [folder / f"plain-{index:05d}.npz" for index in range(files)]


def make_tables(path: Path) -> None:
    """Draws the objects of a file of plain tables."""
    first = FIRST + SEEDS * int(path.stem.removeprefix("plain-"))
    tables = []
    for seed in range(first, first + SEEDS):
        wishes = [(name, seed) for name in CATEGORIES] + [(name, seed + 1_000_000_000) for name in OFTEN]
        drawn = [make_table(draw_shape(category, own)) for category, own in wishes]
        tables += [table for table in drawn if table is not None]
    save_shard(path, pack_tables(tables), packed=False)


def make_objects(folder: Path, files: int, number: int, makers: int) -> None:
    """Makes a maker's share of the plain tables, then files of photographed objects without end.

    Args:
        folder: Folder of all files.
        files: Number of files of plain tables; those that exist are kept.
        number: Number of this maker.
        makers: Number of all.
    """
    os.nice(NICE)
    torch.set_num_threads(1)
    done = len(list(folder.glob(f"photos-{number:02d}-*.npz")))
    rng = np.random.default_rng([number, done])
    paths = list_tables(folder, files)[number::makers]
    for path in paths:
        if not path.is_file():
            make_tables(path)
        packed = pack_rows(unpack_tables(load_shard(path, TABLES)))
        save_shard(folder / path.name.replace("plain", "rows"), packed, packed=False)
    while True:
        for path in paths:
            tables = unpack_tables(load_shard(path, TABLES))
            chosen = [tables[index] for index in rng.permutation(len(tables))]
            for start in range(0, len(chosen), CHUNK):
                name = f"{number:02d}-{done:05d}"
                _photograph(folder, name, chosen[start : start + CHUNK], rng)
                done += 1


def _photograph(folder: Path, name: str, tables: Sequence[Table], rng: np.random.Generator) -> None:
    """Writes one file of changed objects and their photos."""
    pairs = list[tuple[Shape, Table]]()
    for table in tables:
        before = read_sketch(rows_to_sketch(table))
        shape = change_shape(before, rng)
        changed = table if shape is before else make_table(shape)
        if changed is not None:
            pairs.append((shape, changed))
    shapes = [shape for shape, _ in pairs]
    taken = list[Photo]()
    for start in range(0, len(shapes), TOGETHER):
        taken += take_photos(shapes[start : start + TOGETHER], rng)
    shown = [table for (_, table), photo in zip(pairs, taken, strict=True) if len(photo.spots) <= SPOTS]
    photos = [photo for photo in taken if len(photo.spots) <= SPOTS]
    spots = np.zeros((len(photos), SPOTS, 3), dtype=np.float32)
    for row, photo in zip(spots, photos, strict=True):
        row[: len(photo.spots)] = photo.spots
    album = {
        "image": np.stack([photo.rgba for photo in photos]).transpose(0, 3, 1, 2),
        "labels": np.stack([photo.labels for photo in photos]),
        "spots": spots,
        "count": np.array([len(photo.spots) for photo in photos]),
        "view": np.stack([photo.view for photo in photos]).astype(np.float32),
    }
    save_shard(folder / f"shown-{name}.npz", pack_tables(shown), packed=False)
    save_shard(folder / f"photos-{name}.npz", album | pack_rows(shown), packed=False)


class Pool:
    """Headers and finishes of objects, and the order of the objects by length.

    Args:
        first: Number of the first object in `Store`.
    """

    def __init__(self, first: int = 0) -> None:
        self.first = first
        self.heads: list[Table] = []
        self.lengths: list[int] = []
        self.sort()

    def add(self, tables: Sequence[Table]) -> None:
        """Adds objects; `sort` makes them available."""
        self.heads += [head_of(table) for table in tables]
        self.lengths += [len(table) for table in tables]

    def sort(self) -> None:
        """Sorts all objects by length."""
        self.order = np.argsort(self.lengths, kind="stable")
        self.ends = np.cumsum(np.array(self.lengths, dtype=int)[self.order])

    def pick(self, count: int, rng: np.random.Generator) -> Int[np.ndarray, "K"]:
        """Random objects."""
        return rng.integers(len(self.order), size=count)

    def pick_alike(self, at: int, count: int, rng: np.random.Generator) -> Int[np.ndarray, "K"]:
        """Random objects of about the length of the one at a place in the order."""
        first = max(0, min(at - WINDOW * count // 2, len(self.order) - WINDOW * count))
        some = self.order[first : first + WINDOW * count]
        return rng.choice(some, min(count, len(some)), replace=False)

    def pick_rows(self, rows: int, most: int, rng: np.random.Generator) -> Int[np.ndarray, "K"]:
        """Random objects of similar length with about ``rows`` rows together."""
        at = int(np.searchsorted(self.ends, rng.random() * self.ends[-1]))
        length = self.lengths[self.order[at]]
        return self.pick_alike(at, int(np.clip(rows // (length + 5), 2, most)), rng)

    def write(
        self, chosen: Int[np.ndarray, "B"], requests: Sequence[RequestRows], *, heads: bool, photos: bool
    ) -> Recipe:
        """The recipe of a batch."""
        counts = np.array([len(request.rows) for request in requests])
        shape = (len(requests), int(counts.max()), WIDTH)
        rows, known = np.zeros(shape, dtype=np.int16), np.ones(shape, dtype=bool)
        for index, request in enumerate(requests):
            rows[index, : counts[index]], known[index, : counts[index]] = request.rows, request.known
        lengths = [len(self.heads[index]) if heads else self.lengths[index] for index in chosen]
        return Recipe(
            tables=self.first + chosen,
            heads=heads,
            photos=photos,
            length=int((counts + lengths).max()),
            rows=rows,
            known=known,
            counts=counts,
        )


def list_steps(folder: Path, files: int, loaded: Sequence[str], out: Any, sizes: Sizes, number: int) -> None:
    """Puts the recipes of steps, by the name of the batch, into a queue without end.

    Args:
        folder: Folder of the makers.
        files: Number of files of plain tables.
        loaded: Names of the files of makers in the store, in its order; it grows.
        out: The queue.
        sizes: Sizes of the batches.
        number: Seed.
    """
    rng = np.random.default_rng([number, 7])
    plain = Pool()
    for path in list_tables(folder, files):
        plain.add(unpack_tables(load_shard(path, TABLES)))
    plain.sort()
    shown, read, looked = Pool(len(plain.heads)), 0, 0.0
    for without in cycle(("plain", "told")):
        if time.monotonic() - looked > LOOK:
            for name in list(loaded)[read:]:
                shown.add(unpack_tables(load_shard(folder / f"shown-{name}.npz", TABLES)))
                read += 1
            shown.sort()
            looked = time.monotonic()
        if len(shown.order) < WINDOW * sizes.shown:
            time.sleep(0.5)
            continue
        out.put(_list_step(plain, shown, without, sizes, rng))


def _list_step(
    plain: Pool, shown: Pool, without: str, sizes: Sizes, rng: np.random.Generator
) -> dict[str, Recipe]:
    """The recipes of the batches of a step; ``without`` names the one without photos."""

    def ask(pool: Pool, chosen: Int[np.ndarray, "B"], alone: float = 0.0) -> list[RequestRows]:
        return [
            empty_request() if rng.random() < alone else sample_request(pool.heads[index], rng)
            for index in chosen
        ]

    whole = shown.pick_alike(int(rng.integers(len(shown.order))), sizes.shown, rng)
    read = shown.pick(sizes.read, rng)
    if without == "plain":
        chosen = plain.pick_rows(sizes.plain, sizes.most, rng)
    else:
        chosen = plain.pick(sizes.told, rng)
    return {
        "shown": shown.write(whole, ask(shown, whole, ALONE), heads=False, photos=True),
        "read": shown.write(read, [empty_request()] * len(read), heads=True, photos=True),
        without: plain.write(chosen, ask(plain, chosen), heads=without == "told", photos=False),
    }


class Store:
    """All rows and photos on the device: first the plain tables, then the photographed objects.

    Args:
        rows: Most rows of all tables.
        tables: Most tables.
        photos: Most photos.
    """

    def __init__(self, rows: int, tables: int, photos: int, device: torch.device) -> None:
        cells = EDGE // CELL

        def room(count: int, *shape: int, kind: torch.dtype = torch.float32) -> Tensor:
            return torch.zeros((count, *shape), dtype=kind, device=device)

        self.device = device
        self.rows = {name: room(rows, *[size] * (size > 0), kind=kind) for name, (kind, size) in ROWS.items()}
        self.photos = {
            "image": room(photos, 4, EDGE, EDGE, kind=torch.uint8),
            "labels": room(photos, cells, cells, kind=torch.uint8),
            "spots": room(photos, SPOTS, 3),
            "count": room(photos, kind=torch.int64),
            "view": room(photos, 3),
        }
        self.start, self.lengths, self.heads = (room(tables, kind=torch.int64) for _ in range(3))
        self.tables = self.filled = self.plain = 0
        self.most_rows, self.most_photos = rows, photos

    def add_tables(self, path: Path) -> bool:
        """Adds the rows of a file; False if there is no room for them."""
        stored = load_shard(path, (*ROWS, "lengths", "heads"))
        lengths = stored["lengths"]
        here, at = (
            slice(self.filled, self.filled + int(lengths.sum())),
            slice(self.tables, self.tables + len(lengths)),
        )
        if here.stop > self.most_rows:
            return False
        for name, values in self.rows.items():
            values[here] = torch.from_numpy(stored[name]).to(self.device)
        starts = self.filled + np.cumsum(lengths) - lengths
        for name, values in (("start", starts), ("lengths", lengths), ("heads", stored["heads"])):
            getattr(self, name)[at] = torch.from_numpy(values).to(self.device)
        self.filled, self.tables = here.stop, at.stop
        return True

    def add_photos(self, path: Path) -> bool:
        """Adds the objects of a maker's file with their photos; False if there is no room for them."""
        stored = load_shard(path, PHOTOS)
        first = self.tables - self.plain
        here = slice(first, first + len(stored["count"]))
        if here.stop > self.most_photos or not self.add_tables(path):
            return False
        for name, values in stored.items():
            if name in self.photos:
                self.photos[name][here] = torch.from_numpy(values).to(self.device)
        return True

    def make(self, recipe: Recipe, mirror: torch.Generator | None = None) -> SketchBatch:
        """The batch of a recipe; half of its photos are mirrored if there is a generator."""
        tables = torch.from_numpy(recipe.tables).to(self.device)
        photos = self._take_photos(tables - self.plain, mirror) if recipe.photos else None
        return SketchBatch(rows=self._take_rows(recipe, tables), photos=photos)

    def _take_rows(self, recipe: Recipe, tables: Int[Tensor, "B"]) -> RowBatch:
        counts = torch.from_numpy(recipe.counts).to(self.device)[:, None]
        lengths = (self.heads if recipe.heads else self.lengths)[tables][:, None]
        places = torch.arange(recipe.length, device=self.device)[None]
        requested = places < counts
        own = ~requested & (places < counts + lengths)
        at = torch.where(own, self.start[tables][:, None] + places - counts, 0)
        taken = {name: values[at] for name, values in self.rows.items()}
        for name, values in taken.items():
            mine = own if values.dim() == 2 else own[..., None]
            if values.dtype == torch.bool:
                taken[name] = values & mine
            else:
                taken[name] = torch.where(mine, values.long(), PADDING.get(name, 0))
        rest = recipe.length - recipe.rows.shape[1]
        requests = recipe.rows.astype(np.int64)
        for name, values in (("rows", requests), ("axes", number_axis(requests)), ("known", recipe.known)):
            first = torch.from_numpy(np.pad(values, ((0, 0), (0, rest), (0, 0)))).to(self.device)
            taken[name] = torch.where(requested[..., None], first, taken.get(name, True))
        ended = ~own & ~requested
        taken["rows"][..., 0] = torch.where(ended, END, taken["rows"][..., 0])
        early = requested | own & (taken["part"] == 0)
        taken["piece"] = torch.where(early, places.clamp(max=PLACES - 1), taken["piece"])
        return RowBatch(**taken, requested=requested)

    def _take_photos(self, photos: Int[Tensor, "K"], mirror: torch.Generator | None) -> PhotoBatch:
        taken = {name: values[photos] for name, values in self.photos.items()}
        image, labels = taken["image"].float() / 255.0, taken["labels"].long()
        spots, view = taken["spots"], taken["view"]
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
            given=torch.arange(SPOTS, device=image.device) < taken["count"][:, None],
            view=view,
        )
