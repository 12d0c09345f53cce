"""Patterns of floors, walls and cloth as images that repeat: functions of the place in metres."""

from functools import lru_cache
from typing import Literal

import numpy as np
from jaxtyping import Float, UInt8
from scipy.ndimage import gaussian_filter

from artigen.shapes.surfaces.noise import hash_unit, lattice_noise

Pattern = Literal["plain", "planks", "tiles", "small_tiles", "wall_tiles", "stone", "wood", "cloth", "sky"]
Color = tuple[float, float, float]
PIXELS = 250
"""Pixels per metre; a joint is one of them wide."""
BOARDS: dict[Pattern, tuple[float, float]] = {"planks": (1.2, 0.14), "wood": (0.6, 0.04)}
"""Length and width (m) of boards of floors and of worktops."""
TILE_EDGES: dict[Pattern, tuple[float, float]] = {
    "tiles": (0.45, 0.45),
    "small_tiles": (0.2, 0.1),
    "wall_tiles": (0.4, 0.2),
}
"""Length and height (m) of tiles."""
PERIODS: dict[Pattern, tuple[float, float]] = {
    "planks": (4.8, 1.96), "wood": (2.4, 0.64), "tiles": (3.6, 3.6), "small_tiles": (1.6, 1.6),
    "wall_tiles": (3.2, 3.2),     "stone": (1.2, 1.2), "cloth": (0.16, 0.16), "sky": (1.0, 2.6),
}  # fmt: skip
"""Width and height (m) after which a pattern repeats: a whole number of its boards or tiles."""


@lru_cache(maxsize=64)
def paint_pattern(pattern: Pattern, color: Color) -> UInt8[np.ndarray, "H W 3"]:
    """One period of a pattern in a colour (sRGB in [0, 1]); rows run top to bottom, from the period's height
    to 0.

    Boards lie along the width, each in a tone and with a grain of its own; courses of small tiles are shifted
    by half a tile.
    """
    width, height = PERIODS[pattern]
    columns, rows = round(width * PIXELS), round(height * PIXELS)
    x = np.tile((np.arange(columns) + 0.5) / PIXELS, (rows, 1))
    y = np.tile((rows - np.arange(rows) - 0.5)[:, None] / PIXELS, (1, columns))
    if pattern in BOARDS:
        shade = _boards(x, y, *BOARDS[pattern], width)
    elif pattern in TILE_EDGES:
        shade = _tiles(x, y, *TILE_EDGES[pattern], width)
    elif pattern == "stone":
        shade = _speckles((rows, columns))
    elif pattern == "cloth":
        shade = 0.95 + 0.05 * np.sin(2 * np.pi * x / 0.02) * np.sin(2 * np.pi * y / 0.02)
    else:
        shade = np.clip(1.15 - 0.2 * y / height, 0.0, None)
    return np.round(255.0 * np.clip(shade[..., None] * np.array(color), 0.0, 1.0)).astype(np.uint8)


def _boards(
    x: Float[np.ndarray, "H W"], y: Float[np.ndarray, "H W"], length: float, width: float, period: float
) -> Float[np.ndarray, "H W"]:
    row = np.floor(y / width).astype(np.int32)
    along = x + length * hash_unit(np, row)
    number = (np.floor(along / length).astype(np.int32) % round(period / length)) + 101 * row
    own = hash_unit(np, number)
    grain = lattice_noise(np, number, np.float32((along % length) * 3.0), np.float32((y + 7.0 * own) * 90.0))
    joints = np.where(_is_joint(along, length) | _is_joint(y, width), 0.55 if width > 0.1 else 0.85, 1.0)
    return (0.86 + 0.22 * own + 0.12 * (grain - 0.5)) * joints


def _tiles(
    x: Float[np.ndarray, "H W"], y: Float[np.ndarray, "H W"], length: float, height: float, period: float
) -> Float[np.ndarray, "H W"]:
    row = np.floor(y / height).astype(np.int32)
    along = x + (0.5 * length * (row % 2) if height < length else 0.0)
    number = np.floor(along / length).astype(np.int32) % round(period / length)
    tone = 0.98 + 0.04 * hash_unit(np, number + 101 * row)
    return np.where(_is_joint(along, length) | _is_joint(y, height), 0.78, tone)


def _speckles(shape: tuple[int, int]) -> Float[np.ndarray, "H W"]:
    """Grains of three millimetres to a centimetre."""
    noise = np.random.default_rng(5).standard_normal((2, *shape))
    fine, coarse = (
        gaussian_filter(layer, sigma, mode="wrap") for layer, sigma in zip(noise, (1.0, 2.5), strict=True)
    )
    return 0.98 + 0.09 * np.tanh(2.0 * fine / fine.std()) * (coarse > 0.3 * coarse.std())


def _is_joint(place: Float[np.ndarray, "H W"], pitch: float) -> np.ndarray:
    """Whether places are within half a pixel of a multiple of the pitch."""
    return np.abs((place + pitch / 2.0) % pitch - pitch / 2.0) < 0.5 / PIXELS + 1e-9
