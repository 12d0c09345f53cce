"""Light that surfaces mirror: a key light and a studio around the object, by roughness and metal.

Light is linear, normals and directions are unit vectors. Reflection follows GGX with Schlick's Fresnel; that
of the studio uses Karis' fit of the split sum ("Physically based shading on mobile", 2014).
"""

import numpy as np
from jaxtyping import Float

from sim_export.picture.shading import dot_rows

BOXES = (
    ((-0.55, 0.62, 0.56), 0.10, 1.5),
    ((-0.25, -0.90, 0.35), 0.06, 0.8),
    ((0.75, 0.10, 0.65), 0.12, 0.5),
)
"""Soft boxes: direction towards each, its size (1 - cosine), and its light over that of the walls."""
FLOOR, HORIZON, SKY = 0.75, 0.46, 0.9
"""Light from straight below, from the horizon, and from straight above."""
LEAST = 0.12
"""Least roughness of the key light's reflection, as wide as the light."""


def mirror_light(
    albedo: Float[np.ndarray, "N 3"],
    gloss: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    towards_eye: Float[np.ndarray, "N 3"],
    light: Float[np.ndarray, "3"],
    visible: Float[np.ndarray, "N 2"],
) -> Float[np.ndarray, "N 3"]:
    """Mirrored light at points.

    Args:
        albedo: Base colours.
        gloss: Roughness, metallic, and the share that a dielectric mirrors head-on.
        normals: Towards the viewer.
        towards_eye: Unit vectors.
        light: Towards the key light.
        visible: Free fraction of the sky and of the key light.
    """
    rough, metal = gloss[:, :1], gloss[:, 1:2]
    head_on = (1.0 - metal) * gloss[:, 2:] + metal * albedo
    facing = np.clip(dot_rows(normals, towards_eye), 1e-3, 1.0)[:, None]
    mirrored = 2.0 * facing * normals - towards_eye
    scale, offset = _split_sum(rough, facing)
    around = studio_light(mirrored, rough) * (0.25 + 0.75 * visible[:, :1])
    return (
        around * (head_on * scale + offset)
        + _key(head_on, rough, normals, towards_eye, light) * visible[:, 1:]
    )


def studio_light(
    directions: Float[np.ndarray, "N 3"], rough: Float[np.ndarray, "N 1"]
) -> Float[np.ndarray, "N 1"]:
    """Light that arrives from around directions, blurred as a surface of a roughness does."""
    height = directions[:, 2:]
    blur = 0.12 + 0.9 * rough
    above = np.clip(0.5 + 0.5 * height / blur, 0.0, 1.0)
    wall = HORIZON + (SKY - HORIZON) * np.clip(height, 0.0, 1.0) ** 0.7
    ground = HORIZON + (FLOOR - HORIZON) * np.clip(-height, 0.0, 1.0) ** 0.5
    total = above * wall + (1.0 - above) * ground
    for towards, size, bright in BOXES:
        apart = 1.0 - directions @ (np.array(towards) / np.linalg.norm(towards))
        wide = size + 0.8 * rough**2
        total = total + bright * (size / wide) * np.exp(-((apart[:, None] / wide) ** 2))
    return total


def _split_sum(
    rough: Float[np.ndarray, "N 1"], facing: Float[np.ndarray, "N 1"]
) -> tuple[np.ndarray, np.ndarray]:
    """Factor of the light mirrored head-on, and what is added to it towards grazing angles."""
    x, y, z, w = 1.0 - rough, 0.0425 - 0.0275 * rough, 1.04 - 0.572 * rough, 0.022 * rough - 0.04
    share = np.minimum(x * x, np.exp2(-9.28 * facing)) * x + y
    return np.clip(z - 1.04 * share, 0.0, None), np.clip(w + 1.04 * share, 0.0, None)


def _key(
    head_on: Float[np.ndarray, "N 3"],
    rough: Float[np.ndarray, "N 1"],
    normals: Float[np.ndarray, "N 3"],
    towards_eye: Float[np.ndarray, "N 3"],
    light: Float[np.ndarray, "3"],
) -> Float[np.ndarray, "N 3"]:
    """The key light's reflection, for an irradiance of pi."""
    half = towards_eye + light
    half = half / np.maximum(np.sqrt(dot_rows(half, half))[:, None], 1e-6)
    across, facing = (np.clip(dot_rows(normals, way), 0.0, 1.0)[:, None] for way in (half, towards_eye))
    lit = np.clip(normals @ light, 0.0, 1.0)[:, None]
    alpha = np.maximum(rough, LEAST) ** 2
    lobe = (alpha / (across**2 * (alpha**2 - 1.0) + 1.0)) ** 2
    shadowed = (lit * (1 - alpha / 2) + alpha / 2) * (facing * (1 - alpha / 2) + alpha / 2)
    fresnel = head_on + (1.0 - head_on) * (1.0 - np.clip(dot_rows(towards_eye, half), 0.0, 1.0)[:, None]) ** 5
    return 0.5 * fresnel * lobe * lit / (4.0 * np.maximum(shadowed, 1e-4))
