"""One training example of the appearance models: voxels with features, pictures, and its condition.

Made of a procedural object by seed; the same arguments give the same example.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.fields import DEFAULT_LAYOUT, after_occupancy, part_attributes
from artigen.models.features import FeatureExtractor
from artigen.shapes.draw import draw_shape
from artigen.train.appearance.curation import CurationConfig, curate
from artigen.train.appearance.photographs import Pictures
from artigen.train.examples import draw_example_of
from artigen.types import Asset


@dataclass(frozen=True, kw_only=True, eq=False)
class AppearanceExample:
    """An object's voxels with features, its pictures, and its condition; ``image`` is RGBA, premultiplied.

    ``table`` holds the field's channels after occupancy of each part; ``views`` counts the views that a
    voxel's features are the mean of.
    """

    name: str
    category: str
    resolution: int
    coords: UInt8[np.ndarray, "N 3"]
    part_ids: UInt8[np.ndarray, "N"]
    features: Float[np.ndarray, "N C"]
    views: Int[np.ndarray, "N"]
    table: Float[np.ndarray, "P K"]
    pictures: Pictures
    counts: UInt8[np.ndarray, "L"]
    size: Float[np.ndarray, "3"]
    image: UInt8[np.ndarray, "H W 4"] | None = None

    def labels(self) -> Float[np.ndarray, "N L"]:
        """One-hot part label of every voxel."""
        channels = DEFAULT_LAYOUT.label
        return self.table[:, after_occupancy(channels)][self.part_ids].astype(np.float32)


def draw_appearance(
    category: str,
    seed: int,
    extractor: FeatureExtractor,
    cfg: CurationConfig,
    *,
    resolution: int = 64,
    image_size: int = 128,
) -> AppearanceExample:
    """Draws a procedural object and photographs it; ``image_size`` 0 leaves the condition's picture out."""
    return draw_appearance_of(category, seed, extractor, cfg, resolution=resolution, image_size=image_size)[1]


def draw_appearance_of(
    category: str,
    seed: int,
    extractor: FeatureExtractor,
    cfg: CurationConfig,
    *,
    resolution: int = 64,
    image_size: int = 128,
) -> tuple[Asset, AppearanceExample]:
    """A procedural object with voxels, and its example as `draw_appearance` gives it."""
    asset, described = draw_example_of(category, seed, resolution=resolution, image_size=image_size)
    assert asset.voxels is not None
    features, pictures = curate(draw_shape(category, seed), asset, extractor, cfg)
    rows = np.stack([part_attributes(part, asset.category) for part in asset.parts])
    return asset, AppearanceExample(
        name=asset.name,
        category=asset.category,
        resolution=resolution,
        coords=asset.voxels.coords.astype(np.uint8),
        part_ids=asset.voxels.part_ids.astype(np.uint8),
        features=features.values.astype(np.float16),
        views=features.views.astype(np.uint16),
        table=rows[:, 1:].astype(np.float32),
        pictures=pictures,
        counts=described.counts,
        size=described.size,
        image=described.image,
    )
