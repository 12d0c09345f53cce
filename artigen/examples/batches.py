"""Examples in memory and endless random batches of them, prefetched in a thread."""

import queue
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import torch
from torch import Tensor

from artigen.conditioning.prompt import write_text
from artigen.examples.shards import Described
from artigen.examples.structure import StructureExample
from artigen.latent.outline import OutlineBatch, gather_outlines
from artigen.latent.patches import PatchBatch, collate
from artigen.models.batch import TensorBatch
from artigen.models.conditions import ConditionBatch, ConditionConfig
from artigen.types import PART_LABELS

Batch = TypeVar("Batch")
Example = TypeVar("Example")


@dataclass(frozen=True, kw_only=True, eq=False)
class FieldBatch(TensorBatch):
    """Fields of objects with their outlines."""

    patches: PatchBatch
    outlines: OutlineBatch


@dataclass(frozen=True, kw_only=True, eq=False)
class LatentBatch(TensorBatch):
    """Posterior means and standard deviations of objects, with their conditions and outlines."""

    mean: Tensor
    std: Tensor
    conditions: ConditionBatch
    outlines: OutlineBatch


def patch_batch(examples: Sequence[StructureExample]) -> PatchBatch:
    """Batch of the fields of examples."""
    return collate([example.field for example in examples])


def field_batch(examples: Sequence[StructureExample]) -> FieldBatch:
    """Batch of the fields and outlines of examples."""
    return FieldBatch(patches=patch_batch(examples), outlines=outline_batch(examples))


def outline_batch(examples: Sequence[StructureExample]) -> OutlineBatch:
    """Batch of the outlines of examples."""
    return gather_outlines([example.field.table for example in examples])


def condition_batch(examples: Sequence[Described], cfg: ConditionConfig) -> ConditionBatch:
    """All conditions of the examples.

    The field of a category without a token, or of a missing picture, is left open.
    """
    size = max(cfg.image_size, 1)
    pictured = [example.image is not None and cfg.image_size > 0 for example in examples]
    blank = np.zeros((size, size, 4), dtype=np.uint8)
    images = np.stack([e.image if e.image is not None and cfg.image_size > 0 else blank for e in examples])
    known = {name: index for index, name in enumerate(cfg.categories)}
    return ConditionBatch(
        category=torch.tensor([known.get(example.category, -1) for example in examples]),
        counts=torch.from_numpy(np.stack([example.counts for example in examples]).astype(np.int64)),
        size=torch.from_numpy(np.stack([example.size for example in examples])),
        has_size=torch.ones(len(examples), dtype=torch.bool),
        image=torch.from_numpy(images).permute(0, 3, 1, 2).float() / 255.0,
        has_image=torch.tensor(pictured),
        texts=tuple(None if cfg.clip is None else describe_example(example) for example in examples),
    )


def describe_example(example: Described) -> str:
    """Describes an example in a sentence."""
    return write_text(example.category, dict(zip(PART_LABELS, example.counts.tolist(), strict=True)))


def draw_batches(
    examples: Sequence[Example], make: Callable[[Sequence[Example]], Batch], size: int, seed: int
) -> Iterator[Batch]:
    """Endless batches; every epoch has a new random order."""
    rng = np.random.default_rng(seed)
    waiting: list[int] = []
    while True:
        while len(waiting) < size:
            waiting += rng.permutation(len(examples)).tolist()
        chosen, waiting = waiting[:size], waiting[size:]
        yield make([examples[index] for index in chosen])


def prefetch(batches: Iterator[Batch], depth: int = 4) -> Iterator[Batch]:
    """The same batches, up to ``depth`` of them made ahead in a thread that ends with the program."""
    ready: queue.Queue[Batch | BaseException] = queue.Queue(maxsize=depth)

    def fill() -> None:
        try:
            for batch in batches:
                ready.put(batch)
        except BaseException as error:  # raised again where the batches are read
            ready.put(error)

    threading.Thread(target=fill, daemon=True).start()
    while True:
        batch = ready.get()
        if isinstance(batch, BaseException):
            raise batch
        yield batch
