"""Pictures in catalogue light: a white studio with soft boxes."""

# mitsuba has incomplete type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import UInt8

from artigen.camera import Camera
from artigen.splats.colors import srgb_from_linear
from sim_export.picture.raycast import Surface
from sim_export.picture.render import surface_points
from sim_export.picture.tracing import TraceConfig, require_mitsuba, trace

BOXES = (
    ((-1.5, 1.5, 2.1), 1.0, 3.4),
    ((-1.2, -1.9, 1.2), 0.8, 1.1),
    ((1.6, 0.3, 2.4), 0.8, 1.8),
)
"""Soft boxes around an object of unit extent: place of the middle, half the edge, and radiance."""
LEAST_SHARE = 0.8
"""Least extent that soft boxes are placed for, as a share of what the picture shows: they stay out of it."""
STUDIO = 0.5
"""Radiance of the walls."""
FLOOR = 0.86
"""Reflectance of the floor."""


def render_catalogue(
    surfaces: Sequence[Surface], camera: Camera, ground: float, cfg: TraceConfig | None = None
) -> UInt8[np.ndarray, "H W 3"]:
    """A picture of surfaces (m) on a floor at height ``ground``, sRGB.

    Raises:
        PackageError: If Mitsuba is not installed.
    """
    mitsuba = require_mitsuba()
    points = surface_points(surfaces)
    middle, extent = (points.min(axis=0) + points.max(axis=0)) / 2, float(np.ptp(points, axis=0).max())
    shown = camera.pixel * max(camera.width, camera.height) * float(np.linalg.norm(camera.position - middle))
    extent = max(extent, LEAST_SHARE * shown)
    lights: dict[str, Any] = {
        "walls": {"type": "constant", "radiance": STUDIO},
        "floor": _floor(mitsuba, middle, ground, extent),
    }
    for number, (place, half, bright) in enumerate(BOXES):
        at = middle + extent * np.array(place)
        lights[f"box_{number}"] = _soft_box(mitsuba, at, middle, half * extent, bright)
    image = trace(surfaces, camera, lights, cfg)
    seen = np.clip(srgb_from_linear(np.minimum(image, 1.0)), 0.0, 1.0)
    return np.rint(255.0 * seen).astype(np.uint8)


def _floor(mitsuba: Any, middle: np.ndarray, ground: float, extent: float) -> dict[str, Any]:
    place = mitsuba.ScalarTransform4f().translate([float(middle[0]), float(middle[1]), ground])
    return {
        "type": "rectangle",
        "to_world": place.scale(60 * extent),
        "look": {"type": "diffuse", "reflectance": FLOOR},
    }


def _soft_box(
    mitsuba: Any, place: np.ndarray, target: np.ndarray, half: float, bright: float
) -> dict[str, Any]:
    pose = mitsuba.ScalarTransform4f().look_at(place.tolist(), target.tolist(), [0.0, 0.0, 1.0])
    return {
        "type": "rectangle",
        "to_world": pose.scale(half),
        "light": {"type": "area", "radiance": bright},
    }
