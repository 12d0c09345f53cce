"""Examples of the appearance models on disk: shards written by worker processes.

A shard appears whole or not at all, so a run that was stopped goes on where it was.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from pathlib import Path

import numpy as np

from artigen.appearance.curation import CurationConfig
from artigen.appearance.extractors import ExtractorConfig, make_extractor
from artigen.appearance.photographs import Pictures
from artigen.io import read_arrays
from artigen.train.appearance.examples import AppearanceExample, draw_appearance
from artigen.train.shards import (
    ShardConfig,
    ShardJob,
    condition_arrays,
    draw_shard,
    pick_condition,
    save_shard,
)

PER_VOXEL = ("coords", "part_ids", "facings", "paint", "features", "views")
PER_PICTURE = tuple(one.name for one in fields(Pictures) if one.name != "displacements")
PACKED = ("exposed",)
"""Stored as bits."""


@dataclass(frozen=True, kw_only=True)
class AppearanceShardConfig(ShardConfig):
    """Configuration of the examples of a folder."""

    curation: CurationConfig
    """Joint states, views, and features."""
    extractor: ExtractorConfig = field(default_factory=ExtractorConfig)
    """Where features come from."""
    objects: int = 16
    """Objects per shard."""
    timeout: float = 3600.0
    """Seconds after which a shard is given up."""


def make_appearance_shard(job: ShardJob[AppearanceShardConfig]) -> Path:
    """Draws and photographs the objects of one shard and writes it; runs in a worker process."""
    cfg = job.cfg
    extractor = make_extractor(cfg.extractor)
    draw = partial(
        draw_appearance,
        extractor=extractor,
        cfg=cfg.curation,
        resolution=cfg.resolution,
        image_size=cfg.image_size,
    )
    return draw_shard(job, draw, write_appearance_shard)


def write_appearance_shard(path: Path, examples: Sequence[AppearanceExample]) -> None:
    """Writes examples, all with as many pictures and states, to one npz file, whole or not at all."""
    arrays = condition_arrays(examples) | {
        "resolution": np.array([one.resolution for one in examples]),
        "voxel_counts": np.array([len(one.coords) for one in examples]),
        "part_counts": np.array([len(one.table) for one in examples]),
        "displacements": np.concatenate([one.pictures.displacements for one in examples], axis=1),
    }
    for name in (*PER_VOXEL, "table"):
        arrays[name] = np.concatenate([getattr(one, name) for one in examples])
    for name in PER_PICTURE:
        values = np.stack([getattr(one.pictures, name) for one in examples])
        arrays[name] = np.packbits(values, axis=-1) if name in PACKED else values
    save_shard(path, arrays, packed=True)


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
    for number in range(len(arrays["names"])):
        at = slice(voxel_ends[number] - arrays["voxel_counts"][number], voxel_ends[number])
        of = slice(part_ends[number] - arrays["part_counts"][number], part_ends[number])
        yield AppearanceExample(
            resolution=int(arrays["resolution"][number]),
            pictures=Pictures(
                displacements=arrays["displacements"][:, of],
                **{key: arrays[key][number] for key in PER_PICTURE},
            ),
            **{key: arrays[key][at] for key in PER_VOXEL},
            table=arrays["table"][of],
            **pick_condition(arrays, number),
        )
