"""Examples of the appearance models, each voxels with features, pictures and its condition; shards of them.

They are made from procedural objects by seed; the same arguments give the same example.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.appearance.attributes import describe_voxels, read_kinds
from artigen.appearance.curation import CurationConfig, curate
from artigen.appearance.extractors import ExtractorConfig, make_extractor
from artigen.appearance.features import FeatureExtractor
from artigen.appearance.paint import lay_painted
from artigen.appearance.photographs import Pictures
from artigen.appearance.sides import recall_places
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
from artigen.examples.structure import draw_example
from artigen.shapes.asset import part_owners
from artigen.shapes.draw import draw_shape
from artigen.shapes.sampling import sample_shape
from artigen.shapes.shape import Shape
from artigen.types import Asset, SurfaceSamples

PER_VOXEL = ("coords", "part_ids", "facings", "paint", "features", "views")
PER_PICTURE = tuple(one.name for one in fields(Pictures) if one.name != "displacements")
PACKED = ("exposed",)
"""Arrays stored as bits."""
ARRAYS = (
    *CONDITION,
    *("resolution", "voxel_counts", "part_counts", "displacements", "table"),
    *PER_VOXEL,
    *PER_PICTURE,
)


@dataclass(frozen=True, kw_only=True, eq=False)
class AppearanceExample:
    """An object's voxels with features, its pictures, and its condition; ``image`` is RGBA, premultiplied.

    ``facings`` are the directions of the voxels' outer sides (`artigen.voxels.frames`), ``table`` holds the
    field's channels after occupancy of each part, ``views`` the number of views over which a voxel's features
    are averaged, ``paint`` the colours of its two sides and its transmission (8 bits each).
    """

    name: str
    category: str
    resolution: int
    coords: UInt8[np.ndarray, "N 3"]
    part_ids: UInt8[np.ndarray, "N"]
    facings: UInt8[np.ndarray, "N"]
    paint: UInt8[np.ndarray, "N 7"]
    features: Float[np.ndarray, "N C"]
    views: Int[np.ndarray, "N"]
    table: Float[np.ndarray, "P K"]
    pictures: Pictures
    counts: UInt8[np.ndarray, "L"]
    size: Float[np.ndarray, "3"]
    image: UInt8[np.ndarray, "H W 4"] | None = None

    def attributes(self) -> Float[np.ndarray, "N A"]:
        """Conditioning features of every voxel."""
        kinds = read_kinds(self.coords, self.part_ids, self.facings, self.table, self.resolution)
        return describe_voxels(kinds, self.places(), self.paint / 255.0)

    def places(self) -> Float[np.ndarray, "N 6"]:
        """Surface positions (`artigen.voxels.surface.describe_places`), read from the side features."""
        return recall_places(self.features.astype(np.float32))


def draw_appearance(
    category: str,
    seed: int,
    extractor: FeatureExtractor,
    cfg: CurationConfig,
    *,
    resolution: int,
    image_size: int,
) -> tuple[Asset, AppearanceExample]:
    """A procedural object with voxels, and its example; ``image_size`` 0 skips the condition's picture."""
    asset, described = draw_example(category, seed, resolution=resolution, image_size=image_size)
    shape = draw_shape(category, seed)
    laid, facings, paint = lay_painted(shape, asset)
    assert laid.voxels is not None
    features, pictures = curate(shape, laid, facings, extractor, cfg, paint)
    return asset, AppearanceExample(
        name=asset.name,
        category=asset.category,
        resolution=resolution,
        coords=laid.voxels.coords.astype(np.uint8),
        part_ids=laid.voxels.part_ids.astype(np.uint8),
        facings=facings.astype(np.uint8),
        paint=paint.packed(),
        features=features.values.astype(np.float16),
        views=features.views.astype(np.uint16),
        table=described.field.table,
        pictures=pictures,
        counts=described.counts,
        size=described.size,
        image=described.image,
    )


def sample_parts(shape: Shape, asset: Asset, spacing: float) -> SurfaceSamples:
    """Samples of the surface, ``spacing`` apart (unit-cube length), with their parts of the asset."""
    surface = sample_shape(shape, spacing * asset.scale)
    return replace(surface, part_ids=part_owners(shape, asset)[surface.part_ids])


@dataclass(frozen=True, kw_only=True)
class AppearanceShardConfig(ShardConfig):
    """Configuration of the examples of a folder."""

    curation: CurationConfig
    """Joint states, views, and features."""
    extractor: ExtractorConfig = field(default_factory=ExtractorConfig)
    """Extractor of image features."""
    objects: int = 16
    """Objects per shard."""
    timeout: float = 3600.0
    """Seconds after which a shard counts as failed."""


def make_appearance_shard(job: ShardJob[AppearanceShardConfig]) -> Path:
    """Draws and renders the objects of one shard and writes it; runs in a worker process."""
    cfg = job.cfg
    extractor = make_extractor(cfg.extractor)

    def draw(category: str, seed: int) -> AppearanceExample:
        return draw_appearance(
            category, seed, extractor, cfg.curation, resolution=cfg.resolution, image_size=cfg.image_size
        )[1]

    return draw_shard(job, draw, write_appearance_shard)


def write_appearance_shard(path: Path, examples: Sequence[AppearanceExample]) -> None:
    """Writes examples, all with equally many pictures and states, to one npz file, whole or not at all."""
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
    arrays = load_shard(path, ARRAYS)
    width = arrays["rgb"].shape[-2]
    for name in PACKED:
        arrays[name] = np.unpackbits(arrays[name], axis=-1, count=width).astype(bool)
    fields = {name: split_rows(arrays[name], arrays["voxel_counts"]) for name in PER_VOXEL}
    fields["table"] = split_rows(arrays["table"], arrays["part_counts"])
    moves = split_rows(arrays["displacements"], arrays["part_counts"], axis=1)
    for number, resolution in enumerate(arrays["resolution"].tolist()):
        shown = {name: arrays[name][number] for name in PER_PICTURE}
        yield AppearanceExample(
            resolution=resolution,
            pictures=Pictures(displacements=moves[number], **shown),
            **{name: values[number] for name, values in fields.items()},
            **pick_condition(arrays, number),
        )
