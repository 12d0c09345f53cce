"""Examples of the structure models, each a packed field and its condition, and shards of them.

They are made from procedural objects by seed, or from real ones; the same arguments give the same example.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8

from artigen.conditioning.delivery import asset_size, part_counts
from artigen.examples.photographs import photograph_shape
from artigen.examples.shards import (
    CONDITION,
    ShardConfig,
    ShardJob,
    condition_arrays,
    draw_shard,
    load_shard,
    pick_condition,
    save_shard,
    split_rows,
)
from artigen.latent.patches import PackedField, pack_asset
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import Asset

PER_PATCH = ("index", "rows")
ARRAYS = (*CONDITION, "resolution", "patches", "parts", *PER_PATCH, "table")


@dataclass(frozen=True, kw_only=True, eq=False)
class StructureExample:
    """Field and condition of an object; ``image`` is RGBA, premultiplied on black."""

    name: str
    category: str
    field: PackedField
    counts: UInt8[np.ndarray, "L"]
    size: Float[np.ndarray, "3"]
    image: UInt8[np.ndarray, "H W 4"] | None = None


def example_of_asset(asset: Asset, image: UInt8[np.ndarray, "H W 4"] | None = None) -> StructureExample:
    """The example of an asset with voxels: its field, part counts, and extent at rest in metres."""
    voxels = asset.voxels
    if voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels; voxelize its surface first")
    return StructureExample(
        name=asset.name,
        category=asset.category,
        field=pack_asset(asset),
        counts=part_counts(asset).astype(np.uint8),
        size=asset_size(asset).astype(np.float32),
        image=image,
    )


def draw_example(
    category: str, seed: int, *, resolution: int, image_size: int
) -> tuple[Asset, StructureExample]:
    """A procedural object with voxels, and its example, rendered from near its front.

    Args:
        image_size: Edge of the picture in pixels; 0 for none.
    """
    shape = draw_shape(category, seed)
    asset = shape_to_asset(shape, resolution)
    return asset, example_of_asset(asset, photograph_shape(shape, seed, image_size) if image_size else None)


def make_shard(job: ShardJob[ShardConfig]) -> Path:
    """Draws the objects of one shard and writes it; runs in a worker process."""
    cfg = job.cfg

    def draw(category: str, seed: int) -> StructureExample:
        return draw_example(category, seed, resolution=cfg.resolution, image_size=cfg.image_size)[1]

    return draw_shard(job, draw, write_shard)


def write_shard(path: Path, examples: Sequence[StructureExample]) -> None:
    """Writes examples to one npz file, whole or not at all."""
    arrays = condition_arrays(examples) | {
        "resolution": np.array([one.field.resolution for one in examples]),
        "patches": np.array([len(one.field.index) for one in examples]),
        "parts": np.array([len(one.field.table) for one in examples]),
    }
    for name in (*PER_PATCH, "table"):
        arrays[name] = np.concatenate([getattr(one.field, name) for one in examples])
    save_shard(path, arrays, packed=False)


def read_shard(path: Path) -> Iterator[StructureExample]:
    """The examples of a shard.

    Raises:
        SourceError: If the file is damaged or no shard.
    """
    arrays = load_shard(path, ARRAYS)
    fields = {name: split_rows(arrays[name], arrays["patches"]) for name in PER_PATCH}
    fields["table"] = split_rows(arrays["table"], arrays["parts"])
    for number, resolution in enumerate(arrays["resolution"].tolist()):
        rows = {name: values[number] for name, values in fields.items()}
        yield StructureExample(
            field=PackedField(resolution=resolution, **rows), **pick_condition(arrays, number)
        )
