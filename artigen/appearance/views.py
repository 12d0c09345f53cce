"""Cameras and lights for an object in any joint state."""

from dataclasses import dataclass, field, replace

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.camera import frame_points
from artigen.shapes.poses import place_posed
from artigen.shapes.render import Cameras, RenderConfig, batch_cameras
from artigen.shapes.render.shading import EVEN_LIGHT
from artigen.shapes.shape import Shape

FOV = 40.0
"""Angle of view (degrees)."""
LOWEST, HIGHEST = -0.45, 0.92
"""Sines of the lowest and of the highest elevation of a camera."""


@dataclass(frozen=True, kw_only=True)
class ViewConfig:
    """How an object is rendered in one joint state."""

    count: int = 48
    """Number of pictures."""
    size: int = 128
    """Edge of a picture in pixels."""
    front: float = 0.5
    """Share of the cameras that stand in front and look into openings; the others stand all around."""
    light: RenderConfig = field(default_factory=lambda: EVEN_LIGHT)
    """Lights and other render settings."""
    sharpness: int = 1
    """Rays per pixel edge in the pictures that are kept."""

    def __post_init__(self) -> None:
        if self.count < 1 or not 0 <= self.front <= 1:
            raise ValueError(
                f"{self.count} views, {self.front} of them in front: expected at least 1, and a share"
            )


def spread_directions(cfg: ViewConfig, turn: float) -> Float[np.ndarray, "V 3"]:
    """Unit directions from an object to its cameras: Hammersley's points over a band of the sphere.

    Args:
        turn: Shift of the sequence in [0, 1), so that states are seen from different places.
    """
    order = np.arange(cfg.count)
    height = LOWEST + (HIGHEST - LOWEST) * ((order + 0.5) / cfg.count)
    around = (order * 0.6180339887498949 + turn) % 1.0  # golden-ratio sequence, as even as Hammersley's
    ahead = np.pi * (around / max(cfg.front, 1e-9) - 0.5)
    anywhere = 2.0 * np.pi * (around - cfg.front) / max(1.0 - cfg.front, 1e-9)
    angle = np.where(around < cfg.front, ahead, anywhere)
    level = np.sqrt(1.0 - height**2)
    return np.stack([-np.cos(angle) * level, np.sin(angle) * level, height], axis=1)


def place_cameras(shape: Shape, qpos: Float[np.ndarray, "P"], cfg: ViewConfig, turn: float) -> Cameras:
    """One camera per direction, each as near as possible with the whole object in the picture (m)."""
    points = place_posed(shape, qpos)
    single = [
        frame_points(points, direction, fov=FOV, width=cfg.size, height=cfg.size)
        for direction in spread_directions(cfg, turn)
    ]
    return batch_cameras(single)


def pick_cameras(cameras: Cameras, rows: Int[Tensor, "K"]) -> Cameras:
    """Some of the cameras, in the order of ``rows``."""
    return replace(
        cameras, position=cameras.position[rows], target=cameras.target[rows], fov=cameras.fov[rows]
    )


def scale_cameras(cameras: Cameras, center: Float[np.ndarray, "3"], scale: float) -> Cameras:
    """Cameras in unit-cube coordinates: relative to ``center`` (m), in units of ``scale`` metres."""
    middle = torch.as_tensor(center)
    return replace(
        cameras, position=(cameras.position - middle) / scale, target=(cameras.target - middle) / scale
    )
