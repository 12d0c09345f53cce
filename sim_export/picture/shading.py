"""Light for the ray caster: textures, smooth normals, a soft key light and ambient occlusion.

Functions operate on flat arrays of hit points. Light is linear; sRGB is converted by the tables here. Random
directions come from one low-discrepancy set, distributed over a small tile of pixels and averaged over the
same tile afterwards, so that few rays give a smooth, repeatable picture.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.splats.colors import linear_from_srgb

TILE = 4
"""Edge of the tile of pixels over which directions are spread and then averaged."""

Occluded = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""(origins, directions, reach in units of the direction) -> True where something is hit."""

LINEAR_OF_BYTE = linear_from_srgb(np.arange(256) / 255.0).astype(np.float32)
SHARE_OF_BYTE = (np.arange(256) / 255.0).astype(np.float32)


def sphere_points(count: int, seed: int) -> Float[np.ndarray, "K 3"]:
    """Evenly spread unit vectors: an additive low-discrepancy sequence, shifted by ``seed``."""
    shift = np.random.default_rng(seed).uniform(size=2)
    golden = 1.32471795724474602596
    u, v = (np.outer([1.0 / golden, 1.0 / golden**2], np.arange(1, count + 1)) + shift[:, None]) % 1.0
    height, angle = 2.0 * u - 1.0, 2.0 * np.pi * v
    radius = np.sqrt(1.0 - height**2)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1).astype(np.float32)


def dot_rows(a: Float[np.ndarray, "*S 3"], b: Float[np.ndarray, "*S 3"]) -> Float[np.ndarray, "*S"]:
    """Scalar product of matching vectors; several times faster than `einsum` for such short rows."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def blend_corners(
    values: Float[np.ndarray, "N 3 C"], weights: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "N C"]:
    """Weighted sums over the three corners of triangles."""
    return values[:, 0] * weights[:, :1] + values[:, 1] * weights[:, 1:2] + values[:, 2] * weights[:, 2:]


def sample_texture(
    texture: UInt8[np.ndarray, "H W 3"], uv: Float[np.ndarray, "N 2"], *, repeat: bool
) -> Float[np.ndarray, "N 3"]:
    """Bilinear lookup as linear light; ``uv`` has its origin at the lower left.

    Coordinates outside [0, 1] repeat the texture, or are clamped to its edge.
    """
    return _look_up(LINEAR_OF_BYTE, texture, uv, repeat=repeat)


def halve_texture(texture: UInt8[np.ndarray, "H W C"]) -> tuple[UInt8[np.ndarray, "H W C"], ...]:
    """A texture, and its halves until a side is a single texel; each texel is the mean of four."""
    levels = [texture]
    while min(levels[-1].shape[:2]) > 1:
        last = levels[-1]
        even = last[: last.shape[0] // 2 * 2, : last.shape[1] // 2 * 2].astype(np.float32)
        mean = (even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2]) / 4.0
        levels.append(np.rint(mean).astype(np.uint8))
    return tuple(levels)


def sample_cover(
    alpha: UInt8[np.ndarray, "H W"], uv: Float[np.ndarray, "N 2"], *, repeat: bool
) -> Float[np.ndarray, "N"]:
    """Bilinear lookup of a texture's opacity, in [0, 1]."""
    return _look_up(SHARE_OF_BYTE, alpha[..., None], uv, repeat=repeat)[:, 0]


def _look_up(
    values: Float[np.ndarray, "256"],
    texture: UInt8[np.ndarray, "H W C"],
    uv: Float[np.ndarray, "N 2"],
    *,
    repeat: bool,
) -> Float[np.ndarray, "N C"]:
    """Bilinear interpolation of values assigned to the bytes of a texture."""
    height, width = texture.shape[:2]
    x, y = uv[:, 0] * width - 0.5, (1.0 - uv[:, 1]) * height - 0.5
    x0, y0 = np.floor(x), np.floor(y)
    fx, fy = (x - x0)[:, None].astype(np.float32), (y - y0)[:, None].astype(np.float32)
    columns = np.stack([x0, x0 + 1]).astype(np.int64)
    rows = np.stack([y0, y0 + 1]).astype(np.int64)
    columns = columns % width if repeat else np.clip(columns, 0, width - 1)
    rows = rows % height if repeat else np.clip(rows, 0, height - 1)
    texel = values[texture[rows[:, None], columns[None, :]]]  # row column N C
    top = texel[0, 0] + (texel[0, 1] - texel[0, 0]) * fx
    bottom = texel[1, 0] + (texel[1, 1] - texel[1, 0]) * fx
    return top + (bottom - top) * fy


def unoccluded_fraction(
    points: Float[np.ndarray, "N 3"],
    centers: Float[np.ndarray, "N 3"],
    cells: Int[np.ndarray, "N"],
    samples: Float[np.ndarray, "K 3"],
    reach: float,
    occluded: Occluded,
) -> Float[np.ndarray, "N"]:
    """Fraction of free rays among ``centers + samples``; ``cells`` selects the samples of a tile cell.

    With a unit normal as centre and unit samples, the directions follow the cosine law.
    """
    per_cell = len(samples) // TILE**2
    free = np.zeros(len(points), dtype=np.float32)
    for step in range(per_cell):
        directions = centers + samples[cells + step * TILE**2]
        lengths = np.sqrt(dot_rows(directions, directions))
        limits = (reach / np.maximum(lengths, 1e-3)).astype(np.float32)
        free += ~occluded(points, directions, limits)
    return free / max(per_cell, 1)


def tile_average(
    values: Float[np.ndarray, "H W C"],
    normals: Float[np.ndarray, "H W 3"],
    labels: Int[np.ndarray, "H W"],
    *,
    stride: int = 1,
    alike: float = np.inf,
) -> Float[np.ndarray, "H W C"]:
    """Averages each pixel with its tile neighbours of the same label and a similar normal.

    Args:
        stride: Pixels from one neighbour to the next.
        alike: Difference of values up to which a neighbour counts, the less the more they differ.
    """
    guide = normals
    for axis in (0, 1):
        total = values.copy()
        weight = np.ones_like(values)
        for shift in range(-(TILE // 2) + 1, TILE // 2 + 1):
            if shift == 0:
                continue
            here, there = _shifted(shift * stride, axis)
            near = labels[here] == labels[there]
            near &= dot_rows(guide[here], guide[there]) > 0.9
            same = near[..., None] * np.maximum(1.0 - ((values[here] - values[there]) / alike) ** 2, 0.0)
            total[here] += values[there] * same
            weight[here] += same
        values = total / weight
    return values


def _shifted(shift: int, axis: int) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    near = slice(max(0, -shift), -shift if shift > 0 else None)
    far = slice(max(0, shift), shift if shift < 0 else None)
    whole = slice(None)
    return ((near, whole), (far, whole)) if axis == 0 else ((whole, near), (whole, far))


def orient_to_viewer(
    normals: Float[np.ndarray, "N 3"], geometric: Float[np.ndarray, "N 3"], rays: Float[np.ndarray, "N 3"]
) -> tuple[Float[np.ndarray, "N 3"], Float[np.ndarray, "N 3"]]:
    """Two-sided shading: normalises both normals of each hit and orients them against its ray."""
    length = np.sqrt(dot_rows(geometric, geometric))[:, None]
    geometric = geometric / np.maximum(length, 1e-20)
    geometric = np.where(dot_rows(geometric, rays)[:, None] > 0, -geometric, geometric)
    size = np.sqrt(dot_rows(normals, normals))[:, None]
    normals = np.where(size > 1e-6, normals / np.maximum(size, 1e-20), geometric)
    normals = np.where(dot_rows(normals, geometric)[:, None] < 0, -normals, normals)
    return normals, geometric


def shade(
    albedo: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    towards_eye: Float[np.ndarray, "N 3"],
    light: Float[np.ndarray, "3"],
    visible: Float[np.ndarray, "N 2"],
    ambient: Float[np.ndarray, "2 3"],
) -> Float[np.ndarray, "N 3"]:
    """Diffuse light from the sky, a key light and a weak lamp at the camera.

    ``ambient`` is the light from above and from below, ``visible`` contains the free fraction of sky and of
    key light. A fifth of the sky's light arrives everywhere, to approximate interreflection in corners.
    """
    sky, key = 0.2 + 0.8 * visible[:, :1], visible[:, 1:]
    height = 0.5 + 0.5 * normals[:, 2:]
    around = ambient[0] * height + ambient[1] * (1.0 - height)
    facing = np.clip(normals @ light, 0.0, None)[:, None]
    lamp = 0.12 * np.abs(dot_rows(normals, towards_eye))[:, None]
    received = around * sky + np.array([0.58, 0.56, 0.53]) * facing * key + lamp * (0.4 + 0.6 * sky)
    return (albedo * received).astype(np.float32)
