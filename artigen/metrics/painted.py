"""Samples the sparse flow on true voxels with true paint, for evaluation."""

import numpy as np

from artigen.appearance.draw import AppearanceModel, draw_splats
from artigen.examples.appearance import AppearanceExample, lay_true_voxels
from artigen.models.conditions import StructureCondition
from artigen.models.rectified_flow import SamplerConfig
from artigen.shapes.draw import draw_shape
from artigen.splats.render.splats import Splats
from artigen.types import Asset
from artigen.voxels.layout import Canvas
from artigen.voxels.surface import measure_places


def draw_painted(
    model: AppearanceModel, asset: Asset, example: AppearanceExample, sampler: SamplerConfig | None, seed: int
) -> Splats:
    """Gaussians that a flow samples for a held-out object, without any other condition.

    Args:
        model: Trained networks that take paint.
        asset: The object, with voxels.
        example: The same object, with the paint of its voxels.
        sampler: Steps and guidance; those of the model's preset when None.
        seed: Seed of the noise.
    """
    category, number = asset.name.rsplit("_", 1)
    laid, facings = lay_true_voxels(draw_shape(category, int(number)), asset)
    assert laid.voxels is not None
    assert laid.surface is not None
    canvas = Canvas(
        coords=laid.voxels.coords,
        part_ids=laid.voxels.part_ids,
        facings=facings,
        table=example.table,
        places=measure_places(laid.surface, laid.voxels, facings),
    )
    paint = (example.paint / 255.0).astype(np.float32)
    return draw_splats(model, canvas, StructureCondition(), seed, paint=paint, sampler=sampler)
