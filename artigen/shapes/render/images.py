"""`render`: colour, mask, depth, normals and part ids of shapes, for cameras and joint states in a batch."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from artigen.shapes.render.cameras import Cameras, pixel_sizes
from artigen.shapes.render.lighting import light_floor, light_surface
from artigen.shapes.render.rays import (
    NOTHING,
    Hits,
    Rays,
    Surface,
    find_hits,
    find_layers,
    find_surface,
    make_rays,
)
from artigen.shapes.render.scene import Instances, Scene, place_instances
from artigen.shapes.render.shading import (
    Material,
    RenderConfig,
    linear_from_srgb,
    shade,
    srgb_from_linear,
)
from artigen.shapes.textures import apply_paint, find_rows

LAYERS = 8
"""Panes that one looks through at most."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Images:
    """Pictures of a batch. Glass counts as surface everywhere but in ``rgb``, where one looks through it."""

    rgb: Float[Tensor, "B H W 3"]
    """sRGB in [0, 1]."""
    mask: Bool[Tensor, "B H W"]
    depth: Float[Tensor, "B H W"]
    """Metres along the viewing direction; infinite where nothing is seen."""
    normals: Float[Tensor, "B H W 3"]
    """Unit, in the world, towards the camera; zero where nothing is seen."""
    part_ids: Int[Tensor, "B H W"]
    """Index into the shape's parts, -1 where nothing is seen."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _View:
    """One batch of images with everything that rays need."""

    scene: Scene
    cameras: Cameras
    instances: Instances
    rays: Rays
    hits: Hits


def render(
    scene: Scene,
    cameras: Cameras,
    qpos: Float[np.ndarray, "B Q"] | Sequence[Float[np.ndarray, "Q"]],
    *,
    shape_ids: Sequence[int] | None = None,
    cfg: RenderConfig | None = None,
) -> Images:
    """Pictures of one shape each.

    Args:
        scene: The shapes.
        cameras: One per picture, on the scene's device.
        qpos: Joint coordinates per picture: one per part of its shape, metres and radians.
        shape_ids: Which shape each picture shows; without it all show the first.
        cfg: Light and quality.

    Raises:
        ValueError: If cameras, coordinates and shapes are not equally many.
    """
    cfg = cfg or RenderConfig()
    shape_ids = [0] * len(cameras.fov) if shape_ids is None else shape_ids
    if not len(cameras.fov) == len(qpos) == len(shape_ids) > 0:
        raise ValueError(
            f"{len(cameras.fov)} cameras, {len(qpos)} joint states and {len(shape_ids)} shapes: "
            "expected one of each per picture, and at least one"
        )
    instances = place_instances(scene, shape_ids, list(qpos))
    view = _look(scene, cameras, instances)
    first = next(find_layers(view.hits, _pixel_count(cameras)))
    surface = _surface_of(view, first)
    maps = _geometry(view, surface)
    if cfg.supersampling > 1:
        view = _look(scene, _resize(cameras, cfg.supersampling), instances)
        surface = _surface_of(view, next(find_layers(view.hits, _pixel_count(view.cameras))))
    light = _light_of(view, surface, cfg)
    return Images(rgb=srgb_from_linear(_average(light, cfg.supersampling)), **maps)


def _look(scene: Scene, cameras: Cameras, instances: Instances) -> _View:
    rays = make_rays(cameras, instances)
    hits = find_hits(cameras, instances, rays)
    return _View(scene=scene, cameras=cameras, instances=instances, rays=rays, hits=hits)


def _geometry(view: _View, surface: Surface) -> dict[str, Tensor]:
    """Mask, depth, normals and part ids of the nearest surfaces."""
    size = (len(view.cameras.fov), view.cameras.height, view.cameras.width)
    count, device = _pixel_count(view.cameras), view.scene.device
    mask = torch.zeros(count, dtype=torch.bool, device=device)
    depth = torch.full((count,), torch.inf, device=device)
    normals = torch.zeros(count, 3, device=device)
    part_ids = torch.full((count,), -1, dtype=torch.int64, device=device)
    mask[surface.pixel] = True
    depth[surface.pixel] = surface.depth
    normals[surface.pixel] = surface.normal
    part_ids[surface.pixel] = view.scene.part[view.instances.primitive[surface.instance]]
    return {
        "mask": mask.reshape(size),
        "depth": depth.reshape(size),
        "normals": normals.reshape(*size, 3),
        "part_ids": part_ids.reshape(size),
    }


def _light_of(view: _View, surface: Surface, cfg: RenderConfig) -> Float[Tensor, "B H W 3"]:
    """Linear light of every pixel: layers of glass from the front, then what is behind them."""
    cameras = view.cameras
    count, device = _pixel_count(cameras), view.scene.device
    light = torch.zeros(count, 3, device=device)
    through = torch.ones(count, device=device)
    for number, key in enumerate(islice(find_layers(view.hits, count), LAYERS)):
        if number > 0:
            surface = _surface_of(view, torch.where(through > 1e-3, key, NOTHING))
        if len(surface.pixel) == 0:
            break
        material = _material_of(view, surface)
        reached = light_surface(cameras, view.instances, surface, cfg)
        scattered, mirrored = shade(surface, material, reached, cfg)
        share = through[surface.pixel][:, None]
        light[surface.pixel] += share * (material.opacity[:, None] * scattered + mirrored)
        through[surface.pixel] *= 1.0 - material.opacity
    ground = linear_from_srgb(torch.tensor(cfg.background, device=device))
    around = light_floor(cameras, view.instances, through < 1e-3, cfg)
    light += (through * around)[:, None] * ground
    return light.reshape(len(cameras.fov), cameras.height, cameras.width, 3)


def _surface_of(view: _View, key: Int[Tensor, "N"]) -> Surface:
    pixel = (key != NOTHING).nonzero()[:, 0]
    return find_surface(view.cameras, view.instances, view.rays, pixel, key[pixel])


def _material_of(view: _View, surface: Surface) -> Material:
    table = view.scene.paint
    rows = find_rows(table, view.instances.primitive[surface.instance], surface.rest_normal)
    pixel = pixel_sizes(view.cameras).float()[view.instances.image[surface.instance]]
    color = apply_paint(table, rows, surface.rest_point, surface.rest_normal, footprint=surface.depth * pixel)
    return Material(
        color=linear_from_srgb(color),
        kind=table.kind[rows],
        gloss=table.gloss[rows],
        opacity=table.opacity[rows],
    )


def _pixel_count(cameras: Cameras) -> int:
    return len(cameras.fov) * cameras.height * cameras.width


def _resize(cameras: Cameras, factor: int) -> Cameras:
    return Cameras(
        position=cameras.position,
        target=cameras.target,
        fov=cameras.fov,
        width=cameras.width * factor,
        height=cameras.height * factor,
    )


def _average(light: Float[Tensor, "B H W 3"], factor: int) -> Float[Tensor, "B h w 3"]:
    """Mean over squares of ``factor`` pixels; each is cut at white first, or highlights would fray."""
    if factor == 1:
        return light
    batch, height, width, _ = light.shape
    light = light.clamp(max=1.0)
    return light.reshape(batch, height // factor, factor, width // factor, factor, 3).mean(dim=(2, 4))
