"""Shards of examples, written by worker processes, each from its own range of seeds.

A shard appears whole or not at all, so an interrupted run resumes where it stopped.
"""

import logging
import tempfile
import time
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from artigen.errors import SourceError
from artigen.latent.patches import PackedField
from artigen.runtime.workers import Outcome, Worker, run_supervised
from artigen.train.batches import Described
from artigen.train.examples import StructureExample, draw_example
from artigen.types import PAPER_CATEGORIES

logger = logging.getLogger(__name__)
HELD_OUT = 10_000
"""Seeds below this are never trained on."""
PER_OBJECT = ("counts", "size")
"""Arrays of an example's condition that have the same shape for every object."""
ARRAYS = ("names", "categories", "resolution", "patches", "parts", "index", "rows", "table", "counts", "size")
"""Arrays of every shard; there are also pictures if all examples have one."""


@dataclass(frozen=True, kw_only=True)
class ShardConfig:
    """Configuration of the examples of a folder."""

    categories: tuple[str, ...] = PAPER_CATEGORIES
    """Categories, taken in turn."""
    first_seed: int = HELD_OUT
    """Seed of the first object of each category."""
    objects: int = 256
    """Objects per shard."""
    resolution: int = 64
    """Edge of the fields."""
    image_size: int = 128
    """Edge of the pictures in pixels; 0 for none."""
    timeout: float = 600.0
    """Seconds after which a shard counts as failed."""


Config = TypeVar("Config", bound=ShardConfig)
Example = TypeVar("Example")


class Conditioned(Described, Protocol):
    """An example with a name and the values of all conditions."""

    @property
    def name(self) -> str: ...


@dataclass(frozen=True, kw_only=True)
class ShardJob(Generic[Config]):
    """One shard to make."""

    path: Path
    number: int
    cfg: Config

    def objects(self) -> list[tuple[str, int]]:
        """Category and seed of every object of the shard."""
        kinds, first = len(self.cfg.categories), self.number * self.cfg.objects
        return [
            (self.cfg.categories[number % kinds], self.cfg.first_seed + number // kinds)
            for number in range(first, first + self.cfg.objects)
        ]


def make_shards(
    folder: Path,
    count: int,
    cfg: Config,
    make: Callable[[ShardJob[Config]], Path],
    *,
    workers: int,
) -> list[Path]:
    """Makes the shards that are missing and returns the paths of all, in order.

    Args:
        folder: Folder of the shards.
        count: Number of shards.
        cfg: Configuration of their examples.
        make: Makes one shard, in a worker process.
        workers: Number of processes.

    Raises:
        SourceError: If a shard could not be made; gives its path and the reason.
    """
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [
        ShardJob(path=folder / f"shard_{number:05d}.npz", number=number, cfg=cfg) for number in range(count)
    ]
    missing = [job for job in jobs if not job.path.is_file()]
    started = time.monotonic()
    handle = partial(_run_job, make=make, timeout=cfg.timeout)
    for job, outcome in run_supervised(handle, missing, workers=workers):
        if outcome.error is not None:
            raise SourceError(f"{job.path}: {outcome.error}")
        logger.info("%s after %.0f s", job.path.name, time.monotonic() - started)
    return [job.path for job in jobs]


def draw_shard(
    job: ShardJob[Config],
    draw: Callable[[str, int], Example],
    write: Callable[[Path, Sequence[Example]], None],
) -> Path:
    """Draws the objects of one shard by category and seed, and writes it; for worker processes."""
    import torch

    torch.set_num_threads(1)  # there is one process per core
    write(job.path, [draw(category, seed) for category, seed in job.objects()])
    return job.path


def condition_arrays(examples: Sequence[Conditioned]) -> dict[str, np.ndarray]:
    """Names and conditions of examples as arrays, with pictures if all have one."""
    arrays = {
        "names": np.array([one.name for one in examples]),
        "categories": np.array([one.category for one in examples]),
        **{name: np.stack([getattr(one, name) for one in examples]) for name in PER_OBJECT},
    }
    images = [one.image for one in examples if one.image is not None]
    return arrays | ({"image": np.stack(images)} if len(images) == len(examples) else {})


def pick_condition(arrays: dict[str, np.ndarray], number: int) -> dict[str, Any]:
    """The fields of one example that `condition_arrays` has stored."""
    return {
        "name": str(arrays["names"][number]),
        "category": str(arrays["categories"][number]),
        "image": arrays["image"][number] if "image" in arrays else None,
        **{name: arrays[name][number] for name in PER_OBJECT},
    }


def save_shard(path: Path, arrays: dict[str, np.ndarray], *, packed: bool) -> None:
    """Writes arrays to one npz file, whole or not at all; ``packed`` compresses it."""
    save = np.savez_compressed if packed else np.savez
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=".shard", suffix=".npz", delete=False) as file:
        save(file, **arrays)  # type: ignore[arg-type]
    Path(file.name).replace(path)


def write_shard(path: Path, examples: Sequence[StructureExample]) -> None:
    """Writes examples to one npz file, whole or not at all."""
    arrays = condition_arrays(examples) | {
        "resolution": np.array([one.field.resolution for one in examples]),
        "patches": np.array([len(one.field.index) for one in examples]),
        "parts": np.array([len(one.field.table) for one in examples]),
    }
    for name in ("index", "rows", "table"):
        arrays[name] = np.concatenate([getattr(one.field, name) for one in examples])
    save_shard(path, arrays, packed=False)


def read_shard(path: Path) -> Iterator[StructureExample]:
    """The examples of a shard.

    Raises:
        SourceError: If the file is damaged or no shard.
    """
    try:
        with np.load(path) as stored:
            arrays = {name: stored[name] for name in stored.files}
    except (OSError, EOFError, ValueError, zipfile.BadZipFile, zlib.error) as error:
        raise SourceError(f"{path}: is no complete shard ({error}); delete it to make it again") from error
    missing = [name for name in ARRAYS if name not in arrays]
    if missing:
        raise SourceError(f"{path}: is no shard of examples, it lacks {', '.join(missing)}")
    patch_ends, part_ends = np.cumsum(arrays["patches"]), np.cumsum(arrays["parts"])
    for number in range(len(arrays["names"])):
        at = slice(patch_ends[number] - arrays["patches"][number], patch_ends[number])
        of = slice(part_ends[number] - arrays["parts"][number], part_ends[number])
        yield StructureExample(
            field=PackedField(
                resolution=int(arrays["resolution"][number]),
                index=arrays["index"][at],
                rows=arrays["rows"][at],
                table=arrays["table"][of],
            ),
            **pick_condition(arrays, number),
        )


def make_shard(job: ShardJob[ShardConfig]) -> Path:
    """Draws the objects of one shard and writes it; runs in a worker process."""
    draw = partial(draw_example, resolution=job.cfg.resolution, image_size=job.cfg.image_size)
    return draw_shard(job, draw, write_shard)


def _run_job(
    worker: Worker, job: ShardJob[Config], make: Callable[[ShardJob[Config]], Path], timeout: float
) -> tuple[ShardJob[Config], Outcome[Path]]:
    return job, worker.call(make, job, timeout)
