"""Mean colours of surface in even light, for appearance that does not depend on the camera."""

import numpy as np
import torch
from jaxtyping import Float, Int

from artigen.shapes.poses import joint_ranges, pose_parts
from artigen.shapes.render.shading import (
    EVEN_LIGHT,
    Light,
    Material,
    linear_from_srgb,
    shade,
    srgb_from_linear,
)
from artigen.shapes.shape import Shape
from artigen.shapes.solids import primitive_parts
from artigen.shapes.surfaces.textures import apply_paint, find_rows, make_paint

OPENNESS = 0.95
"""Mean share of the light of a room that corners leave of it (`Light.open`)."""
SLANT = np.radians(45.0)
"""Angle between the normal and the directions of view over which colours are averaged."""
TURNS = 6
"""Number of these directions; each sees another state of the joints, from closed to open."""


def light_evenly(
    shape: Shape,
    owners: Int[np.ndarray, "N"],
    points: Float[np.ndarray, "N 3"],
    frames: Float[np.ndarray, "N 3 3"],
    *,
    footprint: float,
) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
    """Opacity of surface, and its colour (linear) in even light, the mean over the ranges of all joints.

    The colour of glass includes what it mirrors, as if its own surface sent it out. Its opacity is that by
    which blending display values, as Gaussians are blended, shows black and white behind it as they are.

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
    every = torch.ones(len(rows), dtype=torch.float64)
    light, total = Light(lamp=every, sky=every, open=OPENNESS * every), torch.zeros_like(color)
    part, ranges = primitive_parts(shape)[owners], joint_ranges(shape)
    for number in range(TURNS):
        turn = 2 * np.pi * number / TURNS
        moved = pose_parts(shape, number / (TURNS - 1) * ranges)[:, :3, :3]
        axes = torch.from_numpy(moved[part] @ frames)
        aside = (np.sin(SLANT) * np.cos(turn), np.sin(SLANT) * np.sin(turn))
        toward = axes @ axes.new_tensor([*aside, np.cos(SLANT)])
        scattered, mirrored = shade(axes[:, :, 2], -toward, material, light, EVEN_LIGHT)
        total += (material.opacity[:, None] * scattered + mirrored) / TURNS
    dark, bright = (srgb_from_linear(total + behind) for behind in (0.0, 1.0 - material.opacity[:, None]))
    opacity = 1.0 - (bright - dark).mean(dim=1)
    color = linear_from_srgb((dark / opacity[:, None]).clamp(max=1.0))
    return opacity.numpy(), color.numpy()
