"""Newly exposed surface: not reached by any straight line from outside while the object is closed.

Exact up to the number of directions tried. Every visible point is moved back to rest with its part, and rays
from there are tested against all solids but glass.
"""

from dataclasses import replace

import numpy as np
import torch
from jaxtyping import Bool, Float
from torch import Tensor

from artigen.shapes.poses import pose_parts
from artigen.shapes.render.cameras import Cameras, camera_axes, pixel_sizes
from artigen.shapes.render.images import Images
from artigen.shapes.render.scene import Instances, Scene, place_instances
from artigen.shapes.render.shadows import find_lit

DIRECTIONS = 64
"""Directions on the sphere from which the closed object is tested."""
CLEARANCE = 1e-3
"""Height (m) by which points are lifted off their surface."""


def find_exposed(
    scene: Scene, cameras: Cameras, images: Images, qpos: Float[np.ndarray, "P"]
) -> Bool[Tensor, "V H W"]:
    """Pixels whose surface is hidden from everywhere while the object is closed.

    Args:
        images: The pictures, all in the joint state ``qpos``.
        qpos: One coordinate per part (m, rad).
    """
    points, normals = rest_surface(scene, cameras, images, qpos)
    closed = _without_glass(scene, place_instances(scene, [0], [np.zeros_like(qpos)]))
    hidden = torch.ones(len(points), dtype=torch.bool, device=points.device)
    for direction in spread_sphere(DIRECTIONS):
        toward = normals @ normals.new_tensor(direction)
        rows = (hidden & (toward > 1e-3)).nonzero()[:, 0]
        if not len(rows):
            continue
        x, y, z = (float(value) for value in direction)
        image = torch.zeros(len(rows), dtype=torch.long, device=points.device)
        hidden[rows[find_lit(closed, image, points[rows], (x, y, z))]] = False
    out = torch.zeros_like(images.mask)
    out[images.mask] = hidden
    return out


def spread_sphere(count: int) -> Float[np.ndarray, "K 3"]:
    """Unit directions spread evenly over the sphere (Fibonacci's lattice)."""
    order = np.arange(count) + 0.5
    height = 1.0 - 2.0 * order / count
    angle = np.pi * (1.0 + 5.0**0.5) * order
    level = np.sqrt(1.0 - height**2)
    return np.stack([level * np.cos(angle), level * np.sin(angle), height], axis=1)


def rest_surface(
    scene: Scene, cameras: Cameras, images: Images, qpos: Float[np.ndarray, "P"]
) -> tuple[Float[Tensor, "N 3"], Float[Tensor, "N 3"]]:
    """Points just off the surface that pixels show (m), and its normals, both moved back to rest."""
    view, row, column = images.mask.nonzero().unbind(1)
    axes, pixel = camera_axes(cameras)[view], pixel_sizes(cameras)[view]
    x = (column + 0.5 - cameras.width / 2) * pixel
    y = (row + 0.5 - cameras.height / 2) * pixel
    way = axes[:, 0] * x[:, None] + axes[:, 1] * y[:, None] + axes[:, 2]
    depth = images.depth[images.mask].double()
    normal = images.normals[images.mask].double()
    point = cameras.position.double()[view] + way * depth[:, None] + CLEARANCE * normal
    moved = torch.as_tensor(pose_parts(scene.shapes[0], qpos), device=point.device)
    D = moved[images.part_ids[images.mask]]
    point = torch.einsum("nji,nj->ni", D[:, :3, :3], point - D[:, :3, 3])
    normal = torch.einsum("nji,nj->ni", D[:, :3, :3], normal)
    return point.float(), normal.float()


def _without_glass(scene: Scene, instances: Instances) -> Instances:
    """The opaque primitives of a shape."""
    clear = scene.paint.opacity.reshape(-1, 2).amin(dim=1) < 1
    kept = ~clear[instances.primitive]
    rows = {name: value[kept] for name, value in vars(instances).items() if isinstance(value, Tensor)}
    return replace(instances, **rows)
