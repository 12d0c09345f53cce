"""Pictures that examples are conditioned on: procedural and real objects alike, from near their front."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, UInt8

from artigen.datasets.partnet_surface import FaceTable
from artigen.shapes.primitives import place_vertices
from artigen.shapes.render import Cameras, build_scene, frame_points, render
from artigen.shapes.shape import Shape
from artigen.train.mesh_pictures import FINE, join_tables, pack_picture, picture_mesh

NEAR_FRONT = (0.6, 0.25)
"""Largest turn to either side and largest lift of the camera (radians): pictures are near-frontal."""


def draw_camera(points: Float[np.ndarray, "N 3"], seed: int, size: int) -> Cameras:
    """A camera near the front from which all points are seen, as a batch of one.

    Args:
        points: Corners of the object (m).
        seed: Decides the direction.
        size: Edge of the picture in pixels.
    """
    rng = np.random.default_rng([seed, 1])
    turn, lift = rng.uniform(-NEAR_FRONT[0], NEAR_FRONT[0]), rng.uniform(0.0, NEAR_FRONT[1])
    direction = (
        float(-np.cos(turn) * np.cos(lift)),
        float(np.sin(turn) * np.cos(lift)),
        float(np.sin(lift)),
    )
    return frame_points(points, direction, width=size, height=size)


def photograph_shape(shape: Shape, seed: int, size: int) -> UInt8[np.ndarray, "H W 4"]:
    """A procedural object, closed; RGBA, premultiplied on black."""
    points = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
    camera = draw_camera(points, seed, size)
    seen = render(build_scene([shape]), camera, [np.zeros(len(shape.parts))])
    return pack_picture(seen.rgb[0].numpy(), seen.mask[0].numpy())


def photograph_mesh(
    tables: Sequence[FaceTable], scale: float, seed: int, size: int
) -> UInt8[np.ndarray, "H W 4"]:
    """A textured mesh as it is placed; RGBA, premultiplied on black.

    Args:
        tables: Triangles in the unit cube with their materials.
        scale: Metres per unit-cube length.
        seed: Decides the direction of the camera.
        size: Edge of the picture in pixels.

    Raises:
        SourceError: If an image of a material cannot be decoded.
    """
    vertices, faces = join_tables(tables, scale)
    camera = draw_camera(vertices[np.unique(faces)], seed, FINE * size)
    return picture_mesh(tables, scale, camera)
