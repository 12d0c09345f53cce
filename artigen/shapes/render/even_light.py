"""Mean colours of surface in even light, for appearance that does not depend on the camera."""

import numpy as np
import torch
from jaxtyping import Float, Int

from artigen.shapes.render.shading import EVEN_LIGHT, Light, Material, linear_from_srgb, shade
from artigen.shapes.shape import Shape
from artigen.shapes.surfaces.textures import apply_paint, find_rows, make_paint

OPENNESS = 0.95
"""Mean share of the light of a room that corners leave of it (`Light.open`)."""
SLANT = np.radians(45.0)
"""Angle between the normal and the directions of view over which colours are averaged."""
TURNS = 6
"""Number of these directions."""


def light_evenly(
    shape: Shape,
    owners: Int[np.ndarray, "N"],
    points: Float[np.ndarray, "N 3"],
    frames: Float[np.ndarray, "N 3 3"],
    *,
    footprint: float,
) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
    """Opacity of surface, and its colour (linear) in even light from all around.

    The colour of glass includes what it mirrors, as if its own surface sent it out.

    Args:
        shape: The object.
        owners: Primitive of each point, counted through all parts.
        points: Metres, object frame at rest.
        frames: Columns: two unit vectors along the surface, and the outward normal.
        footprint: Patterns finer than this (m) are omitted.
    """
    table, normals = make_paint(shape), frames[:, :, 2]
    rows = find_rows(table, owners, normals)
    color = torch.from_numpy(apply_paint(table, rows, points, normals, footprint=footprint)).double()
    material = Material(
        color=linear_from_srgb(color),
        kind=torch.from_numpy(table.kind[rows]),
        gloss=torch.from_numpy(table.gloss[rows]),
        opacity=torch.from_numpy(table.opacity[rows]),
    )
    every, axes = torch.ones(len(rows), dtype=torch.float64), torch.from_numpy(frames)
    light, total = Light(lamp=every, sky=every, open=OPENNESS * every), torch.zeros_like(color)
    for turn in np.arange(TURNS) * (2 * np.pi / TURNS):
        aside = (np.sin(SLANT) * np.cos(turn), np.sin(SLANT) * np.sin(turn))
        toward = axes @ axes.new_tensor([*aside, np.cos(SLANT)])
        scattered, mirrored = shade(axes[:, :, 2], -toward, material, light, EVEN_LIGHT)
        total += (scattered + mirrored / material.opacity[:, None]) / TURNS
    return table.opacity[rows].astype(np.float64), total.clamp(0.0, 1.0).numpy()
