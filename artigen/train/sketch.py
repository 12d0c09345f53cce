"""Training of the sketch network: objects of the grammar as tables, asked for in every way or photographed.

Data are shards of tables and of photos in the run's folder, made by worker processes before the training
begins; a batch holds objects of about the same length, with their pictures or without. Every object is asked
for anew each time it is seen, as vaguely or exactly as chance has it.
"""

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import permutations
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn
from torch.nn import functional

from artigen.claim import claim_folder
from artigen.errors import ArtigenError, SourceError
from artigen.models.description import hash_model
from artigen.shapes.draw import draw_shape
from artigen.sketch.batch import RowBatch, ask_for, make_batch
from artigen.sketch.model import load_sketch_network, save_sketch_network
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.picture import MAX_COUNT, Seen
from artigen.sketch.request import nothing_asked
from artigen.sketch.rows import CATEGORIES, COUNTED, ROW_KINDS, column, sketch_to_rows
from artigen.sketch.rules import MAX_ROWS
from artigen.sketch.sketch import SketchError, write_sketch
from artigen.train.batches import prefetch
from artigen.train.loop import LoopConfig, Report, finished_steps, process_seed, train
from artigen.train.shards import HELD_OUT
from artigen.train.sketch_photos import (
    EDGE,
    PackedPhoto,
    PhotoBatch,
    gather_photos,
    read_photos,
    take_photo,
    vary_photos,
    write_photos,
)
from artigen.train.stage import log_metrics
from artigen.types import PART_LABELS
from artigen.workers import Outcome, Worker, run_supervised

logger = logging.getLogger(__name__)
Table = Int[np.ndarray, "T W"]

SIZES: dict[str, SketchNetworkConfig] = {
    "tiny": SketchNetworkConfig(width=64, layers=2, heads=4, pointer=16),
    "small": SketchNetworkConfig(),
    "compact": SketchNetworkConfig(width=512, layers=12, heads=8),
}
"""Sizes by preset."""
SHARD = 100
"""Seeds per shard, each drawn for all categories."""
TIMEOUT = 1800.0
"""Seconds after which a shard is given up."""
READING = 0.3
"""Weight of what the encoder is to read off pictures, beside the likelihood of tables."""
HEADER = 10.0
"""Weight of the fields of a header beside a picture: few among hundreds, and what the picture has to tell."""
READ, HEADS = 0.5, 16
"""Share of the batches that are of pictures with headers and finishes alone, and pictures in each."""
PICTURED, ALONE = 0.8, 0.6
"""Share of the other batches that come with pictures, and of their objects of which nothing else is asked."""
SWAPPED = 0.1
"""Share of the pictures whose red, green and blue are put in any order."""
WINDOW = 6
"""A batch is drawn from so many times its objects next to each other by length."""
MEASURED = 90
"""Held-out objects that are measured."""


@dataclass(frozen=True, kw_only=True)
class SketchRunConfig:
    """One run from nothing to weights."""

    folder: Path
    """Data, checkpoints and weights."""
    preset: str = "small"
    """Sizes."""
    minutes: float = 90.0
    """Budget of the training; making data comes on top."""
    categories: tuple[str, ...] = CATEGORIES
    """What is drawn."""
    shards: int = 24
    """Shards of training data, each of 100 objects of every category."""
    rows: int = 480
    """Rows per step."""
    learning_rate: float = 1e-3
    """Peak learning rate; it falls over the last two fifths of the budget."""
    start: Path | None = None
    """Folder of a model whose weights the network begins with."""
    workers: int = 2
    """Processes that make data."""


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


def train_sketch(cfg: SketchRunConfig, *, on_report: Report | None = None) -> dict[str, float]:
    """Makes what data is missing, trains, and stores the weights; returns the scores of held-out objects.

    Raises:
        ArtigenError: If a number makes no sense, or the folder was started with other settings.
    """
    if cfg.preset not in SIZES:
        raise ArtigenError(f"preset {cfg.preset!r} of the sketch, expected one of {', '.join(SIZES)}")
    if not cfg.minutes > 0 or min(cfg.shards, cfg.rows, cfg.workers) < 1:
        raise ArtigenError(
            f"{cfg.minutes:g} minutes, {cfg.shards} shards, {cfg.rows} rows, {cfg.workers} workers: expected "
            "more than 0 of each"
        )
    start = None if cfg.start is None else hash_model(cfg.start)
    claim_folder(
        cfg.folder / "sketch.json",
        {"preset": cfg.preset, "start": start, "categories": " ".join(cfg.categories)},
    )
    torch.manual_seed(0)
    network = SketchNetwork(SIZES[cfg.preset]) if cfg.start is None else load_sketch_network(cfg.start)
    if network.cfg != SIZES[cfg.preset]:
        raise ArtigenError(
            f"{cfg.start}: {network.cfg}, expected the sizes of preset {cfg.preset!r}, {SIZES[cfg.preset]}"
        )
    network.categories = cfg.categories
    photos = network.picture is not None
    make = partial(make_examples, categories=cfg.categories, workers=cfg.workers, photos=photos)
    trained = make(cfg.folder / "train", HELD_OUT, cfg.shards, count=SHARD)
    held_out = make(cfg.folder / "held_out", 0, 1, count=-(-MEASURED // len(cfg.categories)))
    loop = LoopConfig(
        minutes=cfg.minutes,
        learning_rate=cfg.learning_rate,
        warmup=120,
        decay=0.4,
        ema=0.9995,
        weight_decay=0.02,
    )
    seed = process_seed(loop.seed) + finished_steps(cfg.folder / "sketch")  # other batches at every start
    batches = prefetch(draw_batches(trained, cfg.rows, seed))
    report = on_report or (lambda line: log_metrics("sketch", line))
    edge = EDGE if network.picture is None else network.picture.cfg.edge
    losses = partial(sketch_losses, edge=edge)
    train(SketchLosses(network.train()), losses, batches, cfg.folder / "sketch", loop, on_report=report)
    scores = score_examples(network.cpu(), held_out)
    save_sketch_network(
        network,
        cfg.folder / "model",
        {
            "preset": cfg.preset,
            "objects": len(trained),
            "steps": finished_steps(cfg.folder / "sketch"),
            "held_out": scores,
            "start": start,
        },
    )
    return scores


@dataclass(frozen=True, kw_only=True, eq=False)
class SketchExample:
    """An object as a table, and what it looks like."""

    table: Table
    photo: PackedPhoto | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class SketchBatch:
    """Objects side by side, with their pictures or without."""

    rows: RowBatch
    photos: PhotoBatch | None

    def to(self, device: torch.device | str) -> "SketchBatch":
        """The batch on another device."""
        photos = None if self.photos is None else self.photos.to(device)
        return SketchBatch(rows=self.rows.to(device), photos=photos)


class SketchLosses(nn.Module):
    """The losses of a sketch network as a network of their own: likelihood, and what is read off pictures."""

    def __init__(self, network: SketchNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(self, batch: SketchBatch) -> dict[str, Tensor]:
        """Negative log likelihood of what is said (nats), and what the encoder reads off pictures."""
        sight, terms = None, {}
        if batch.photos is not None:
            seen, sight = self.network.look(batch.photos.image)
            terms = reading_losses(seen, batch.photos) | guessing_losses(seen, batch.rows)
        symbols, numbers = self.network(batch.rows, sight)
        count = len(symbols) + len(numbers)
        if sight is not None:
            for_symbols, for_numbers = weigh_fields(batch.rows)
            symbols, numbers = symbols * for_symbols, numbers * for_numbers
        return {"symbols": symbols.sum() / count, "numbers": numbers.sum() / count, **terms}


def weigh_fields(rows: RowBatch) -> tuple[Float[Tensor, "M"], Float[Tensor, "N"]]:
    """Weights of the symbols and of the numbers that a batch says, in the order of their likelihoods."""
    weights = torch.where(find_headers(rows), HEADER, 1.0)[..., None].expand(rows.said.shape)
    return weights[rows.said & (rows.axes < 0)], weights[rows.said & (rows.axes >= 0)]


def sketch_losses(
    network: nn.Module, batch: SketchBatch, generator: torch.Generator, edge: int = EDGE
) -> dict[str, Tensor]:
    """The terms of a batch, its pictures varied and scaled to ``edge`` pixels."""
    if batch.photos is not None:
        rows, photos = swap_channels(batch.rows, batch.photos, generator)
        batch = SketchBatch(rows=rows, photos=vary_photos(photos, generator, edge))
    return network(batch)


def swap_channels(
    rows: RowBatch, photos: PhotoBatch, generator: torch.Generator
) -> tuple[RowBatch, PhotoBatch]:
    """Puts red, green and blue of some objects in another order, in their pictures and in their finishes.

    The grammar knows the colours of furniture; so colours have to be read off the pictures. Objects whose
    finishes are requested keep theirs: otherwise an unusual colour in a request, without a picture, would
    suggest a swapped object, and its other finishes would be drawn in swapped colours.
    """
    orders = torch.tensor(list(permutations(range(3))), device=generator.device)
    count = len(photos.image)
    chosen = torch.randint(len(orders), (count,), generator=generator, device=generator.device)
    swapped = torch.rand(count, generator=generator, device=generator.device) < SWAPPED
    image, table = photos.image.clone(), rows.rows.clone()
    finishes = table[..., 0] == ROW_KINDS.index("finish")
    requested = (finishes & rows.asked).any(dim=1)
    order = orders[torch.where(swapped & ~requested, chosen, 0)]
    image[:, :3] = image[:, :3].gather(1, order[:, :, None, None].expand_as(image[:, :3]))
    for names in (("r", "g", "b"), ("accent_r", "accent_g", "accent_b")):
        columns = [column("finish", name) for name in names]
        values = table[..., columns]
        moved = values.gather(2, order[:, None].expand_as(values))
        table[..., columns] = torch.where(finishes[..., None], moved, values)
    return replace(rows, rows=table), replace(photos, image=image)


def reading_losses(seen: Seen, photos: PhotoBatch) -> dict[str, Tensor]:
    """What the encoder says of pictures against what they show, each with its weight.

    The map of parts is the rate of a Poisson process: unlike a squared error, its likelihood is not content
    with zeros where parts are few.
    """
    truth = spread_spots(photos, seen.density.shape[-1])
    off = seen.density.sum(dim=(2, 3)) - truth.sum(dim=(2, 3))
    size = seen.labels.shape[-2:]
    labels = functional.interpolate(photos.labels[:, None].float(), size, mode="nearest-exact")[:, 0].long()
    poisson = seen.density - truth * seen.density.clamp(min=1e-6).log()
    return {
        "parts": READING * 0.3 * poisson.sum(dim=(2, 3)).mean(),
        "in view": READING * 0.1 * off.abs().mean(),
        "labels": READING * 0.5 * functional.cross_entropy(seen.labels, labels),
        "view": READING * 2.0 * functional.mse_loss(seen.view, photos.view),
    }


def guessing_losses(seen: Seen, rows: RowBatch) -> dict[str, Tensor]:
    """What the encoder guesses of objects against their headers, each with its weight."""
    header = rows.rows[find_headers(rows)]
    first = column("object", COUNTED[0])
    counts = functional.pad(header[:, first : first + len(COUNTED)], (1, 0), value=1)  # one base
    category = header[:, column("object", "category")]
    wrong = functional.cross_entropy(seen.counts.flatten(0, 1), counts.clamp(max=MAX_COUNT).flatten())
    return {
        "counts": READING * wrong,
        "category": READING * 0.3 * functional.cross_entropy(seen.category, category),
    }


def find_headers(rows: RowBatch) -> Bool[Tensor, "B T"]:
    """The row of each object that says its category, counts and extents; not those of requests."""
    return (rows.rows[..., 0] == ROW_KINDS.index("object")) & ~rows.asked


def spread_spots(photos: PhotoBatch, edge: int) -> Float[Tensor, "B L h w"]:
    """Parts of each label per cell: around the middle of every part in view a bump whose sum is 1."""
    places = torch.arange(edge, device=photos.centers.device) + 0.5
    at = (photos.centers + 1.0) * (edge / 2)
    bumps = torch.exp(-0.5 * (places - at[..., None]) ** 2)
    inside = (photos.given & (at >= 0).all(dim=-1) & (at <= edge).all(dim=-1))[..., None]
    across, down = (bumps / bumps.sum(dim=-1, keepdim=True).clamp(min=1e-6)).unbind(dim=2)
    kinds = functional.one_hot(photos.kinds, len(PART_LABELS)) * inside
    return torch.einsum("bnl,bnh,bnw->blhw", kinds.to(down.dtype), down, across)


@torch.no_grad()
def score_examples(network: SketchNetwork, examples: Sequence[SketchExample]) -> dict[str, float]:
    """Nats that a table costs on average and per field: asked for as in training, and by its picture."""
    rng = np.random.default_rng(0)
    network.eval()
    scores = {}
    for name in ("asked", "pictured") if network.picture is not None else ("asked",):
        total = fields = 0.0
        for example in examples:
            asked, sight = ask_for(example.table, rng), None
            if name == "pictured":
                assert example.photo is not None
                asked, sight = nothing_asked(), network.look(gather_photos([example.photo]).image)[1]
            symbols, numbers = network(make_batch([example.table], [asked]), sight)
            total += float(symbols.sum() + numbers.sum())
            fields += len(symbols) + len(numbers)
        scores |= {name: total / len(examples), f"{name}_per_field": total / fields}
    return scores


def draw_batches(examples: Sequence[SketchExample], rows: int, seed: int) -> Iterator[SketchBatch]:
    """Endless batches: of about ``rows`` rows, of objects of like length, most with pictures; where there are
    pictures, half the batches are of `HEADS` pictures with headers and finishes alone."""
    rng = np.random.default_rng(seed)
    shown = [(head_of(example.table), example.photo) for example in examples if example.photo is not None]
    order = np.argsort([len(example.table) for example in examples], kind="stable")
    lengths = np.array([len(examples[index].table) for index in order])
    ends = np.cumsum(lengths)
    while True:
        if shown and rng.random() < READ:
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
        folder: Of the shards.
        first: Seed of the first object of each category.
        shards: How many.
        categories: What is drawn.
        count: Seeds per shard, each drawn for all categories.
        workers: Processes that make them.
        photos: Whether objects are photographed, too.

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
    """Draws objects of the categories and writes their tables and photos; what is too long is left out."""
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
        raise SourceError(f"{path}: no shard of tables ({error}); delete it to have it made anew") from error
    tables = np.split(rows, ends[:-1])
    if not job.photos:
        return [SketchExample(table=table) for table in tables]
    photos = read_photos(job.path("photos"))
    if len(photos) != len(tables):
        raise SourceError(
            f"{path}: {len(tables)} tables, and {len(photos)} photos beside it; delete both to make them anew"
        )
    return [SketchExample(table=t, photo=p) for t, p in zip(tables, photos, strict=True)]
