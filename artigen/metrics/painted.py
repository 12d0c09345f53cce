"""Evaluates what the sparse flow draws on true voxels with true paint."""

import numpy as np

from artigen.appearance.draw import AppearanceConfig, AppearanceModel, draw_splats
from artigen.models.conditions import StructureCondition
from artigen.shapes.draw import draw_shape
from artigen.splats.render.splats import Splats
from artigen.train.appearance.examples import AppearanceExample, lay_true_voxels
from artigen.types import Asset
from artigen.voxels.layout import Canvas
from artigen.voxels.surface import measure_places


def draw_painted(
    model: AppearanceModel, asset: Asset, example: AppearanceExample, cfg: AppearanceConfig, seed: int
) -> Splats:
    """The Gaussians that a flow draws for a held-out object, of which nothing else is asked.

    Args:
        model: Trained networks, told paint.
        asset: The object, with voxels.
        example: The same, with the paint of its voxels.
        cfg: Sampler.
        seed: Of the noise.
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
    return draw_splats(model, canvas, StructureCondition(), seed, cfg, paint=paint)
