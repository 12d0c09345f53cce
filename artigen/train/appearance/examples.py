"""One training example of the appearance models: voxels with features, pictures, and its condition.

Made of a procedural object by seed; the same arguments give the same example.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.appearance.attributes import describe_voxels, read_kinds
from artigen.appearance.curation import CurationConfig, curate
from artigen.appearance.features import FeatureExtractor
from artigen.appearance.paint import lay_painted
from artigen.appearance.photographs import Pictures
from artigen.appearance.sides import recall_places
from artigen.shapes.asset import part_owners
from artigen.shapes.draw import draw_shape
from artigen.shapes.sampling import sample_shape
from artigen.shapes.shape import Shape
from artigen.train.examples import draw_example_of
from artigen.types import Asset, SurfaceSamples


@dataclass(frozen=True, kw_only=True, eq=False)
class AppearanceExample:
    """An object's voxels with features, its pictures, and its condition; ``image`` is RGBA, premultiplied.

    ``facings`` are the directions of the voxels' outer sides (`artigen.voxels.frames`), ``table`` holds the
    field's channels after occupancy of each part; ``views`` counts the views that a voxel's features are the
    mean of, ``paint`` holds the colours of its two sides and how clear it is (steps of 8 bits).
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
        """Where surface lies in its voxels (`artigen.voxels.surface.describe_places`), off side features."""
        return recall_places(self.features.astype(np.float32))


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


def lay_true_voxels(shape: Shape, asset: Asset) -> tuple[Asset, Int[np.ndarray, "N"]]:
    """The asset of a procedural object with samples of its surface and the voxels that Gaussians are drawn on
    (`artigen.voxels.layout`), and the directions of their outer sides.

    Raises:
        ValueError: If the asset has no voxels.
    """
    laid, facings, _ = lay_painted(shape, asset)
    return laid, facings


def sample_parts(shape: Shape, asset: Asset, spacing: float) -> SurfaceSamples:
    """Samples of the surface, ``spacing`` apart (unit-cube length), with their parts of the asset."""
    surface = sample_shape(shape, spacing * asset.scale)
    return replace(surface, part_ids=part_owners(shape, asset)[surface.part_ids])
