"""Positions of cameras around objects, without distances."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.camera import Camera, frame_points


@dataclass(frozen=True, kw_only=True)
class Viewpoint:
    """Position of a camera around an object, without its distance."""

    azimuth: float = 30.0
    """Degrees around z: 0 stands in front (at -x), positive moves to the viewer's left (towards +y)."""
    elevation: float = 22.0
    """Degrees above the horizon, below 90."""
    fov: float = 24.0
    """Vertical angle of view in degrees; small angles approximate a parallel projection."""
    margin: float = 0.06
    """Free border, as a fraction of the image on each side."""
    width: int = 384
    """Pixels per row."""
    height: int = 384
    """Number of rows."""


def view_direction(viewpoint: Viewpoint) -> Float[np.ndarray, "3"]:
    """Unit vector from the object to the camera."""
    azimuth, elevation = np.radians(viewpoint.azimuth), np.radians(viewpoint.elevation)
    return np.array(
        [-np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )


def place_camera(points: Float[np.ndarray, "N 3"], viewpoint: Viewpoint) -> Camera:
    """The nearest camera at a viewpoint that has every point inside the margins.

    Raises:
        ValueError: If there are no points, or the margin leaves no picture.
    """
    return frame_points(
        points,
        view_direction(viewpoint),
        fov=viewpoint.fov,
        margin=viewpoint.margin,
        width=viewpoint.width,
        height=viewpoint.height,
    )
