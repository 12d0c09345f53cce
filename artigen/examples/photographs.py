"""Renders condition pictures of procedural and real objects from near their front."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, UInt8

from artigen.camera import Camera, frame_points
from artigen.datasets.partnet_surface import FaceTable, join_tables
from artigen.examples.mesh_pictures import FINE, pack_picture, picture_mesh
from artigen.shapes.primitives import Vector, place_vertices
from artigen.shapes.render import batch_cameras, build_scene, render
from artigen.shapes.shape import Shape

NEAR_FRONT = (0.6, 0.25)
"""Largest yaw to either side and largest pitch of the camera (radians): pictures are near-frontal."""


def draw_camera(points: Float[np.ndarray, "N 3"], seed: int, size: int) -> Camera:
    """A camera near the front with all points in view."""
    rng = np.random.default_rng([seed, 1])
    turn, lift = rng.uniform(-NEAR_FRONT[0], NEAR_FRONT[0]), rng.uniform(0.0, NEAR_FRONT[1])
    return frame_points(points, find_direction(turn, lift), width=size, height=size)


def find_direction(turn: float, lift: float) -> Vector:
    """Unit direction from an object to a camera at yaw ``turn`` and pitch ``lift`` to its front (radians)."""
    level = np.cos(lift)
    return float(-np.cos(turn) * level), float(np.sin(turn) * level), float(np.sin(lift))


def photograph_shape(shape: Shape, seed: int, size: int) -> UInt8[np.ndarray, "H W 4"]:
    """A picture of a procedural object, closed: RGBA, premultiplied on black."""
    points = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
    camera = draw_camera(points, seed, size)
    seen = render(build_scene([shape]), batch_cameras([camera]), [np.zeros(len(shape.parts))])
    return pack_picture(seen.rgb[0].numpy(), seen.mask[0].numpy())


def photograph_mesh(
    tables: Sequence[FaceTable], scale: float, seed: int, size: int
) -> UInt8[np.ndarray, "H W 4"]:
    """A picture of a textured mesh: RGBA, premultiplied on black.

    Raises:
        SourceError: If an image of a material cannot be decoded.
    """
    vertices, faces = join_tables(tables)
    vertices = scale * vertices
    camera = draw_camera(vertices[np.unique(faces)], seed, FINE * size)
    return picture_mesh(tables, scale, camera)
