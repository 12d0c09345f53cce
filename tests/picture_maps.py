"""Exact maps of surfaces at pixel centres: depth, and ids."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from artigen.camera import Camera, pixel_rays
from sim_export.picture.lighting import NOTHING
from sim_export.picture.raycast import Surface, build_scene, cast_rays, surface_ids_at


def render_depth(surfaces: Sequence[Surface], camera: Camera) -> Float[np.ndarray, "H W"]:
    """Depth (metres along the viewing direction) at pixel centres; infinite where nothing is hit."""
    hits = cast_rays(build_scene(surfaces), camera.position, pixel_rays(camera).reshape(-1, 3))
    depth = np.full(camera.height * camera.width, np.inf)
    depth[hits.place] = hits.depth
    return depth.reshape(camera.height, camera.width)


def render_ids(surfaces: Sequence[Surface], camera: Camera) -> Int[np.ndarray, "H W"]:
    """Surface id at pixel centres; -1 where nothing is hit."""
    scene = build_scene(surfaces)
    hits = cast_rays(scene, camera.position, pixel_rays(camera).reshape(-1, 3))
    ids = np.full(camera.height * camera.width, NOTHING)
    ids[hits.place] = surface_ids_at(scene, hits)
    return ids.reshape(camera.height, camera.width)
