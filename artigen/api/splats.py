"""Renders the Gaussians of packages: the renderer of `artigen.splats` for the pictures of `sim_export`."""

import numpy as np
from jaxtyping import UInt8

from artigen.camera import Camera
from artigen.types import Gaussians


def draw_splats(
    gaussians: Gaussians, camera: Camera, background: tuple[int, int, int]
) -> UInt8[np.ndarray, "H W 3"]:
    """Renders Gaussians (metres) with a preview camera."""
    from artigen.splats.render.picture import draw_gaussians

    return draw_gaussians(gaussians, camera, background=[level / 255.0 for level in background])
