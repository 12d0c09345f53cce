"""One training example of the structure models: a packed field and the condition it answers.

Made of a procedural object by seed, or of a real one; the same arguments give the same example.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, UInt8

from artigen.metrics.delivery import asset_size, part_counts
from artigen.models.patches import PackedField, pack_asset
from artigen.types import Asset

NEAR_FRONT = (0.6, 0.25)
"""Largest turn to either side and largest lift of the camera (radians): pictures are near-frontal."""


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
        image=image,
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
    from artigen.shapes.asset import shape_to_asset
    from artigen.shapes.draw import draw_shape

    shape = draw_shape(category, seed)
    image = _photograph(shape, seed, image_size) if image_size else None
    asset = shape_to_asset(shape, resolution)
    return asset, example_of_asset(asset, image)


def _photograph(shape, seed: int, size: int) -> UInt8[np.ndarray, "H W 4"]:
    from artigen.shapes.primitives import place_vertices
    from artigen.shapes.render import build_scene, frame_points, render

    rng = np.random.default_rng([seed, 1])
    turn, lift = rng.uniform(-NEAR_FRONT[0], NEAR_FRONT[0]), rng.uniform(0.0, NEAR_FRONT[1])
    direction = (-np.cos(turn) * np.cos(lift), float(np.sin(turn) * np.cos(lift)), float(np.sin(lift)))
    points = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
    camera = frame_points(points, (float(direction[0]), *direction[1:]), width=size, height=size)
    seen = render(build_scene([shape]), camera, [np.zeros(len(shape.parts))])
    alpha = seen.mask[0].numpy()
    rgb = seen.rgb[0].numpy() * alpha[..., None]
    return np.round(255 * np.concatenate([rgb, alpha[..., None]], axis=2)).astype(np.uint8)
