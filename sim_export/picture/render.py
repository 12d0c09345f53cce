"""A small ray caster for pictures of objects: CPU only, without a display, deterministic.

`render_scene` returns a shaded, antialiased picture.
Geometry is in metres in one frame; `move_surface` transforms it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float, UInt8

from artigen.camera import Camera, pixel_rays, rays_through
from artigen.splats.colors import srgb_from_linear
from artigen.transforms import transform_points, transform_vectors
from sim_export.geometry.normals import CREASE, corner_normals
from sim_export.package import Mesh
from sim_export.picture.lighting import (
    Grid,
    Light,
    RenderConfig,
    borrow_light,
    find_layers,
    gather_light,
    lay_over,
    prepare_light,
    shade_samples,
)
from sim_export.picture.raycast import Scene, Surface, build_scene

GOLDEN = 0.618033988749895


def surface_from_mesh(mesh: Mesh, *, surface_id: int = 0, crease: float = CREASE) -> Surface:
    """A mesh as a surface; edges flatter than ``crease`` (degrees) are shaded smoothly."""
    triangles = mesh.vertices[mesh.faces]
    uv, texture = mesh.uv, mesh.texture
    if mesh.material.opacity < 1.0:
        uv = np.full((len(mesh.faces), 3, 2), 0.5) if uv is None else uv
        pixel = np.rint(255.0 * np.array([[mesh.color]])).astype(np.uint8)
        texture = _make_clear(pixel if texture is None else texture, mesh.material.opacity)
    return Surface(
        triangles=triangles,
        normals=corner_normals(triangles, crease),
        id=surface_id,
        uv=None if texture is None and mesh.normal_map is None else uv,
        texture=texture,
        normal_map=mesh.normal_map,
        color=mesh.color,
        material=mesh.material,
    )


def _make_clear(texture: UInt8[np.ndarray, "H W C"], opacity: float) -> UInt8[np.ndarray, "H W 4"]:
    """A texture whose opacity is multiplied by that of its material."""
    alpha = texture[..., 3:] if texture.shape[2] == 4 else np.full((*texture.shape[:2], 1), 255)
    return np.concatenate([texture[..., :3], np.rint(opacity * alpha).astype(np.uint8)], axis=2)


def move_surface(surface: Surface, T: Float[np.ndarray, "4 4"]) -> Surface:
    """Applies the rigid motion ``T`` to a surface."""
    triangles = transform_points(T, surface.triangles)
    return replace(surface, triangles=triangles, normals=transform_vectors(T, surface.normals))


def surface_points(surfaces: Sequence[Surface]) -> Float[np.ndarray, "N 3"]:
    """All triangle corners, for framing."""
    return np.concatenate([np.zeros((0, 3)), *(surface.triangles.reshape(-1, 3) for surface in surfaces)])


def render_scene(
    surfaces: Sequence[Surface], camera: Camera, cfg: RenderConfig | None = None
) -> UInt8[np.ndarray, "H W 3"]:
    """A shaded, antialiased sRGB picture of the surfaces on a plain background.

    Light is computed once per pixel. Edge pixels are then resampled with ``edge_rays`` rays, which take the
    light of neighbouring pixels that show the same surface. Transparent surfaces show what is behind them but
    cast full shadows.
    """
    cfg = RenderConfig() if cfg is None else cfg
    scene = build_scene(surfaces)
    light = prepare_light(cfg)
    shape = (camera.height, camera.width)
    picture = np.tile(light.background, (*shape, 1))
    if scene.tree is not None:
        layers = find_layers(scene, camera, pixel_rays(camera).reshape(-1, 3), cfg)
        grids = [gather_light(scene, samples, shape, light, cfg) for samples in layers]
        colors = [
            shade_samples(samples, grid.visible.reshape(-1, 2)[samples.place], light, camera)
            for samples, grid in zip(layers, grids, strict=True)
        ]
        picture = lay_over(colors, layers, light.background, shape[0] * shape[1]).reshape(picture.shape)
        if cfg.edge_rays > 1:
            edges = _find_edges(picture, grids[0].label)
            picture[edges] = _refine(scene, camera, edges, grids, light, cfg)
    picture = np.clip(srgb_from_linear(np.minimum(picture, 1.0)), 0.0, 1.0)
    return np.round(255.0 * picture).astype(np.uint8)


def _find_edges(picture: np.ndarray, label: np.ndarray) -> np.ndarray:
    """Pixels whose colour differs visibly from a neighbour's, or that show another surface."""
    seen = np.sqrt(picture)
    edges = np.zeros(label.shape, dtype=bool)
    for near, far in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
        step = (np.abs(seen[near] - seen[far]).max(axis=2) > 0.035) | (
            (label[near] != label[far]) & (np.maximum(label[near], label[far]) >= 0)
        )
        edges[near] |= step
        edges[far] |= step
    return edges


def _refine(
    scene: Scene, camera: Camera, edges: np.ndarray, grids: list[Grid], light: Light, cfg: RenderConfig
) -> Float[np.ndarray, "E 3"]:
    """Colours of the edge pixels, each the mean of several rays; ``grids`` has the light of all layers."""
    rows, columns = np.nonzero(edges)
    # Rank-1 lattice: the rays of a pixel differ in all rows and all columns.
    steps = np.arange(cfg.edge_rays)
    across, along = (steps + 0.5) / cfg.edge_rays, (steps * GOLDEN + 0.5 / cfg.edge_rays) % 1.0
    rays = rays_through(camera, columns[:, None] + across, rows[:, None] + along).reshape(-1, 3)
    layers, colors = find_layers(scene, camera, rays, cfg), []
    for number, samples in enumerate(layers):
        owner, grid = samples.place // cfg.edge_rays, grids[min(number, len(grids) - 1)]
        visible = borrow_light(scene, samples, grid, (rows[owner], columns[owner]), light, cfg)
        colors.append(shade_samples(samples, visible, light, camera))
    seen = lay_over(colors, layers, light.background, len(rays))
    return seen.reshape(-1, cfg.edge_rays, 3).mean(axis=1)
