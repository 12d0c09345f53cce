"""Objects for evaluation: procedural ones by seed, real ones from a PartNet-Mobility folder.

The training objects of a run are a pure function of their seeds, so they can be drawn again anywhere.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from artigen.models.conditions import StructureCondition
from artigen.train.examples import StructureExample, draw_example_of
from artigen.train.real import Split, read_reals
from artigen.types import PART_LABELS, Asset

Field = Literal["category", "counts", "size", "image"]
"""What a condition may say."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Subject:
    """An object with voxels, and what training would be told about it."""

    asset: Asset
    example: StructureExample


def draw_subjects(
    categories: Sequence[str],
    first_seed: int,
    count: int,
    *,
    resolution: int,
    image_size: int,
    on_done: Callable[[], None] | None = None,
) -> list[Subject]:
    """Procedural objects in the order of `artigen.train.shards`: categories in turn, seeds upwards."""
    out = []
    for number in range(count):
        category = categories[number % len(categories)]
        seed = first_seed + number // len(categories)
        asset, example = draw_example_of(category, seed, resolution=resolution, image_size=image_size)
        out.append(Subject(asset=asset, example=example))
        if on_done is not None:
            on_done()
    return out


def read_subjects(
    folder: Path,
    split: Split,
    resolution: int,
    *,
    image_size: int,
    workers: int,
    on_done: Callable[[], None] | None = None,
) -> tuple[list[Subject], dict[str, str]]:
    """Real objects of a split in order, and why others are left out, by id.

    Raises:
        SourceError: If there is no such split, or none of its objects can be read.
    """
    found, left_out = read_reals(
        folder, split, resolution, image_size=image_size, workers=workers, on_done=on_done
    )
    return [Subject(asset=asset, example=example) for asset, example in found], left_out


def describe_subject(subject: Subject, fields: Sequence[Field]) -> StructureCondition:
    """The condition that a subject meets, with only the given fields.

    Counts are those of every label, so that a part of another kind is one too many.
    """
    example = subject.example
    image = None
    if "image" in fields and example.image is not None:
        image = example.image.transpose(2, 0, 1).astype("float32") / 255.0
    depth, width, height = example.size.tolist()
    return StructureCondition(
        category=example.category if "category" in fields else None,
        counts=tuple(zip(PART_LABELS, example.counts.tolist(), strict=True)) if "counts" in fields else (),
        size=(depth, width, height) if "size" in fields else None,
        image=image,
    )
