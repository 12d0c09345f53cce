"""One finished picture of Gaussians from plain values, for sheets, viewers and measurements."""

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import UInt8

from artigen.camera import Camera
from artigen.shapes.render.cameras import batch_cameras
from artigen.splats.render.rasterize import rasterize
from artigen.splats.render.splats import make_splats
from artigen.types import Gaussians


@torch.no_grad()
def draw_gaussians(
    gaussians: Gaussians,
    camera: Camera,
    *,
    background: Sequence[float] = (1.0, 1.0, 1.0),
) -> UInt8[np.ndarray, "H W 3"]:
    """Renders Gaussians through a pinhole camera as sRGB levels, without lighting.

    Args:
        background: sRGB in [0, 1].
    """
    splats, cameras = make_splats(gaussians), batch_cameras([camera])
    color = rasterize(splats, cameras, background=tuple(background)).color[0]
    return np.rint(255.0 * color.clamp(0.0, 1.0).numpy()).astype(np.uint8)
