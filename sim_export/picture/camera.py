"""A pinhole camera as a value: pixel rays, projection, and framing of a point cloud.

Metres, z up. The image plane has its origin at the upper left; pixel (column, row) covers ``[column, column +
1] x [row, row + 1]``. Depth is measured along the viewing direction.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.types import freeze_field

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, kw_only=True, eq=False)
class Camera:
    """A pinhole at ``position`` (metres) that looks at ``target``; z is up in the picture."""

    position: Float[np.ndarray, "3"]
    target: Float[np.ndarray, "3"]
    fov: float = 30.0
    """Vertical angle of view in degrees."""
    width: int = 384
    """Pixels per row."""
    height: int = 384
    """Number of rows."""

    def __post_init__(self) -> None:
        for name in ("position", "target"):
            freeze_field(self, name, np.float64, (3,), f"camera {name}")
        if not 0.0 < self.fov < 180.0:
            raise ValueError(f"camera fov is {self.fov} degrees, allowed is between 0 and 180")
        if min(self.width, self.height) < 1:
            raise ValueError(f"camera image is {self.width} x {self.height} pixels, expected at least 1 x 1")
        forward = self.target - self.position
        if np.linalg.norm(np.cross(forward, UP)) < 1e-9 * max(1.0, float(np.linalg.norm(forward))):
            raise ValueError(
                f"camera looks from {self.position.tolist()} to {self.target.tolist()}: "
                "position and target must differ and not lie above each other"
            )


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


def camera_axes(camera: Camera) -> Float[np.ndarray, "3 3"]:
    """Rows are the picture's right, down and forward directions in the world."""
    return _axes(camera.target - camera.position)


def _axes(forward: np.ndarray) -> np.ndarray:
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, UP)
    right = right / np.linalg.norm(right)
    return np.stack([right, np.cross(forward, right), forward])


def pixel_rays(camera: Camera) -> Float[np.ndarray, "H W 3"]:
    """Ray directions (float32) through all pixel centres, see `rays_through`."""
    columns, rows = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    return rays_through(camera, columns, rows)


def rays_through(
    camera: Camera, columns: Float[np.ndarray, "*S"], rows: Float[np.ndarray, "*S"]
) -> Float[np.ndarray, "*S 3"]:
    """Ray directions (float32) through points of the picture, given in pixels.

    Each direction has length one *along the viewing direction*, so that a ray's parameter is depth.
    """
    right, down, forward = camera_axes(camera)
    pixel = 2.0 * np.tan(np.radians(camera.fov) / 2.0) / camera.height
    across = ((columns - camera.width / 2.0) * pixel).astype(np.float32)[..., None]
    along = ((rows - camera.height / 2.0) * pixel).astype(np.float32)[..., None]
    return across * right.astype(np.float32) + along * down.astype(np.float32) + forward.astype(np.float32)


def project_points(camera: Camera, points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3"]:
    """Column, row (pixels) and depth (metres) of points; a point behind the camera has depth <= 0."""
    local = (points - camera.position) @ camera_axes(camera).T
    pixel = 2.0 * np.tan(np.radians(camera.fov) / 2.0) / camera.height
    depth = local[:, 2:]
    with np.errstate(divide="ignore", invalid="ignore"):
        plane = local[:, :2] / depth / pixel
    center = np.array([camera.width, camera.height]) / 2.0
    return np.concatenate([plane + center, depth], axis=1)


def view_direction(viewpoint: Viewpoint) -> Float[np.ndarray, "3"]:
    """Unit vector from the object to the camera."""
    azimuth, elevation = np.radians(viewpoint.azimuth), np.radians(viewpoint.elevation)
    return np.array(
        [-np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )


def frame_points(points: Float[np.ndarray, "N 3"], viewpoint: Viewpoint) -> Camera:
    """The nearest camera with this orientation that has every point inside the margins.

    For a fixed orientation, each border of the picture is a half-space condition that is linear in the
    camera's position, so the solution is exact and touches at least one pair of borders.

    Raises:
        ValueError: If there are no points, or the margin leaves no picture.
    """
    if len(points) == 0:
        raise ValueError("no points to frame: the object has no geometry to look at")
    if not 0.0 <= viewpoint.margin < 0.5:
        raise ValueError(f"viewpoint margin is {viewpoint.margin}, allowed is 0 to below 0.5")
    axes = _axes(-view_direction(viewpoint))
    local = points @ axes.T
    vertical = np.tan(np.radians(viewpoint.fov) / 2.0) * (1.0 - 2.0 * viewpoint.margin)
    slopes = np.array([vertical * viewpoint.width / viewpoint.height, vertical])
    highest = (local[:, :2] - slopes * local[:, 2:]).max(axis=0)
    lowest = (local[:, :2] + slopes * local[:, 2:]).min(axis=0)
    depth = float(((lowest - highest) / (2.0 * slopes)).min())
    spread = float(np.ptp(points, axis=0).max())
    depth = min(depth, float(local[:, 2].min()) - 1e-3 * max(spread, 1e-3))
    position = np.array([*((highest + lowest) / 2.0), depth]) @ axes
    return Camera(
        position=position,
        target=position + axes[2],
        fov=viewpoint.fov,
        width=viewpoint.width,
        height=viewpoint.height,
    )
