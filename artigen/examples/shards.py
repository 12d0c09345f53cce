"""Shards of examples, written by worker processes, each from its own range of seeds.

A shard appears whole or not at all, so an interrupted run resumes where it stopped.
"""

import logging
import tempfile
import time
import zipfile
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.errors import SourceError, explain
from artigen.kind import paper_kinds
from artigen.runtime.runner import LocalRunner
from artigen.runtime.workers import Outcome, Worker

logger = logging.getLogger(__name__)
HELD_OUT = 10_000
"""Seeds below this are never trained on."""
PER_OBJECT = ("counts", "size")
"""Arrays of an example's condition that have the same shape for every object."""
CONDITION = ("names", "categories", *PER_OBJECT)
"""Arrays of conditions; there are also pictures if all examples have one."""


@dataclass(frozen=True, kw_only=True)
class ShardConfig:
    """Configuration of the examples of a folder."""

    categories: tuple[str, ...] = field(default_factory=paper_kinds)
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


class Described(Protocol):
    """An example with the values of all conditions; ``image`` is RGBA, premultiplied on black."""

    @property
    def name(self) -> str: ...

    @property
    def category(self) -> str: ...

    @property
    def counts(self) -> UInt8[np.ndarray, "L"]: ...

    @property
    def size(self) -> Float[np.ndarray, "3"]: ...

    @property
    def image(self) -> UInt8[np.ndarray, "H W 4"] | None: ...


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
    folder: Path, count: int, cfg: Config, make: Callable[[ShardJob[Config]], Path], *, workers: int
) -> list[Path]:
    """Makes the shards that are missing and returns the paths of all, in order.

    Args:
        make: Makes one shard, in a worker process.

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
    for job, outcome in LocalRunner(workers=workers).run(handle, missing):
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


def condition_arrays(examples: Sequence[Described]) -> dict[str, np.ndarray]:
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


def load_shard(path: Path, needed: Sequence[str]) -> dict[str, np.ndarray]:
    """The arrays of a shard.

    Raises:
        SourceError: If the file is damaged or lacks one of the ``needed`` arrays.
    """
    try:
        with np.load(path) as stored:
            arrays = {name: stored[name] for name in stored.files}
    except (OSError, EOFError, ValueError, zipfile.BadZipFile, zlib.error) as error:
        raise SourceError(
            f"{path}: is no complete shard ({explain(error)}); delete it to make it again"
        ) from error
    missing = [name for name in needed if name not in arrays]
    if missing:
        raise SourceError(f"{path}: is no shard of examples, it lacks {', '.join(missing)}")
    return arrays


def split_rows(values: np.ndarray, counts: Int[np.ndarray, "N"], axis: int = 0) -> list[np.ndarray]:
    """The rows of each example, which are stored one example after the other."""
    return np.split(values, np.cumsum(counts)[:-1], axis=axis)


def _run_job(
    worker: Worker, job: ShardJob[Config], make: Callable[[ShardJob[Config]], Path], timeout: float
) -> tuple[ShardJob[Config], Outcome[Path]]:
    return job, worker.call(make, job, timeout)
