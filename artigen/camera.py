"""Pinhole cameras: pixel rays, projection, and framing of points.

z is up. The image plane has its origin at the upper left; pixel (column, row) covers ``[column, column + 1] x
[row, row + 1]``. Depth is measured along the viewing direction.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.types import freeze_field

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, kw_only=True, eq=False)
class Camera:
    """A pinhole whose axis goes through the middle of the picture."""

    position: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "3 3"]
    """Rows point to the right, down and forward in the picture; they need not be orthogonal."""
    pixel: float
    """Edge of a pixel at depth one."""
    width: int
    """Pixels per row."""
    height: int
    """Number of rows."""

    def __post_init__(self) -> None:
        freeze_field(self, "position", np.float64, (3,), "camera position")
        freeze_field(self, "axes", np.float64, (3, 3), "camera axes")
        if min(self.width, self.height) < 1:
            raise ValueError(f"camera image is {self.width} x {self.height} pixels, expected at least 1 x 1")

    @property
    def target(self) -> Float[np.ndarray, "3"]:
        """The point at depth one in the middle of the picture."""
        return self.position + self.axes[2]

    @property
    def fov(self) -> float:
        """Vertical angle of view in degrees."""
        return float(2.0 * np.degrees(np.arctan(self.pixel * self.height / 2.0)))


def look_at(
    position: Float[np.ndarray, "3"],
    target: Float[np.ndarray, "3"],
    *,
    fov: float = 30.0,
    width: int = 384,
    height: int = 384,
) -> Camera:
    """A camera at ``position`` that looks at ``target``; z is up in the picture.

    Args:
        fov: Vertical angle of view in degrees.
        width: Pixels per row.
        height: Number of rows.

    Raises:
        ValueError: If the view is vertical, or the angle or the size of the picture is out of range.
    """
    if not 0.0 < fov < 180.0:
        raise ValueError(f"camera fov is {fov} degrees, allowed is between 0 and 180")
    forward = np.asarray(target, dtype=np.float64) - position
    if np.linalg.norm(np.cross(forward, UP)) < 1e-9 * max(1.0, float(np.linalg.norm(forward))):
        raise ValueError(
            f"camera looks from {np.asarray(position).tolist()} to {np.asarray(target).tolist()}: "
            "position and target must differ and not lie above each other"
        )
    pixel = 2.0 * np.tan(np.radians(fov) / 2.0) / max(height, 1)
    return Camera(position=position, axes=_axes(forward), pixel=float(pixel), width=width, height=height)


def _axes(forward: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
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
    right, down, forward = np.linalg.inv(camera.axes).T.astype(np.float32)
    across = ((columns - camera.width / 2.0) * camera.pixel).astype(np.float32)[..., None]
    along = ((rows - camera.height / 2.0) * camera.pixel).astype(np.float32)[..., None]
    return across * right + along * down + forward


def project_points(camera: Camera, points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3"]:
    """Column, row (pixels) and depth of points; a point behind the camera has depth <= 0."""
    local = (points - camera.position) @ camera.axes.T
    depth = local[:, 2:]
    with np.errstate(divide="ignore", invalid="ignore"):
        plane = local[:, :2] / depth / camera.pixel
    return np.concatenate([plane + np.array([camera.width, camera.height]) / 2.0, depth], axis=1)


def frame_points(
    points: Float[np.ndarray, "N 3"],
    direction: Sequence[float] | Float[np.ndarray, "3"],
    *,
    fov: float = 24.0,
    margin: float = 0.06,
    width: int,
    height: int,
) -> Camera:
    """The nearest camera in a direction that has every point inside the margins.

    For a fixed orientation, each border of the picture is a half-space condition that is linear in the
    camera's position, so the solution is exact and touches at least one pair of borders.

    Args:
        direction: From the object to the camera, of any length.
        fov: Vertical angle of view in degrees.
        margin: Free border, as a share of the image on each side.
        width: Pixels per row.
        height: Number of rows.

    Raises:
        ValueError: If there are no points, or the margin leaves no picture.
    """
    if len(points) == 0:
        raise ValueError("no points to frame: the object has no geometry to look at")
    if not 0.0 <= margin < 0.5:
        raise ValueError(f"margin is {margin}, allowed is 0 to below 0.5")
    camera = look_at(
        np.asarray(direction, dtype=np.float64), np.zeros(3), fov=fov, width=width, height=height
    )
    local = points @ camera.axes.T
    slopes = camera.pixel * (1.0 - 2.0 * margin) * np.array([width, height]) / 2.0
    highest = (local[:, :2] - slopes * local[:, 2:]).max(axis=0)
    lowest = (local[:, :2] + slopes * local[:, 2:]).min(axis=0)
    depth = float(((lowest - highest) / (2.0 * slopes)).min())
    spread = float(np.ptp(points, axis=0).max())
    depth = min(depth, float(local[:, 2].min()) - 1e-3 * max(spread, 1e-3))
    position = np.array([*((highest + lowest) / 2.0), depth]) @ camera.axes
    return look_at(position, position + camera.axes[2], fov=fov, width=width, height=height)
