"""One training example of the structure models: a packed field and its condition.

Made of a procedural object by seed, or of a real one; the same arguments give the same example.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, UInt8

from artigen.conditioning.delivery import asset_size, part_counts
from artigen.latent.patches import PackedField, pack_asset
from artigen.shapes.asset import part_owners, shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.train.photographs import Photograph, photograph_shape
from artigen.types import Asset


@dataclass(frozen=True, kw_only=True, eq=False)
class StructureExample:
    """Field and condition of an object; ``image`` is RGBA, premultiplied on black."""

    name: str
    category: str
    field: PackedField
    counts: UInt8[np.ndarray, "L"]
    size: Float[np.ndarray, "3"]
    image: UInt8[np.ndarray, "H W 4"] | None = None


def example_of_asset(asset: Asset, photograph: Photograph | None = None) -> StructureExample:
    """The example of an asset with voxels: parts counted, extent at rest in metres."""
    voxels = asset.voxels
    if voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels; voxelize its surface first")
    return StructureExample(
        name=asset.name,
        category=asset.category,
        field=pack_asset(asset),
        counts=part_counts(asset).astype(np.uint8),
        size=asset_size(asset).astype(np.float32),
        image=None if photograph is None else photograph.rgba,
    )


def draw_example(
    category: str, seed: int, *, resolution: int = 64, image_size: int = 128
) -> StructureExample:
    """Draws a procedural object and looks at it from near its front; ``image_size`` 0 takes no picture."""
    return draw_example_of(category, seed, resolution=resolution, image_size=image_size)[1]


def draw_example_of(
    category: str, seed: int, *, resolution: int = 64, image_size: int = 128
) -> tuple[Asset, StructureExample]:
    """A procedural object with voxels, and its example as `draw_example` gives it."""
    shape = draw_shape(category, seed)
    asset = shape_to_asset(shape, resolution)
    if not image_size:
        return asset, example_of_asset(asset)
    return asset, example_of_asset(
        asset, photograph_shape(shape, seed, image_size, part_owners(shape, asset))
    )
