"""Renders any textured mesh, with a shadow map per light.

The shading is that of procedural objects (`artigen.shapes.render`), so pictures of both look alike.
"""

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import Bool, Float, Int, UInt8

from artigen.camera import Camera, frame_points, project_points
from artigen.datasets.mesh_raster import SeenFaces, rasterize_mesh
from artigen.datasets.partnet_surface import FaceTable, join_tables, look_up_colors
from artigen.shapes.primitives import Vector
from artigen.shapes.render.cameras import batch_cameras
from artigen.shapes.render.lighting import CORNER, SKY
from artigen.shapes.render.rays import Surface
from artigen.shapes.render.shading import (
    Light,
    Material,
    RenderConfig,
    linear_from_srgb,
    shade,
    srgb_from_linear,
)
from artigen.shapes.render.shadows import find_openness
from artigen.shapes.surfaces.textures import KINDS

FINE = 3
"""Rays per pixel edge for meshes, whose textures are not filtered; odd, so that one is at the centre."""
SHADOW_EDGE = 384
"""Edge of the shadow map of a light, in pixels."""
SHADOW_FOV = 4.0
"""Angle of view of a light (degrees): so small that its rays are nearly parallel."""
SHADOW_OFFSET = 2.0
"""Offset of shadow tests from the surface, in pixels of the shadow map."""


def picture_mesh(tables: Sequence[FaceTable], scale: float, camera: Camera) -> UInt8[np.ndarray, "h w 4"]:
    """Renders a textured mesh through one camera: RGBA, premultiplied on black.

    Args:
        camera: In metres, with ``FINE`` times the width and height of the picture.

    Raises:
        SourceError: If an image of a material cannot be decoded.
    """
    vertices, faces = join_tables(tables)
    vertices = scale * vertices
    seen = rasterize_mesh(vertices, faces, camera)
    surface = _find_surface(vertices, faces, seen, camera)
    uv = np.einsum("nk,nkd->nd", seen.weights, np.concatenate([table.uv for table in tables])[seen.face])
    material = _matte(look_up_colors(tables, seen.face, uv))
    cfg = RenderConfig()
    light = Light(
        lamp=_find_lit(vertices, faces, surface, cfg.lamp),
        sky=_find_lit(vertices, faces, surface, SKY),
        open=find_openness(
            batch_cameras([camera]), surface, torch.zeros_like(surface.pixel), reach=CORNER, samples=10
        ),
    )
    scattered, mirrored = shade(surface.normal, surface.view, material, light, cfg)
    height, width = camera.height // FINE, camera.width // FINE
    fine = np.zeros((camera.height * camera.width, 4))
    fine[seen.pixel, :3] = srgb_from_linear(scattered + mirrored).numpy()
    fine[seen.pixel, 3] = 1.0
    cells = fine.reshape(height, FINE, width, FINE, 4).transpose(0, 2, 1, 3, 4).reshape(height, width, -1, 4)
    covered = cells[..., 3].sum(axis=2)
    rgb = cells[..., :3].sum(axis=2) / np.maximum(covered, 1.0)[..., None]
    return pack_picture(rgb, cells[..., FINE**2 // 2, 3] > 0)  # shown where a pixel's centre is


def _find_surface(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], seen: SeenFaces, camera: Camera
) -> Surface:
    """Surface for shading; normals face the camera, since source triangles have no reliable orientation."""
    corners = vertices[faces[seen.face]]
    point = np.einsum("nk,nkd->nd", seen.weights, corners)
    view = point - camera.position
    view /= np.linalg.norm(view, axis=1, keepdims=True)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    normal *= np.where((normal * view).sum(axis=1, keepdims=True) > 0, -1.0, 1.0)

    def tensor(values: np.ndarray) -> torch.Tensor:
        return torch.from_numpy(values).float()

    return Surface(
        pixel=torch.from_numpy(seen.pixel),
        instance=torch.zeros(len(seen.pixel), dtype=torch.int64),
        depth=tensor(seen.depth),
        point=tensor(point),
        normal=tensor(normal),
        view=tensor(view),
        rest_point=tensor(point),
        rest_normal=tensor(normal),
    )


def _matte(colors: UInt8[np.ndarray, "N 3"]) -> Material:
    """Materials of the given colours without gloss, which sources do not state reliably."""
    count = len(colors)
    return Material(
        color=linear_from_srgb(torch.from_numpy(colors.astype(np.float32) / 255.0)),
        kind=torch.full((count,), KINDS.index("lacquer")),
        gloss=torch.zeros(count),
        opacity=torch.ones(count),
    )


def _find_lit(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], surface: Surface, light: Vector
) -> Float[torch.Tensor, "N"]:
    """1 where a point is lit by a distant light, 0 in shadow."""
    corners = vertices[faces].reshape(-1, 3)
    camera = frame_points(corners, light, fov=SHADOW_FOV, width=SHADOW_EDGE, height=SHADOW_EDGE)
    seen = rasterize_mesh(vertices, faces, camera)
    nearest = np.full(SHADOW_EDGE**2, np.inf)
    nearest[seen.pixel] = seen.depth
    offset = SHADOW_OFFSET * camera.pixel * float(seen.depth.mean())
    lifted = surface.point.double().numpy() + offset * surface.normal.numpy()
    *screen, depth = project_points(camera, lifted).T
    column, row = np.clip(np.floor(screen), 0, SHADOW_EDGE - 1).astype(np.int64)
    lit: Bool[np.ndarray, "N"] = depth <= nearest[row * SHADOW_EDGE + column] + offset
    return torch.from_numpy(lit).float()


def pack_picture(
    rgb: Float[np.ndarray, "H W 3"], mask: Bool[np.ndarray, "H W"]
) -> UInt8[np.ndarray, "H W 4"]:
    """RGBA, premultiplied on black."""
    alpha = mask[..., None].astype(rgb.dtype)
    return np.round(255 * np.concatenate([rgb * alpha, alpha], axis=2)).astype(np.uint8)
