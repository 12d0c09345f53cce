"""Pinhole cameras in batches: metres, z up, pixel (column, row) covers [column, column + 1] x [row, row + 1].

The image plane has its origin at the upper left; depth is measured along the viewing direction.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.camera import Camera


@dataclass(frozen=True, kw_only=True, eq=False)
class Cameras:
    """Pinholes at ``position`` (metres) that look at ``target``; z is up in the pictures."""

    position: Float[Tensor, "B 3"]
    target: Float[Tensor, "B 3"]
    fov: Float[Tensor, "B"]
    """Vertical angles of view in degrees."""
    width: int = 128
    """Pixels per row."""
    height: int = 128
    """Number of rows."""

    def __post_init__(self) -> None:
        forward = self.target - self.position
        if (forward[:, :2].norm(dim=1) < 1e-9 * forward.norm(dim=1).clamp(min=1.0)).any():
            raise ValueError("a camera and its target must differ and not lie above each other")
        if not ((self.fov > 0) & (self.fov < 180)).all():
            raise ValueError(f"camera fov is {self.fov.tolist()} degrees, allowed is between 0 and 180")
        if min(self.width, self.height) < 1:
            raise ValueError(f"images are {self.width} x {self.height} pixels, expected at least 1 x 1")


def camera_axes(cameras: Cameras) -> Float[Tensor, "B 3 3"]:
    """Rows are the picture's right, down and forward directions in the world (float64)."""
    forward = torch.nn.functional.normalize(cameras.target.double() - cameras.position.double(), dim=1)
    up = torch.tensor([0.0, 0.0, 1.0], dtype=torch.float64, device=forward.device).expand_as(forward)
    right = torch.nn.functional.normalize(torch.linalg.cross(forward, up), dim=1)
    return torch.stack([right, torch.linalg.cross(forward, right), forward], dim=1)


def pixel_sizes(cameras: Cameras) -> Float[Tensor, "B"]:
    """Edge of a pixel at depth one (float64)."""
    return 2.0 * torch.tan(torch.deg2rad(cameras.fov.double()) / 2.0) / cameras.height


def locate_pixels(
    cameras: Cameras, pixel: Int[Tensor, "N"]
) -> tuple[Int[Tensor, "N"], Int[Tensor, "N"], Int[Tensor, "N"]]:
    """Image, row and column of pixels, which are counted over all images of the batch."""
    line = torch.div(pixel, cameras.width, rounding_mode="floor")
    image = torch.div(line, cameras.height, rounding_mode="floor")
    return image, line % cameras.height, pixel % cameras.width


def cast_rays(
    cameras: Cameras, image: Int[Tensor, "N"], row: Int[Tensor, "N"], column: Int[Tensor, "N"]
) -> Float[Tensor, "N 3"]:
    """World directions of rays through the middles of pixels, of length one along the view (float32)."""
    axes = camera_axes(cameras).float().index_select(0, image)
    edge = pixel_sizes(cameras).float().index_select(0, image)
    x, y = (column + 0.5 - cameras.width / 2) * edge, (row + 0.5 - cameras.height / 2) * edge
    return axes[:, 0] * x[:, None] + axes[:, 1] * y[:, None] + axes[:, 2]


def batch_cameras(cameras: Sequence[Camera], device: str | torch.device = "cpu") -> Cameras:
    """Cameras with orthogonal axes as a batch on a device; their pictures must be of one size.

    Raises:
        ValueError: If there are none, or sizes differ.
    """
    sizes = {(one.width, one.height) for one in cameras}
    if len(sizes) != 1:
        raise ValueError(f"cameras with pictures of {sorted(sizes)} pixels, expected one size")
    return Cameras(
        position=torch.from_numpy(np.stack([camera.position for camera in cameras])).to(device),
        target=torch.from_numpy(np.stack([camera.target for camera in cameras])).to(device),
        fov=torch.tensor([camera.fov for camera in cameras], dtype=torch.float64, device=device),
        width=cameras[0].width,
        height=cameras[0].height,
    )
