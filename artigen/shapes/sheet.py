"""Contact sheets: pictures of shapes side by side, as in a catalogue."""

from collections.abc import Sequence
from math import ceil, hypot, sqrt

import numpy as np
from jaxtyping import Float, UInt8

from artigen.camera import frame_points
from artigen.shapes.poses import open_parts, place_posed
from artigen.shapes.primitives import Vector
from artigen.shapes.shape import Shape

EYES = 1.5
"""Height (m) of the camera above the floor on which the object stands."""
AWAY = 3.2
"""Distance (m) of the viewer, which determines the slope of the view."""
ASIDE = 0.52
"""Offset of the camera to the left of the object, relative to the distance in front of it."""


def draw_sheet(
    shapes: Sequence[Shape], opened: float, size: int = 320, *, columns: int | None = None
) -> UInt8[np.ndarray, "H W 3"]:
    """Shapes in rows, each seen from the front left at eye level.

    Args:
        shapes: At least one shape.
        opened: Share of its range by which every limited joint is open, 0 to 1.
        size: Edge of a picture in pixels.
        columns: Pictures per row; by default the sheet is about square.

    Raises:
        ValueError: If there is no shape.
    """
    if not shapes:
        raise ValueError("a sheet has at least one shape")
    columns = columns or ceil(sqrt(len(shapes)))
    tiles = [draw_picture(shape, open_parts(shape, opened), size) for shape in shapes]
    blank = np.full_like(tiles[0], 255)
    tiles += [blank] * (-len(tiles) % columns)
    rows = [np.concatenate(tiles[start : start + columns], axis=1) for start in range(0, len(tiles), columns)]
    return np.concatenate(rows, axis=0)


def draw_picture(shape: Shape, qpos: Float[np.ndarray, "Q"], size: int) -> UInt8[np.ndarray, "H W 3"]:
    """Renders one object at joint coordinates (one per part), on a bright floor in soft light."""
    from artigen.shapes.render import RenderConfig, batch_cameras, build_scene, render

    points = place_posed(shape, qpos)
    cfg = RenderConfig(floor=True, supersampling=2, shadow_rays=12)
    camera = frame_points(points, _view_of(points), width=size, height=size)
    rgb = render(build_scene([shape]), batch_cameras([camera]), [qpos], cfg=cfg).rgb[0]
    return np.round(255.0 * rgb.numpy()).astype(np.uint8)


def _view_of(points: Float[np.ndarray, "N 3"]) -> Vector:
    """Direction from the object to a viewer who looks down on its middle, and at least slightly on its
    top."""
    low, high = points[:, 2].min(), points[:, 2].max()
    table = low if high - low > 0.6 else low - 0.75  # small objects stand on a table
    drop = max(EYES - ((low + high) / 2 - table), 0.25)
    return (-AWAY / hypot(1.0, ASIDE), AWAY * ASIDE / hypot(1.0, ASIDE), float(drop))
