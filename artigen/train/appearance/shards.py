"""Examples of the appearance models on disk: shards written by worker processes.

A shard appears whole or not at all, so a run that was stopped goes on where it was.
"""

import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from pathlib import Path

import numpy as np

from artigen.errors import SourceError
from artigen.io import read_arrays
from artigen.models.extractors import ExtractorConfig, make_extractor
from artigen.train.appearance.curation import CurationConfig
from artigen.train.appearance.examples import AppearanceExample, draw_appearance
from artigen.train.appearance.photographs import Pictures
from artigen.train.shards import HELD_OUT
from artigen.types import PAPER_CATEGORIES
from artigen.workers import Outcome, Worker, run_supervised

PER_VOXEL = ("coords", "part_ids", "features", "views")
PER_PICTURE = tuple(one.name for one in fields(Pictures) if one.name != "displacements")
PER_OBJECT = ("counts", "size")
PACKED = ("exposed",)
"""Stored as bits."""


@dataclass(frozen=True, kw_only=True)
class AppearanceShardConfig:
    """What the examples of a folder are."""

    curation: CurationConfig
    """Joint states, views, and features."""
    extractor: ExtractorConfig = field(default_factory=ExtractorConfig)
    """Where features come from."""
    categories: tuple[str, ...] = PAPER_CATEGORIES
    """Categories, taken in turn."""
    first_seed: int = HELD_OUT
    """Seed of the first object of each category."""
    objects: int = 16
    """Objects per shard."""
    resolution: int = 64
    """Edge of the voxel grid."""
    image_size: int = 128
    """Edge of the condition's picture; 0 takes none."""
    timeout: float = 3600.0
    """Seconds after which a shard is given up."""


@dataclass(frozen=True, kw_only=True)
class AppearanceShardJob:
    """One shard to make."""

    path: Path
    number: int
    cfg: AppearanceShardConfig


def make_appearance_shards(
    folder: Path,
    count: int,
    cfg: AppearanceShardConfig,
    *,
    workers: int,
    on_done: Callable[[Path], None] | None = None,
) -> list[Path]:
    """Makes the shards that are missing and returns all of them, in order.

    Raises:
        SourceError: If a shard could not be made; names it and why.
    """
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [
        AppearanceShardJob(path=folder / f"shard_{number:05d}.npz", number=number, cfg=cfg)
        for number in range(count)
    ]
    missing = [job for job in jobs if not job.path.is_file()]
    handle = partial(_run_job, timeout=cfg.timeout)
    for job, outcome in run_supervised(handle, missing, workers=workers):
        if outcome.error is not None:
            raise SourceError(f"{job.path}: {outcome.error}")
        if on_done is not None:
            on_done(job.path)
    return [job.path for job in jobs]


def make_appearance_shard(job: AppearanceShardJob) -> Path:
    """Draws and photographs the objects of one shard and writes it; runs in a worker process."""
    import torch

    torch.set_num_threads(1)  # there is a process per core already
    cfg = job.cfg
    extractor = make_extractor(cfg.extractor)
    kinds = len(cfg.categories)
    numbers = range(job.number * cfg.objects, (job.number + 1) * cfg.objects)
    write_appearance_shard(
        job.path,
        [
            draw_appearance(
                cfg.categories[number % kinds],
                cfg.first_seed + number // kinds,
                extractor,
                cfg.curation,
                resolution=cfg.resolution,
                image_size=cfg.image_size,
            )
            for number in numbers
        ],
    )
    return job.path


def write_appearance_shard(path: Path, examples: Sequence[AppearanceExample]) -> None:
    """Writes examples, all with as many pictures and states, to one npz file, whole or not at all."""
    arrays: dict[str, np.ndarray] = {
        "names": np.array([one.name for one in examples]),
        "categories": np.array([one.category for one in examples]),
        "resolution": np.array([one.resolution for one in examples]),
        "voxel_counts": np.array([len(one.coords) for one in examples]),
        "part_counts": np.array([len(one.table) for one in examples]),
        "table": np.concatenate([one.table for one in examples]),
        "displacements": np.concatenate([one.pictures.displacements for one in examples], axis=1),
    }
    for name in PER_VOXEL:
        arrays[name] = np.concatenate([getattr(one, name) for one in examples])
    for name in PER_OBJECT:
        arrays[name] = np.stack([getattr(one, name) for one in examples])
    for name in PER_PICTURE:
        values = np.stack([getattr(one.pictures, name) for one in examples])
        arrays[name] = np.packbits(values, axis=-1) if name in PACKED else values
    images = [one.image for one in examples if one.image is not None]
    if len(images) == len(examples):
        arrays["image"] = np.stack(images)
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=".shard", suffix=".npz", delete=False) as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
    Path(file.name).replace(path)


def read_appearance_shard(path: Path) -> Iterator[AppearanceExample]:
    """The examples of a shard.

    Raises:
        SourceError: If the file is missing or damaged.
    """
    arrays = read_arrays(path)
    width = arrays["rgb"].shape[-2]
    for name in PACKED:
        arrays[name] = np.unpackbits(arrays[name], axis=-1, count=width).astype(bool)
    voxel_ends, part_ends = np.cumsum(arrays["voxel_counts"]), np.cumsum(arrays["part_counts"])
    for number, name in enumerate(arrays["names"]):
        at = slice(voxel_ends[number] - arrays["voxel_counts"][number], voxel_ends[number])
        of = slice(part_ends[number] - arrays["part_counts"][number], part_ends[number])
        yield AppearanceExample(
            name=str(name),
            category=str(arrays["categories"][number]),
            resolution=int(arrays["resolution"][number]),
            table=arrays["table"][of],
            pictures=Pictures(
                displacements=arrays["displacements"][:, of],
                **{key: arrays[key][number] for key in PER_PICTURE},
            ),
            image=arrays["image"][number] if "image" in arrays else None,
            **{key: arrays[key][at] for key in PER_VOXEL},
            **{key: arrays[key][number] for key in PER_OBJECT},
        )


def _run_job(
    worker: Worker, job: AppearanceShardJob, timeout: float
) -> tuple[AppearanceShardJob, Outcome[Path]]:
    return job, worker.call(make_appearance_shard, job, timeout)
