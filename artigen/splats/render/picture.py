"""One finished picture of Gaussians from plain values, for sheets, viewers and measurements."""

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import Float, UInt8

from artigen.shapes.render.cameras import Cameras
from artigen.splats.render.config import RasterConfig
from artigen.splats.render.rasterize import rasterize
from artigen.splats.render.splats import make_splats
from artigen.types import Gaussians


@torch.no_grad()
def draw_gaussians(
    gaussians: Gaussians,
    position: Float[np.ndarray, "3"],
    target: Float[np.ndarray, "3"],
    *,
    fov: float,
    size: tuple[int, int],
    background: Sequence[float] = (1.0, 1.0, 1.0),
    cfg: RasterConfig | None = None,
) -> UInt8[np.ndarray, "H W 3"]:
    """Renders Gaussians through a pinhole camera as sRGB levels, without lighting.

    Args:
        fov: Vertical angle of view in degrees.
        size: Width and height in pixels.
        background: sRGB in [0, 1].
    """
    camera = Cameras(
        position=torch.tensor(position[None], dtype=torch.float64),
        target=torch.tensor(target[None], dtype=torch.float64),
        fov=torch.tensor([fov], dtype=torch.float64),
        width=size[0],
        height=size[1],
    )
    color = rasterize(make_splats(gaussians), camera, background=tuple(background), cfg=cfg).color[0]
    return np.rint(255.0 * color.clamp(0.0, 1.0).numpy()).astype(np.uint8)
