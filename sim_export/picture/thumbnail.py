"""Thumbnails: a package closed and open, side by side, without text."""

import io

import numpy as np
from jaxtyping import UInt8

from sim_export.package import SimPackage
from sim_export.picture.camera import Viewpoint
from sim_export.picture.preview import Panel, PreviewConfig, draw_panel, frame_shapes, prepare_shapes

QUALITY = 80
"""WebP quality."""
PANELS: tuple[Panel, ...] = ("closed", "open")


def draw_thumbnail(package: SimPackage, size: int = 192) -> UInt8[np.ndarray, "H W 3"]:
    """The closed object beside the open one, each ``size`` x ``size`` pixels, with one camera.

    Raises:
        ValueError: If the package has nothing to draw.
    """
    cfg = PreviewConfig(panels=PANELS, viewpoint=Viewpoint(width=size, height=size))
    shapes = prepare_shapes(package, cfg)
    camera = frame_shapes(shapes, cfg, PANELS)
    return np.concatenate([draw_panel(shapes, panel, camera, cfg) for panel in PANELS], axis=1)


def webp_bytes(image: UInt8[np.ndarray, "H W 3"]) -> bytes:
    """Encodes the image as WebP; deterministic."""
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(image).save(stream, "WEBP", quality=QUALITY, method=4)
    return stream.getvalue()
