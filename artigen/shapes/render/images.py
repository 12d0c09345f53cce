"""`render`: colour, mask, depth, normals and part ids of shapes, for batches of cameras and joint states."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
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
    Surface,
    find_hits,
    find_layers,
    find_surface,
    make_rays,
    unpack_keys,
)
from artigen.shapes.render.scene import Instances, Scene, place_instances
from artigen.shapes.render.shading import Material, RenderConfig, linear_from_srgb, shade, srgb_from_linear
from artigen.shapes.surfaces.textures import apply_paint, find_rows


@dataclass(frozen=True, kw_only=True, eq=False)
class Images:
    """Pictures of a batch. Glass counts as surface in all maps but ``rgb``, where it is transparent."""

    rgb: Float[Tensor, "B H W 3"]
    """sRGB in [0, 1]."""
    mask: Bool[Tensor, "B H W"]
    depth: Float[Tensor, "B H W"]
    """Metres along the viewing direction; infinite for background."""
    normals: Float[Tensor, "B H W 3"]
    """Unit, in the world, towards the camera; zero for background."""
    part_ids: Int[Tensor, "B H W"]
    """Index into the shape's parts, -1 for background."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _View:
    """Visible surfaces of a batch of cameras."""

    scene: Scene
    cameras: Cameras
    instances: Instances
    surface: Surface
    """Surfaces of all layers: the nearest of every pixel, then those behind glass."""
    layers: tuple[int, ...]
    """Number of points in each layer."""


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
        shape_ids: Shape of each picture; by default the first shape.
        cfg: Light and quality.

    Raises:
        ValueError: If the numbers of cameras, coordinates and shapes differ.
    """
    cfg = cfg or RenderConfig()
    shape_ids = [0] * len(cameras.fov) if shape_ids is None else shape_ids
    if not len(cameras.fov) == len(qpos) == len(shape_ids) > 0:
        raise ValueError(
            f"{len(cameras.fov)} cameras, {len(qpos)} joint states and {len(shape_ids)} shapes: "
            "expected one of each per picture, and at least one"
        )
    instances = place_instances(scene, shape_ids, list(qpos))
    view = _look(scene, cameras, instances, cfg.layers)
    maps = _geometry(view)
    if cfg.supersampling > 1:
        width, height = cameras.width * cfg.supersampling, cameras.height * cfg.supersampling
        view = _look(scene, replace(cameras, width=width, height=height), instances, cfg.layers)
    light = _light_of(view, cfg)
    return Images(rgb=srgb_from_linear(_average(light, cfg.supersampling)), **maps)


def _look(scene: Scene, cameras: Cameras, instances: Instances, depth: int) -> _View:
    """Casts the rays and finds the visible surfaces of all layers together, in few large operations."""
    rays = make_rays(cameras, instances)
    hits = find_hits(cameras, instances, rays)
    glassy = (scene.paint.opacity.reshape(-1, 2).amin(dim=1) < 1)[instances.primitive]
    count = _pixel_count(cameras)
    layers = _peel(hits, count, glassy, depth)
    key = torch.cat(layers)
    found = (key != NOTHING).nonzero()[:, 0]
    return _View(
        scene=scene,
        cameras=cameras,
        instances=instances,
        surface=find_surface(cameras, instances, rays, found % count, key[found]),
        layers=tuple(int((layer != NOTHING).sum()) for layer in layers),
    )


def _peel(hits: Hits, count: int, glassy: Bool[Tensor, "I"], depth: int) -> list[Int[Tensor, "N"]]:
    """Keys of the nearest surface of each pixel, then of the next one behind it if that is glass, and so
    on."""
    layers: list[Tensor] = []
    for key in islice(find_layers(hits, count), depth):
        if layers:
            key = torch.where(_is_glass(layers[-1], glassy), key, NOTHING)
        layers.append(key)
        if not bool(_is_glass(key, glassy).any()):
            break
    return layers


def _is_glass(key: Int[Tensor, "N"], glassy: Bool[Tensor, "I"]) -> Bool[Tensor, "N"]:
    instance = unpack_keys(key)[1].clamp(max=len(glassy) - 1)
    return (key != NOTHING) & glassy[instance]


def _geometry(view: _View) -> dict[str, Tensor]:
    """Mask, depth, normals and part ids of the nearest surfaces."""
    surface, count, seen = view.surface, _pixel_count(view.cameras), view.layers[0]
    size = (len(view.cameras.fov), view.cameras.height, view.cameras.width)

    def fill(values: Tensor, empty: float) -> Tensor:
        """A map with the values of the nearest surfaces, and ``empty`` elsewhere."""
        shape, kind = values.shape[1:], {"dtype": values.dtype, "device": values.device}
        flat = torch.full((count, *shape), empty, **kind)
        flat[surface.pixel[:seen]] = values[:seen]
        return flat.reshape(*size, *shape)

    return {
        "mask": fill(torch.ones_like(surface.pixel, dtype=torch.bool), 0),
        "depth": fill(surface.depth, torch.inf),
        "normals": fill(surface.normal, 0),
        "part_ids": fill(view.scene.part[view.instances.primitive[surface.instance]], -1),
    }


def _light_of(view: _View, cfg: RenderConfig) -> Float[Tensor, "B H W 3"]:
    """Linear light of every pixel: composites layers of glass over what is behind them."""
    cameras = view.cameras
    count, device = _pixel_count(cameras), view.scene.device
    light = torch.zeros(count, 3, device=device)
    through = torch.ones(count, device=device)
    surface, material = view.surface, _material_of(view)
    reached = light_surface(cameras, view.instances, surface, cfg)
    scattered, mirrored = shade(surface.normal, surface.view, material, reached, cfg)
    start = 0
    for seen in view.layers:
        layer = slice(start, start + seen)
        start, pixel, opacity = layer.stop, surface.pixel[layer], material.opacity[layer]
        light[pixel] += through[pixel, None] * (opacity[:, None] * scattered[layer] + mirrored[layer])
        through[pixel] *= 1.0 - opacity
    ground = linear_from_srgb(torch.tensor(cfg.background, device=device))
    around = light_floor(cameras, view.instances, through < 1e-3, cfg)
    light += (through * around)[:, None] * ground
    return light.reshape(len(cameras.fov), cameras.height, cameras.width, 3)


def _material_of(view: _View) -> Material:
    table, surface = view.scene.paint, view.surface
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


def _average(light: Float[Tensor, "B H W 3"], factor: int) -> Float[Tensor, "B h w 3"]:
    """Mean over squares of ``factor`` pixels, each clipped at white first, so that highlights stay
    antialiased."""
    if factor == 1:
        return light
    batch, height, width, _ = light.shape
    light = light.clamp(max=1.0)
    return light.reshape(batch, height // factor, factor, width // factor, factor, 3).mean(dim=(2, 4))
