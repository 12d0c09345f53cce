"""Training of the sketch network: objects of the grammar as tables, asked for in every way.

Data are shards of tables in the run's folder, made by worker processes before the training begins; a batch
holds objects of about the same length. Every object is asked for anew each time it is seen, as vaguely or
exactly as chance has it.
"""

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Int
from torch import Tensor, nn

from artigen.claim import claim_folder
from artigen.errors import ArtigenError, SourceError
from artigen.models.store import hash_model
from artigen.shapes.draw import draw_shape
from artigen.sketch.batch import ask_for, make_batch
from artigen.sketch.model import load_sketch_network, save_sketch_network
from artigen.sketch.network import RowBatch, SketchNetwork, SketchNetworkConfig
from artigen.sketch.rows import CATEGORIES, sketch_to_rows
from artigen.sketch.rules import MAX_ROWS
from artigen.sketch.sketch import SketchError, write_sketch
from artigen.train.batches import prefetch
from artigen.train.loop import LoopConfig, Report, finished_steps, process_seed, train
from artigen.train.shards import HELD_OUT
from artigen.train.stage import log_metrics
from artigen.workers import Outcome, Worker, run_supervised

logger = logging.getLogger(__name__)
Table = Int[np.ndarray, "T W"]

SIZES: dict[str, SketchNetworkConfig] = {
    "tiny": SketchNetworkConfig(width=64, layers=2, heads=4, pointer=16),
    "small": SketchNetworkConfig(),
    "compact": SketchNetworkConfig(width=512, layers=12, heads=8),
}
"""Sizes by preset."""
SHARD = 500
"""Seeds per shard, each drawn for all categories."""
TIMEOUT = 1800.0
"""Seconds after which a shard is given up."""
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
    shards: int = 8
    """Shards of training data, each of 500 objects of every category."""
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
    path: Path
    first: int
    count: int


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
    claim_folder(cfg.folder / "config.json", {"sketch": cfg.preset, "start": start})
    trained = make_tables(cfg.folder / "train", HELD_OUT, cfg.shards, cfg.workers, count=SHARD)
    held_out = make_tables(cfg.folder / "held_out", 0, 1, cfg.workers, count=MEASURED // len(CATEGORIES))
    torch.manual_seed(0)
    network = SketchNetwork(SIZES[cfg.preset]) if cfg.start is None else load_sketch_network(cfg.start)
    loop = LoopConfig(
        minutes=cfg.minutes,
        learning_rate=cfg.learning_rate,
        warmup=120,
        decay=0.4,
        ema=0.9995,
        weight_decay=0.02,
    )
    batches = prefetch(draw_batches(trained, cfg.rows, process_seed(loop.seed)))
    report = on_report or (lambda line: log_metrics("sketch", line))
    train(network.train(), sketch_losses, batches, cfg.folder / "sketch", loop, on_report=report)
    scores = score_tables(network.cpu(), held_out)
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


def sketch_losses(network: nn.Module, batch: RowBatch, generator: torch.Generator) -> dict[str, Tensor]:
    """Mean negative log likelihood of what is said, symbols and numbers apart (nats); nothing is drawn."""
    del generator
    symbols, numbers = network(batch)
    count = len(symbols) + len(numbers)
    return {"symbols": symbols.sum() / count, "numbers": numbers.sum() / count}


@torch.no_grad()
def score_tables(network: SketchNetwork, tables: Sequence[Table]) -> dict[str, float]:
    """Nats that a table costs on average, asked for as in training, and per field."""
    rng = np.random.default_rng(0)
    symbols = numbers = fields = 0.0
    for table in tables:
        said = network.eval()(make_batch([table], [ask_for(table, rng)]))
        symbols, numbers = symbols + float(said[0].sum()), numbers + float(said[1].sum())
        fields += len(said[0]) + len(said[1])
    return {
        "symbols": symbols / len(tables),
        "numbers": numbers / len(tables),
        "per_field": (symbols + numbers) / fields,
    }


def draw_batches(tables: Sequence[Table], rows: int, seed: int) -> Iterator[RowBatch]:
    """Endless batches of about ``rows`` rows, of objects of like length."""
    rng = np.random.default_rng(seed)
    order = np.argsort([len(table) for table in tables], kind="stable")
    lengths = np.array([len(tables[index]) for index in order])
    ends = np.cumsum(lengths)
    while True:
        at = int(np.searchsorted(ends, rng.random() * ends[-1]))
        count = max(2, min(rows // (lengths[at] + 5), 48))
        near = order[max(0, at - WINDOW * count // 2) : at + WINDOW * count // 2 + 1]
        picked = [tables[index] for index in rng.choice(near, min(count, len(near)), replace=False)]
        yield make_batch(picked, [ask_for(table, rng) for table in picked])


def make_tables(folder: Path, first: int, shards: int, workers: int, *, count: int) -> list[Table]:
    """Makes the shards that are missing and reads all.

    Args:
        folder: Of the shards.
        first: Seed of the first object of each category.
        shards: How many.
        workers: Processes that make them.
        count: Seeds per shard.

    Raises:
        SourceError: If a shard cannot be made or read.
    """
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [
        _ShardJob(path=folder / f"tables-{index:03d}.npz", first=first + index * count, count=count)
        for index in range(shards)
    ]
    missing = [job for job in jobs if not job.path.is_file()]
    for done, outcome in enumerate(run_supervised(_make_shard, missing, workers=workers), start=1):
        if outcome.value is None:
            raise SourceError(f"{folder}: a shard of tables could not be made: {outcome.error}")
        logger.info("%d of %d shards of tables made", done, len(missing))
    return [table for job in jobs for table in _read_shard(job.path)]


def _make_shard(worker: Worker, job: _ShardJob) -> Outcome[int]:
    return worker.call(_write_shard, job, TIMEOUT)


def _write_shard(job: _ShardJob) -> int:
    """Draws objects of all categories and writes their tables; what is too long is left out."""
    tables = []
    for seed in range(job.first, job.first + job.count):
        for category in CATEGORIES:
            try:
                table = sketch_to_rows(write_sketch(draw_shape(category, seed)))
            except SketchError:
                continue
            if len(table) < MAX_ROWS:
                tables.append(table.astype(np.int16))
    scratch = job.path.with_name("." + job.path.name)
    ends = np.cumsum([len(table) for table in tables])
    np.savez_compressed(scratch, rows=np.concatenate(tables), ends=ends)
    scratch.replace(job.path)
    return len(tables)


def _read_shard(path: Path) -> list[Table]:
    try:
        with np.load(path) as stored:
            rows, ends = stored["rows"].astype(np.int64), stored["ends"]
    except (OSError, ValueError, KeyError) as error:
        raise SourceError(f"{path}: no shard of tables ({error}); delete it to have it made anew") from error
    return np.split(rows, ends[:-1])
