"""Patterns of floors and walls as images: planks and tiles, functions of the place in metres."""

from typing import Literal

import numpy as np
from jaxtyping import Float, UInt8

from artigen.shapes.surfaces.noise import hash_unit, lattice_noise

Pattern = Literal["plain", "planks", "tiles", "small_tiles"]
PIXELS = 256
"""Pixels per metre."""
PLANK = (1.2, 0.14)
"""Length and width (m) of planks."""
TILE_EDGES: dict[Pattern, tuple[float, float]] = {"tiles": (0.45, 0.45), "small_tiles": (0.2, 0.1)}
"""Length and height (m) of tiles."""
GROUT = 0.003
"""Width (m) of joints."""


def paint_pattern(
    pattern: Pattern, color: tuple[float, float, float], width: float, height: float
) -> UInt8[np.ndarray, "H W 3"]:
    """An image of ``width`` by ``height`` metres in a colour (sRGB in [0, 1]); rows run top to bottom.

    Planks lie along the width, each in a tone and with a grain of its own; courses of tiles are shifted by
    half a tile where they are small.
    """
    columns, rows = max(round(width * PIXELS), 1), max(round(height * PIXELS), 1)
    x = np.tile((np.arange(columns) + 0.5) / PIXELS, (rows, 1))
    y = np.tile(((rows - np.arange(rows)) - 0.5)[:, None] / PIXELS, (1, columns))
    if pattern == "plain":
        shade = np.ones((rows, columns))
    elif pattern == "planks":
        shade = _planks(x, y)
    else:
        shade = _tiles(x, y, *TILE_EDGES[pattern], 0.5 if pattern == "small_tiles" else 0.0)
    return np.round(255.0 * np.clip(shade[..., None] * np.array(color), 0.0, 1.0)).astype(np.uint8)


def _planks(x: Float[np.ndarray, "H W"], y: Float[np.ndarray, "H W"]) -> Float[np.ndarray, "H W"]:
    length, width = PLANK
    row = np.floor(y / width).astype(np.int32)
    along = x + length * hash_unit(np, row)
    own = hash_unit(np, np.floor(along / length).astype(np.int32) + 101 * row)
    tone = 0.86 + 0.22 * own
    seed = np.full(x.shape, 5, np.int32)
    grain = lattice_noise(np, seed, np.float32(along * 3.0), np.float32((y + 7.0 * own) * 90.0))
    return (tone + 0.12 * (grain - 0.5)) * np.where(_is_joint(along, length) | _is_joint(y, width), 0.55, 1.0)


def _tiles(
    x: Float[np.ndarray, "H W"], y: Float[np.ndarray, "H W"], length: float, height: float, shift: float
) -> Float[np.ndarray, "H W"]:
    row = np.floor(y / height).astype(np.int32)
    along = x + shift * length * (row % 2)
    tone = 0.98 + 0.04 * hash_unit(np, np.floor(along / length).astype(np.int32) + 101 * row)
    return np.where(_is_joint(along, length) | _is_joint(y, height), 0.78, tone)


def _is_joint(place: Float[np.ndarray, "H W"], pitch: float) -> np.ndarray:
    """Whether places are within half a joint of a multiple of the pitch."""
    return np.abs((place + pitch / 2.0) % pitch - pitch / 2.0) < max(GROUT, 1.0 / PIXELS) / 2.0
