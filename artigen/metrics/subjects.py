"""Objects for evaluation: procedural ones by seed, real ones from a PartNet-Mobility folder.

The training objects of a run are a pure function of their seeds, so they can be drawn again anywhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from tqdm import trange

from artigen.examples.real import Split, read_reals
from artigen.examples.structure import StructureExample, draw_example
from artigen.models.conditions import StructureCondition
from artigen.types import PART_LABELS, Asset

Field = Literal["category", "counts", "size", "image"]
"""Fields of a condition."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Subject:
    """An object with voxels, and its training example."""

    asset: Asset
    example: StructureExample


def draw_subjects(
    categories: Sequence[str], first_seed: int, count: int, *, resolution: int, image_size: int
) -> list[Subject]:
    """Procedural objects in the order of `artigen.examples.shards`: categories in turn, seeds upwards."""
    out = []
    for number in trange(count, desc="objects", disable=None):
        category = categories[number % len(categories)]
        seed = first_seed + number // len(categories)
        asset, example = draw_example(category, seed, resolution=resolution, image_size=image_size)
        out.append(Subject(asset=asset, example=example))
    return out


def read_subjects(
    folder: Path, split: Split, resolution: int, *, image_size: int, workers: int
) -> tuple[list[Subject], dict[str, str]]:
    """Real objects of a split in order, and the reasons why others are left out, by id.

    Raises:
        SourceError: If there is no such split, or none of its objects can be read.
    """
    found, left_out = read_reals(folder, split, resolution, image_size=image_size, workers=workers)
    return [Subject(asset=asset, example=example) for asset, example in found], left_out


def describe_subject(subject: Subject, fields: Sequence[Field]) -> StructureCondition:
    """The condition that a subject meets, with only the given fields.

    Counts cover every label, so that any additional part violates the condition.
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
