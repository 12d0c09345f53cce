"""A chest with one drawer, all of one colour without gloss, for tests of appearance."""

import numpy as np

from artigen.appearance.curation import CurationConfig, curate
from artigen.appearance.features import PyramidFeatures
from artigen.appearance.paint import lay_painted
from artigen.appearance.views import ViewConfig
from artigen.examples.appearance import AppearanceExample
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.fittings.hardware import slide
from artigen.shapes.primitives import box
from artigen.shapes.render import RenderConfig
from artigen.shapes.shape import Need, Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.types import Asset

COLOR = (0.7, 0.4, 0.2)
PLAIN = Finish(kind="lacquer", color=COLOR, accent=COLOR, gloss=0.0)
INSIDE = Finish(kind="lacquer", color=(0.1, 0.3, 0.8), accent=(0.1, 0.3, 0.8), gloss=0.0)
GLASS = Finish(kind="glass", color=(1.0, 1.0, 1.0), accent=(1.0, 1.0, 1.0), gloss=0.0, opacity=0.1)
LIGHT = RenderConfig(
    shadow_rays=0,
    openness=False,
    lamp_strength=0.0,
    sky_strength=0.0,
    fill_strength=0.8,
    fill_tilt=0.0,
)
"""A surface without gloss shows its own colour in it."""


def make_chest(*, inside: str = "plain", front: str = "plain") -> Shape:
    """One metre each way; the drawer fills it and slides out to the front by 0.7 m."""
    outside = [
        box((-0.5, -0.5, 0.94), (0.5, 0.5, 1.0), "plain"),
        box((-0.5, -0.5, 0.0), (0.5, 0.5, 0.06), "plain"),
        box((-0.5, -0.5, 0.06), (0.5, -0.44, 0.94), "plain"),
        box((-0.5, 0.44, 0.06), (0.5, 0.5, 0.94), "plain"),
        box((0.44, -0.44, 0.06), (0.5, 0.44, 0.94), "plain"),
    ]
    drawer = [
        box((-0.5, -0.439, 0.061), (-0.44, 0.439, 0.939), front),
        box((-0.44, -0.42, 0.08), (0.4, 0.42, 0.14), inside),
        box((-0.44, -0.42, 0.14), (0.4, -0.36, 0.3), inside),
        box((-0.44, 0.36, 0.14), (0.4, 0.42, 0.3), inside),
        box((0.34, -0.36, 0.14), (0.4, 0.36, 0.3), inside),
    ]
    return Shape(
        category="Chest",
        seed=0,
        style="plain",
        parts=(
            ShapePart(name="body", label="base", parent=None, primitives=tuple(outside)),
            ShapePart(
                name="drawer",
                label="drawer",
                parent="body",
                primitives=tuple(drawer),
                joint=slide(0.7),
            ),
        ),
        finishes=(("plain", PLAIN), ("inside", INSIDE), ("glass", GLASS)),
    )


def make_cabinet() -> Shape:
    """A door, a drawer that needs it, and two free drawers."""
    chest = make_chest()
    names = ("door", "inner", "upper", "lower")
    parts = [
        ShapePart(
            name=name,
            label="drawer",
            parent="body",
            primitives=(box((-0.5, -0.4, 0.1 + 0.2 * row), (-0.44, 0.4, 0.2 + 0.2 * row), "plain"),),
            joint=slide(0.5),
            needs=(Need(part="door"),) if name == "inner" else (),
        )
        for row, name in enumerate(names)
    ]
    return Shape(
        category="Cabinet", seed=0, style="plain", parts=(chest.parts[0], *parts), finishes=chest.finishes
    )


def small_curation(**changes) -> CurationConfig:
    """Few and small pictures in light that shows colours as they are."""
    views = ViewConfig(count=changes.pop("views", 12), size=changes.pop("size", 32), light=LIGHT)
    return CurationConfig(**{"states": 2, "views": views, "kept": 4, **changes})


def make_example(shape: Shape, resolution: int = 16, **changes) -> tuple[Asset, AppearanceExample]:
    """An asset, and its example with pyramid features."""
    asset, facings, paint = lay_painted(shape, shape_to_asset(shape, resolution))
    assert asset.voxels is not None
    features, pictures = curate(shape, asset, facings, PyramidFeatures(), small_curation(**changes), paint)
    labels = np.zeros((len(asset.parts), 35 - 1), dtype=np.float32)
    labels[:, 0] = 1.0
    return asset, AppearanceExample(
        name=asset.name,
        category="StorageFurniture",
        resolution=resolution,
        coords=asset.voxels.coords.astype(np.uint8),
        part_ids=asset.voxels.part_ids.astype(np.uint8),
        facings=facings.astype(np.uint8),
        paint=paint.packed(),
        features=features.values.astype(np.float16),
        views=features.views.astype(np.uint16),
        table=labels,
        pictures=pictures,
        counts=np.zeros(8, dtype=np.uint8),
        size=np.ones(3, dtype=np.float32),
    )
