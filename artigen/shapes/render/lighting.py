"""Shares of lamp and sky light that reach surfaces and the floor, with few or many shadow rays.

With one ray per light, shadows are sharp. With more, the rays are spread over the lamp and the sky, and
distributed among the sub-rays of a supersampled pixel, so that soft light costs little more than sharp.
"""

from dataclasses import dataclass
from math import pi, sqrt

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from artigen.shapes.primitives import Vector
from artigen.shapes.render.cameras import Cameras, cast_rays, locate_pixels
from artigen.shapes.render.rays import Surface
from artigen.shapes.render.scene import Instances
from artigen.shapes.render.shading import Light, RenderConfig
from artigen.shapes.render.shadows import find_lit, find_openness

CORNER = 0.18
"""Distance (m) of a wall within which corners are darkened."""
SKY = (-0.35, 0.12, 0.93)
"""Direction of the soft light from above: over the head of a viewer in front."""
LAMP_SIZE = 0.12
"""Radius of the lamp, at distance one."""
SKY_SIZE = 1.3
"""The same for the sky, which covers nearly the hemisphere."""
CLEARANCE = 1e-3
"""Offset (m) of the start of shadow rays from the surface."""
SMOOTH = 3
"""Factor on the number of rays from the floor to the sky, where nothing masks steps."""
SHADOW_DEPTH = 0.75
"""Share of the floor's missing light by which the background is darkened."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Spots:
    """Start points of shadow rays."""

    image: Int[Tensor, "N"]
    point: Float[Tensor, "N 3"]
    normal: Float[Tensor, "N 3"]
    turn: Int[Tensor, "N"]
    """Index of the sub-ray that each point belongs to."""
    turns: int
    """Number of sub-rays per pixel."""


def light_surface(cameras: Cameras, instances: Instances, surface: Surface, cfg: RenderConfig) -> Light:
    """Share of each light that reaches the surface."""
    everything = torch.ones_like(surface.depth)
    lamp, sky, openness = everything, everything, everything
    turn = _sub_rays(cameras, surface.pixel, cfg.supersampling)
    if cfg.shadow_rays:
        spots = _Spots(
            image=instances.image[surface.instance],
            point=surface.point + CLEARANCE * surface.normal,
            normal=surface.normal,
            turn=turn,
            turns=cfg.supersampling**2,
        )
        lamp = _visible_share(instances, spots, cfg.lamp, LAMP_SIZE, cfg.shadow_rays)
        sky = _visible_share(instances, spots, SKY, SKY_SIZE, cfg.shadow_rays)
    if cfg.openness:
        openness = find_openness(
            cameras, surface, turn, reach=CORNER, samples=max(4, 10 // cfg.supersampling)
        )
    return Light(lamp=lamp, sky=sky, open=openness)


def light_floor(
    cameras: Cameras, instances: Instances, unseen: Bool[Tensor, "N"], cfg: RenderConfig
) -> Float[Tensor, "N"]:
    """Brightness of the background per pixel: one, or less where the object shades the floor at z = 0.

    Args:
        cameras: Cameras of the pictures.
        instances: Solids that cast shadows.
        unseen: Pixels that the object covers, whose brightness is irrelevant.
        cfg: Light and quality.
    """
    out = torch.ones(len(unseen), device=unseen.device)
    if not (cfg.floor and cfg.shadow_rays):
        return out
    pixel = (~unseen).nonzero()[:, 0]
    image, row, column = locate_pixels(cameras, pixel)
    ray = cast_rays(cameras, image, row, column)
    eye = cameras.position.float()[image]
    distance = -eye[:, 2] / ray[:, 2].clamp(max=-1e-6)
    point = eye + ray * distance[:, None]
    low, high = instances.corners.amin(dim=(0, 1)).float(), instances.corners.amax(dim=(0, 1)).float()
    reach = 1.5 * (high - low).norm()
    near = (ray[:, 2] < -1e-6) & ((point - (low + high) / 2).norm(dim=1) < reach) & (eye[:, 2] > 0)
    pixel, point = pixel[near], point[near]
    up = torch.tensor([0.0, 0.0, 1.0], device=point.device).expand_as(point)
    turn = _sub_rays(cameras, pixel, cfg.supersampling)
    spots = _Spots(
        image=image[near], point=point + CLEARANCE * up, normal=up, turn=turn, turns=cfg.supersampling**2
    )
    if len(pixel):
        lamp = _visible_share(instances, spots, cfg.lamp, LAMP_SIZE, cfg.shadow_rays)
        sky = _visible_share(instances, spots, SKY, SKY_SIZE, SMOOTH * cfg.shadow_rays)
        direct, soft = cfg.lamp_strength * _unit(cfg.lamp)[2], cfg.sky_strength + cfg.fill_strength
        missing = (direct * (1.0 - lamp) + soft * (1.0 - sky)) / (direct + soft)
        out[pixel] = 1.0 - SHADOW_DEPTH * missing
    return out


def _visible_share(
    instances: Instances, spots: _Spots, light: Vector, size: float, rays: int
) -> Float[Tensor, "N"]:
    """Unoccluded share of a light, weighted by the cosine at each spot."""
    seen, all_of_it = torch.zeros(len(spots.point), device=spots.point.device), 1e-6
    for number, direction in enumerate(_spread(light, size, rays)):
        weight = (spots.normal @ spots.normal.new_tensor(direction)).clamp(min=0.0)
        if rays >= spots.turns:
            weight = torch.where(spots.turn == number % spots.turns, weight, 0.0)
        chosen = (weight > 0).nonzero()[:, 0]
        if len(chosen):
            lit = find_lit(instances, spots.image[chosen], spots.point[chosen], direction)
            seen[chosen] += weight[chosen] * lit
        all_of_it = all_of_it + weight
    return seen / all_of_it


def _spread(light: Vector, size: float, count: int) -> list[Vector]:
    """Unit directions over a disc about a light; the light itself if ``count`` is one."""
    axis = _unit(light)
    side = _unit((axis[2], 0.0, -axis[0]))
    other = tuple(
        axis[(k + 1) % 3] * side[(k + 2) % 3] - axis[(k + 2) % 3] * side[(k + 1) % 3] for k in range(3)
    )
    out = []
    for number in range(count):
        radius = size * sqrt(number / max(count - 1, 1)) if count > 1 else 0.0
        angle = torch.tensor(number * pi * (3 - sqrt(5)))
        u, v = float(radius * angle.cos()), float(radius * angle.sin())
        out.append(_unit((*(axis[k] + u * side[k] + v * other[k] for k in range(3)),)))
    return out


def _sub_rays(cameras: Cameras, pixel: Int[Tensor, "N"], factor: int) -> Int[Tensor, "N"]:
    """Index of fine pixels within their coarse pixel, counted from zero."""
    _, row, column = locate_pixels(cameras, pixel)
    return (row % factor) * factor + column % factor


def _unit(vector: tuple[float, ...]) -> Vector:
    length = sqrt(sum(v * v for v in vector))
    return vector[0] / length, vector[1] / length, vector[2] / length
