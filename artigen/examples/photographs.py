"""Renders condition pictures of procedural and real objects from near their front."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from artigen.appearance.photographs import NOTHING
from artigen.datasets.partnet_surface import FaceTable, join_tables
from artigen.examples.mesh_pictures import FINE, pack_picture, picture_mesh
from artigen.shapes.primitives import Vector, place_vertices
from artigen.shapes.render import Cameras, build_scene, frame_points, render
from artigen.shapes.shape import Shape

NEAR_FRONT = (0.6, 0.25)
"""Largest yaw to either side and largest pitch of the camera (radians): pictures are near-frontal."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Photograph:
    """A picture of a closed object, and the parts that it shows."""

    rgba: UInt8[np.ndarray, "H W 4"]
    """Premultiplied on black."""
    parts: UInt8[np.ndarray, "H W"]
    """Part at the centre of each pixel, `NOTHING` where there is none."""


def draw_camera(points: Float[np.ndarray, "N 3"], seed: int, size: int) -> Cameras:
    """A camera near the front with all points in view, as a batch of one."""
    rng = np.random.default_rng([seed, 1])
    turn, lift = rng.uniform(-NEAR_FRONT[0], NEAR_FRONT[0]), rng.uniform(0.0, NEAR_FRONT[1])
    return frame_points(points, find_direction(turn, lift), width=size, height=size)


def find_direction(turn: float, lift: float) -> Vector:
    """Unit direction from an object to a camera at yaw ``turn`` and pitch ``lift`` to its front (radians)."""
    level = np.cos(lift)
    return float(-np.cos(turn) * level), float(np.sin(turn) * level), float(np.sin(lift))


def photograph_shape(
    shape: Shape, seed: int, size: int, owners: Int[np.ndarray, "P"] | None = None
) -> Photograph:
    """Renders a procedural object, closed.

    Args:
        owners: Number that stands for each part of the shape in the picture; its own index when None.
    """
    points = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
    camera = draw_camera(points, seed, size)
    seen = render(build_scene([shape]), camera, [np.zeros(len(shape.parts))])
    mask = seen.mask[0].numpy()
    names = np.arange(len(shape.parts)) if owners is None else owners
    return Photograph(
        rgba=pack_picture(seen.rgb[0].numpy(), mask), parts=_mark(names, seen.part_ids[0].numpy(), mask)
    )


def photograph_mesh(
    tables: Sequence[FaceTable], scale: float, seed: int, size: int, owners: Int[np.ndarray, "F"]
) -> Photograph:
    """Renders a textured mesh.

    Args:
        owners: Part of each face, counted over all tables.

    Raises:
        SourceError: If an image of a material cannot be decoded.
    """
    vertices, faces = join_tables(tables)
    vertices = scale * vertices
    camera = draw_camera(vertices[np.unique(faces)], seed, FINE * size)
    seen = picture_mesh(tables, scale, camera)
    return Photograph(rgba=seen.rgba, parts=_mark(owners, seen.faces, seen.faces >= 0))


def _mark(
    names: Int[np.ndarray, "N"], seen: Int[np.ndarray, "H W"], mask: Bool[np.ndarray, "H W"]
) -> UInt8[np.ndarray, "H W"]:
    """Part number per pixel, `NOTHING` at the background; numbers too large for a byte count as nothing."""
    return np.where(mask, np.minimum(names[seen], NOTHING), NOTHING).astype(np.uint8)
