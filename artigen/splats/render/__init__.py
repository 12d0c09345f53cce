"""Differentiable rendering of Gaussian splats in torch: colour, coverage, depth.

    splats = make_splats(asset.gaussians)
    pictures = rasterize(splats, cameras, cfg=RasterConfig())

The cameras are those of the analytic renderer, so that both see the same object from the same place.
"""

from artigen.shapes.render.cameras import Cameras, batch_cameras
from artigen.splats.render.config import RasterConfig
from artigen.splats.render.motion import move_splats
from artigen.splats.render.rasterize import rasterize
from artigen.splats.render.splats import Rendering, Splats, make_splats

__all__ = [
    "Cameras",
    "RasterConfig",
    "Rendering",
    "Splats",
    "batch_cameras",
    "make_splats",
    "move_splats",
    "rasterize",
]
