"""Training of the sketch network: from objects of the grammar to weights."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import torch

from artigen.errors import ArtigenError, name_options
from artigen.examples.batches import prefetch
from artigen.examples.shards import HELD_OUT
from artigen.examples.sketch import SHARD, SketchExample, draw_batches, make_examples
from artigen.examples.sketch_photos import EDGE, gather_photos
from artigen.models.description import hash_model
from artigen.runtime.journal import claim_folder
from artigen.sketch.batch import make_batch, sample_request
from artigen.sketch.model import load_sketch_network, save_sketch_network
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.part_counts import collect_part_counts
from artigen.sketch.picture import PictureConfig
from artigen.sketch.request import empty_request
from artigen.sketch.words import CATEGORIES
from artigen.train.growth import grow_network
from artigen.train.loop import LoopConfig, finished_steps, process_seed, train
from artigen.train.sketch_losses import SketchLosses, sketch_losses

SIZES: dict[str, SketchNetworkConfig] = {
    "tiny": SketchNetworkConfig(
        width=64, layers=2, heads=4, pointer=16, picture=PictureConfig(edge=192, layers=1, heads=4)
    ),
    "small": SketchNetworkConfig(),
    "compact": SketchNetworkConfig(width=512, layers=12, heads=8),
}
"""Sizes by preset."""
MEASURED = 90
"""Least number of held-out objects that are scored."""


@dataclass(frozen=True, kw_only=True)
class SketchRunConfig:
    """One sketch training run, from data to weights."""

    folder: Path
    """Folder for data, checkpoints and weights."""
    preset: str = "small"
    """Size of the network."""
    minutes: float = 90.0
    """Training time; making data takes additional time."""
    categories: tuple[str, ...] = CATEGORIES
    """Categories of the training objects."""
    shards: int = 24
    """Shards of training data, each of 100 objects of every category."""
    rows: int = 480
    """Rows per step."""
    learning_rate: float = 1e-3
    """Peak learning rate; it falls over the last two fifths of the budget."""
    start: Path | None = None
    """Folder of a model with the initial weights; one with fewer blocks grows (`grow_network`)."""
    workers: int = 2
    """Processes that make data."""


def train_sketch(cfg: SketchRunConfig) -> dict[str, float]:
    """Makes missing data, trains, and stores the weights; returns the scores of held-out objects.

    Raises:
        ArtigenError: If a number is out of range, the preset is unknown or does not fit ``cfg.start``, or the
            folder was started with other settings.
    """
    if cfg.preset not in SIZES:
        raise ArtigenError(f"preset {cfg.preset!r} of the sketch, expected {name_options(cfg.preset, SIZES)}")
    if not cfg.minutes > 0 or min(cfg.shards, cfg.rows) < 1 or cfg.workers < 0:
        raise ArtigenError(
            f"{cfg.minutes:g} minutes, {cfg.shards} shards, {cfg.rows} rows, {cfg.workers} workers: expected "
            "more than 0 of each, and no fewer than 0 workers"
        )
    start = None if cfg.start is None else hash_model(cfg.start)
    claim_folder(
        cfg.folder / "sketch.json",
        {"preset": cfg.preset, "start": start, "categories": " ".join(cfg.categories)},
    )
    torch.manual_seed(0)
    size = SIZES[cfg.preset]
    network = SketchNetwork(size) if cfg.start is None else load_sketch_network(cfg.start)
    if network.cfg != size:
        network = grow_network(network, size)
    network.categories = cfg.categories
    photos = network.picture is not None
    make = partial(make_examples, categories=cfg.categories, workers=cfg.workers, photos=photos)
    trained = make(cfg.folder / "train", HELD_OUT, cfg.shards, count=SHARD)
    held_out = make(cfg.folder / "held_out", 0, 1, count=-(-MEASURED // len(cfg.categories)))
    network.part_counts = collect_part_counts(example.table for example in trained)
    loop = LoopConfig(
        minutes=cfg.minutes,
        learning_rate=cfg.learning_rate,
        warmup=120,
        decay=0.4,
        ema=0.9995,
        weight_decay=0.02,
    )
    seed = process_seed(loop.seed) + finished_steps(cfg.folder / "sketch")  # new batches after a resume
    batches = prefetch(draw_batches(trained, cfg.rows, seed))
    edge = EDGE if network.picture is None else network.picture.cfg.edge
    losses = partial(sketch_losses, edge=edge)
    train(SketchLosses(network.train()), losses, batches, cfg.folder / "sketch", loop)
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


@torch.no_grad()
def score_examples(network: SketchNetwork, examples: Sequence[SketchExample]) -> dict[str, float]:
    """Negative log-likelihood (nats) per table and per field, for requests as in training, and for pictures.

    Scores for pictures are ``pictured`` and ``pictured_per_field``, if the network takes pictures.
    """
    rng = np.random.default_rng(0)
    network.eval()
    scores = {}
    for name in ("asked", "pictured") if network.picture is not None else ("asked",):
        total = fields = 0.0
        for example in examples:
            request, memory = sample_request(example.table, rng), None
            if name == "pictured":
                assert example.photo is not None
                request = empty_request()
                _, memory = network.encode_pictures(gather_photos([example.photo]).image)
            symbols, numbers = network(make_batch([example.table], [request]), memory)
            total += float(symbols.sum() + numbers.sum())
            fields += len(symbols) + len(numbers)
        scores |= {name: total / len(examples), f"{name}_per_field": total / fields}
    return scores
