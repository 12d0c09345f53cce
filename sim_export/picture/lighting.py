"""Visibility of a scene for camera rays, and the light that arrives at the visible points."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from jaxtyping import Float, Int

from artigen.camera import Camera, project_points
from artigen.splats.colors import linear_from_srgb
from sim_export.picture.gloss import mirror_light
from sim_export.picture.raycast import (
    OPAQUE,
    Hits,
    Scene,
    albedo_at,
    are_occluded,
    cast_layers,
    corner_normals_at,
    gloss_at,
    surface_ids_at,
)
from sim_export.picture.shading import (
    TILE,
    dot_rows,
    orient_to_viewer,
    shade,
    sphere_points,
    tile_average,
    unoccluded_fraction,
)

GROUND = -2
NOTHING = -1
STRIDES, ALIKE = (8, 4, 2), 0.15
"""Strides (pixels) at which light is smoothed once more where it changes by less: on large plain
faces the edge of each ray would be seen."""
FADE = 0.14
"""Width of the border where the floor's shadow fades out, as a fraction of the picture."""
FLOOR_SHADE = (0.30, 0.32)
"""Darkening of the floor where the whole sky, and the whole key light, is occluded."""


@dataclass(frozen=True, kw_only=True)
class RenderConfig:
    """Lighting and sampling of a picture."""

    edge_rays: int = 6
    """Rays per edge pixel (1 disables antialiasing); raise it where edges look jagged."""
    background: tuple[int, int, int] = (247, 248, 250)
    """sRGB colour behind the object and of the ground."""
    ground: bool = True
    """Draw the shadow that the object casts on the floor below it."""
    ground_height: float | None = None
    """Height of the floor in metres; None takes the lowest point of the surfaces."""
    light_direction: tuple[float, float, float] = (-0.62, -0.42, 0.80)
    """Towards the key light; any length."""
    light_radius: float = 0.16
    """Radius of the key light at unit distance; larger gives softer shadows."""
    shadow_rays: int = 2
    """Rays to the key light per pixel, averaged over nearby pixels; more smooths soft shadows."""
    occlusion_rays: int = 4
    """Rays to the sky per pixel, averaged over nearby pixels; more smooths dark corners."""
    occlusion_reach: float = 0.30
    """Distance within which geometry darkens a surface, as a fraction of the scene's diagonal."""
    sky: tuple[float, float, float] = (0.50, 0.53, 0.57)
    """Light from above, linear red, green and blue."""
    bounce: tuple[float, float, float] = (0.34, 0.32, 0.30)
    """Light from below, which the floor sends back; more inside of pale rooms."""
    seed: int = 0
    """Seed that shifts the set of ray directions."""

    def __post_init__(self) -> None:
        if min(self.edge_rays, self.shadow_rays, self.occlusion_rays) < 1:
            raise ValueError(
                f"edge_rays {self.edge_rays}, shadow_rays {self.shadow_rays}, occlusion_rays "
                f"{self.occlusion_rays}: allowed is 1 and above each"
            )
        if not np.linalg.norm(self.light_direction) > 0.0:
            raise ValueError(f"light_direction is {self.light_direction}, expected a length above 0")


@dataclass(frozen=True, kw_only=True, eq=False)
class Samples:
    """Rays that hit something: their indices (``place``), and the surface properties at the hits."""

    place: Int[np.ndarray, "N"]
    label: Int[np.ndarray, "N"]
    points: Float[np.ndarray, "N 3"]
    rays: Float[np.ndarray, "N 3"]
    normals: Float[np.ndarray, "N 3"]
    geometric: Float[np.ndarray, "N 3"]
    albedo: Float[np.ndarray, "N 3"]
    gloss: Float[np.ndarray, "N 3"]
    """Roughness, metallic, and the share mirrored head-on."""
    cover: Float[np.ndarray, "N"]
    """Opacity of each hit."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Light:
    """The key light's direction, the background, and the ray directions shared by all samples."""

    direction: Float[np.ndarray, "3"]
    background: Float[np.ndarray, "3"]
    ambient: Float[np.ndarray, "2 3"]
    sky_rays: Float[np.ndarray, "K 3"]
    key_rays: Float[np.ndarray, "L 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Grid:
    """Per pixel: the visible surface, its normal, and the free fraction of sky and key light."""

    label: Int[np.ndarray, "H W"]
    normals: Float[np.ndarray, "H W 3"]
    visible: Float[np.ndarray, "H W 2"]


def prepare_light(cfg: RenderConfig) -> Light:
    sphere = sphere_points(TILE**2 * (cfg.occlusion_rays + cfg.shadow_rays), cfg.seed)
    split = TILE**2 * cfg.occlusion_rays
    direction = np.array(cfg.light_direction) / np.linalg.norm(cfg.light_direction)
    return Light(
        direction=direction.astype(np.float32),
        background=linear_from_srgb(np.array(cfg.background) / 255.0).astype(np.float32),
        ambient=np.array([cfg.sky, cfg.bounce], dtype=np.float32),
        sky_rays=sphere[:split],
        key_rays=sphere[split:] * np.float32(cfg.light_radius),
    )


def find_layers(
    scene: Scene, camera: Camera, rays: Float[np.ndarray, "R 3"], cfg: RenderConfig
) -> list[Samples]:
    """Layers of visible samples: surfaces, and floor where they may darken it.

    Each further layer contains what is visible through transparent samples of the previous one.
    """
    free, out = np.ones(len(rays), dtype=bool), []
    for hits, cover in cast_layers(scene, camera.position, rays):
        free[hits.place] = False
        out.append(_find_samples(scene, camera, rays, hits, cover, free, cfg))
        free[:] = False
        free[hits.place[cover < OPAQUE]] = True
    return out


def _find_samples(
    scene: Scene,
    camera: Camera,
    rays: np.ndarray,
    hits: Hits,
    cover: np.ndarray,
    free: np.ndarray,
    cfg: RenderConfig,
) -> Samples:
    """Samples of one layer of hits, and of the floor that ``free`` rays hit."""
    place, seen = hits.place, rays[hits.place]
    normals, geometric = orient_to_viewer(corner_normals_at(scene, hits), scene.normals[hits.triangle], seen)
    points = camera.position.astype(np.float32) + seen * hits.depth[:, None]
    facing = np.abs(dot_rows(scene.normals[hits.triangle], seen)) / np.sqrt(dot_rows(seen, seen))
    footprint = camera.pixel * hits.depth / np.sqrt(np.maximum(facing, 0.05))
    label, gloss = surface_ids_at(scene, hits), gloss_at(scene, hits)
    albedo = albedo_at(scene, hits, footprint)
    if cfg.ground:
        floor, floor_points = _find_floor(scene, camera, rays, free, cfg)
        up = np.tile(np.array([0.0, 0.0, 1.0], dtype=np.float32), (len(floor), 1))
        place, points = np.concatenate([place, floor]), np.concatenate([points, floor_points])
        normals, geometric = np.concatenate([normals, up]), np.concatenate([geometric, up])
        label = np.concatenate([label, np.full(len(floor), GROUND)])
        albedo = np.concatenate([albedo, np.ones_like(up)])
        gloss = np.concatenate([gloss, np.ones_like(up)])  # is never seen
        cover = np.concatenate([cover, np.ones(len(floor), dtype=np.float32)])
    return Samples(
        place=place, label=label, points=points, rays=rays[place],
        normals=normals, geometric=geometric, albedo=albedo, gloss=gloss, cover=cover,
    )  # fmt: skip


def _find_floor(
    scene: Scene, camera: Camera, rays: np.ndarray, free: np.ndarray, cfg: RenderConfig
) -> tuple[np.ndarray, np.ndarray]:
    """Free rays that hit the floor close enough to the object to be darkened by it, and the hit points."""
    low, high = scene.bounds
    height = float(low[2]) if cfg.ground_height is None else cfg.ground_height
    light = np.array(cfg.light_direction)
    drop = max(float(high[2]) - height, 0.0) / max(light[2], 1e-3)
    reach = cfg.occlusion_reach * scene.diagonal + 2.0 * cfg.light_radius * drop
    thrown = np.stack([low[:2], high[:2]]) - light[:2] * drop
    least = np.minimum(low[:2], thrown.min(axis=0)) - reach
    most = np.maximum(high[:2], thrown.max(axis=0)) + reach
    fall = height - float(camera.position[2])
    place = np.flatnonzero(free & (rays[:, 2] * fall > 0))
    points = camera.position.astype(np.float32) + rays[place] * (fall / rays[place, 2:])
    near = ((points[:, :2] > least) & (points[:, :2] < most)).all(axis=1)
    return place[near], points[near]


def free_light(
    scene: Scene, samples: Samples, cells: np.ndarray, light: Light, cfg: RenderConfig
) -> Float[np.ndarray, "N 2"]:
    """Free fraction of the sky and of the key light, each sample with the rays of its tile cell."""
    origins = samples.points + samples.geometric * np.float32(2e-4 * scene.diagonal)
    occluded = partial(are_occluded, scene)
    free = np.zeros((len(origins), 2), dtype=np.float32)
    reach = cfg.occlusion_reach * scene.diagonal
    free[:, 0] = unoccluded_fraction(origins, samples.normals, cells, light.sky_rays, reach, occluded)
    lit = np.flatnonzero((samples.normals @ light.direction > 0) & (samples.geometric @ light.direction > 0))
    lamps = np.broadcast_to(light.direction, (len(lit), 3))
    reach = 100.0 * scene.diagonal
    free[lit, 1] = unoccluded_fraction(origins[lit], lamps, cells[lit], light.key_rays, reach, occluded)
    return free


def gather_light(
    scene: Scene, samples: Samples, shape: tuple[int, int], light: Light, cfg: RenderConfig
) -> Grid:
    row, column = np.divmod(samples.place, shape[1])
    cells = (row % TILE) * TILE + column % TILE
    free = np.zeros((*shape, 2), dtype=np.float32)
    normals = np.zeros((*shape, 3), dtype=np.float32)
    label = np.full(shape, NOTHING)
    free[row, column] = free_light(scene, samples, cells, light, cfg)
    normals[row, column], label[row, column] = samples.normals, samples.label
    smooth = tile_average(tile_average(free, normals, label), normals, label)
    for stride in STRIDES:
        smooth = tile_average(smooth, normals, label, stride=stride, alike=ALIKE)
    return Grid(label=label, normals=normals, visible=smooth)


def shade_samples(
    samples: Samples, visible: Float[np.ndarray, "N 2"], light: Light, camera: Camera
) -> Float[np.ndarray, "N 3"]:
    """Linear colours of samples, given the free fraction of sky and key light at each.

    The floor shows only the shadow of the object, so that it has no horizon, and fades out towards the border
    of the picture.
    """
    metal = samples.gloss[:, 1:2]
    matte = samples.albedo * (1.0 - metal)
    colors = shade(matte, samples.normals, -samples.rays, light.direction, visible, light.ambient)
    eye = -samples.rays / np.sqrt(dot_rows(samples.rays, samples.rays))[:, None]
    colors += mirror_light(samples.albedo, samples.gloss, samples.normals, eye, light.direction, visible)
    floor = np.flatnonzero(samples.label == GROUND)
    seen = project_points(camera, samples.points[floor].astype(np.float64))[:, :2]
    size = np.array([camera.width, camera.height])
    inward = np.clip(np.minimum(seen, size - seen).min(axis=1) / (FADE * size.min()), 0.0, 1.0)
    darkness = (1.0 - visible[floor]) @ np.array(FLOOR_SHADE) * (inward**2 * (3.0 - 2.0 * inward))
    colors[floor] = light.background * (1.0 - darkness)[:, None]
    return np.minimum(colors, 1.0)  # else one bright ray would outshine all others of an edge


def lay_over(
    colors: Sequence[Float[np.ndarray, "N 3"]],
    layers: Sequence[Samples],
    background: Float[np.ndarray, "3"],
    count: int,
) -> Float[np.ndarray, "R 3"]:
    """Composites layers of samples, the nearest first, over a background."""
    picture, left = np.zeros((count, 3), dtype=np.float32), np.ones((count, 1), dtype=np.float32)
    for color, samples in zip(colors, layers, strict=True):
        cover = samples.cover[:, None]
        picture[samples.place] += left[samples.place] * cover * color
        left[samples.place] *= 1.0 - cover
    return picture + left * background


def borrow_light(
    scene: Scene,
    samples: Samples,
    grid: Grid,
    at: tuple[np.ndarray, np.ndarray],
    light: Light,
    cfg: RenderConfig,
) -> Float[np.ndarray, "N 2"]:
    """Light at samples inside pixels ``at``: the mean over nearby pixels that show the same surface.

    A sample without such a neighbour casts its own rays.
    """
    # One gather per neighbour: label, normal and light side by side.
    packed = np.concatenate([grid.label[..., None].astype(np.float32), grid.normals, grid.visible], axis=2)
    total = np.zeros((len(samples.place), 2), dtype=np.float32)
    weight = np.zeros((len(samples.place), 1), dtype=np.float32)
    for down, across in np.ndindex(3, 3):
        row = np.clip(at[0] + down - 1, 0, grid.label.shape[0] - 1)
        column = np.clip(at[1] + across - 1, 0, grid.label.shape[1] - 1)
        there = packed[row, column]
        same = (dot_rows(there[:, 1:4], samples.normals) > 0.9) & (there[:, 0] == samples.label)
        total += there[:, 4:] * same[:, None]
        weight += same[:, None]
    alone = np.flatnonzero(weight[:, 0] == 0)
    chosen = Samples(**{name: value[alone] for name, value in vars(samples).items()})
    total[alone] = free_light(scene, chosen, samples.place[alone] % TILE**2, light, cfg)
    return total / np.maximum(weight, 1.0)
