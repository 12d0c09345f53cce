"""Tiles: one image per finish with a pattern, and one of its normals, mapped by coordinates in metres.

A tile shows a square metre of its finish and repeats without seams: the pattern of
`artigen.shapes.surfaces.textures` on a torus. All parts of a finish share it, byte for byte and across
objects; every board has its own place on it, and grain runs along the board. One unit of texture coordinates
is one metre, whatever the finish, so that another finish needs no other coordinates.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.shapes.surfaces.finishes import Color, Finish, FinishKind
from artigen.shapes.surfaces.noise import hash_unit
from artigen.shapes.surfaces.physical import find_relief
from artigen.shapes.surfaces.textures import PaintTable, paint
from sim_export.geometry.triangles import area_normals

TEXELS = 1024
"""Texels of a tile along its edge of one metre."""
SEAM = 96
"""Texels over which a pattern fades into its beginning."""
BOARDS = 4
"""Boards of a wooden tile across its grain. They are glued edge to edge, so nothing fades there."""
BOARD_PERIODS = 6.0
"""Width of a board in periods of its wood, as the pattern draws it."""
LEVELS, TONES = 48, 5
"""Steps between colour and accent, and of brightness: a tile has at most their product of colours."""
DARKEST = 1
"""Darkest level of a texel; V106 treats black as missing."""
PATTERNED: frozenset[FinishKind] = frozenset({"wood", "steel", "stone"})
LEAST_CONTRAST = 0.03
"""Difference of colour and accent (sRGB, one channel) below which a finish has one colour."""


def find_color(finish: Finish) -> Color:
    """The mean colour (sRGB) of a finish."""
    share = 0.5 if finish.kind not in ("glass", "stone") else 0.0
    red, green, blue = (
        float(np.clip(a + share * (b - a), 0.0, 1.0))
        for a, b in zip(finish.color, finish.accent, strict=True)
    )
    return red, green, blue


def find_tile(finish: Finish) -> UInt8[np.ndarray, "H W 3"] | None:
    """The image of a square metre, grain along its rows; None for a finish of one colour."""
    contrast = max(abs(a - b) for a, b in zip(finish.color, finish.accent, strict=True))
    if finish.kind not in PATTERNED or contrast < LEAST_CONTRAST:
        return None
    return _color_tile(finish.kind, round(finish.period, 6), finish.color, finish.accent)


def find_normal_map(finish: Finish) -> UInt8[np.ndarray, "H W 3"] | None:
    """Normals on the tile of a finish, as its accent lies below its colour; None for a smooth finish.

    Channels are right, up and outwards, from -1 at 0 to 1 at 255, as glTF and MaterialX have them.
    """
    relief = find_relief(finish)
    return _draw_normals(finish.kind, round(finish.period, 6), relief) if relief else None


def lay_coordinates(
    triangles: Float[np.ndarray, "F 3 3"], rows: Int[np.ndarray, "F"], table: PaintTable
) -> Float[np.ndarray, "F 3 2"]:
    """Texture coordinates (m) of faces, flat along the axes of their board.

    Args:
        triangles: Corners (m) in the frame of the object.
        rows: Row of ``table`` that each face shows.
        table: The paint of the object, see `artigen.shapes.surfaces.textures.make_paint`.
    """
    axes = table.axes[rows].astype(np.float64)
    local = np.einsum("fcd,fkd->fck", triangles, axes)
    facing = np.abs(np.einsum("fd,fkd->fk", area_normals(triangles), axes)).argmax(axis=1)
    flat = np.take_along_axis(local, np.array([[1, 2], [0, 2], [0, 1]])[facing][:, None, :], axis=2)
    seeds = (table.seed[rows].astype(np.int64) + 31 * facing) % 2**31
    lots = np.stack([hash_unit(np, (seeds + k).astype(np.int32)) for k in (0, 1)], axis=1)
    # Whole metres of an offset change nothing; small numbers keep the digits of files.
    middle = np.floor(flat.mean(axis=1))
    return flat + lots[:, None, :] - middle[:, None, :]


@lru_cache(maxsize=64)
def _color_tile(kind: FinishKind, period: float, color: Color, accent: Color) -> UInt8[np.ndarray, "H W 3"]:
    mix, tone = _draw_pattern(kind, period, 1.0 / TEXELS)
    shades = np.linspace(0.0, 1.0, LEVELS)[:, None, None] * np.subtract(accent, color) + np.array(color)
    tones = np.linspace(0.94, 1.06, TONES)[:, None]
    colors = np.rint(255.0 * np.clip(shades * tones, 0.0, 1.0)).astype(np.uint8)  # level tone 3
    image = np.maximum(colors, DARKEST)[mix, tone]
    image.setflags(write=False)
    return image


@lru_cache(maxsize=8)
def _draw_normals(kind: FinishKind, period: float, relief: float) -> UInt8[np.ndarray, "H W 3"]:
    # Brushing is finer than texels: its lines are sampled, not averaged to an even surface.
    level, _ = _draw_pattern(kind, period, 0.0 if kind == "steel" else 1.0 / TEXELS)
    depth = relief / (LEVELS - 1) * level
    right, down = ((np.roll(depth, -1, axis) - np.roll(depth, 1, axis)) * TEXELS / 2 for axis in (1, 0))
    normals = np.stack([right, -down, np.ones_like(depth)], axis=2)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    image = np.rint(127.5 + 127.5 * normals).astype(np.uint8)
    image.setflags(write=False)
    return image


@lru_cache(maxsize=16)
def _draw_pattern(
    kind: FinishKind, period: float, footprint: float
) -> tuple[UInt8[np.ndarray, "H W"], UInt8[np.ndarray, "H W"]]:
    """Level of the accent and of brightness at every texel of a tile."""
    if kind == "wood":
        period = 1.0 / BOARDS / BOARD_PERIODS
    across = TEXELS if kind == "wood" else TEXELS + SEAM
    column, row = np.meshgrid(np.arange(TEXELS + SEAM) + 0.5, np.arange(across) + 0.5)
    # In the first channel a brightness times a share, in the second the brightness alone.
    probe = Finish(
        kind=kind, color=(0.25, 0.5, 0.5), accent=(0.75, 0.5, 0.5), grain=(1.0, 0.0, 0.0), period=period
    )
    points = np.stack([column.ravel(), row.ravel(), np.zeros(column.size)], axis=1) / TEXELS
    normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)
    seen = np.asarray(paint(probe, points, normals, footprint=footprint)).reshape(*column.shape, 3)
    tone = 2.0 * seen[..., 1]
    mix = 2.0 * seen[..., 0] / tone - 0.5
    mix, tone = (_close(value, across > TEXELS) for value in (mix, tone))
    level = np.rint((LEVELS - 1) * np.clip(mix, 0.0, 1.0)).astype(np.uint8)
    shade = np.rint((TONES - 1) * np.clip((tone - 0.94) / 0.12, 0.0, 1.0)).astype(np.uint8)
    return level, shade


def _close(field: Float[np.ndarray, "H W"], rows: bool) -> Float[np.ndarray, "H W"]:  # noqa: FBT001
    """A field without the margin beyond its end, which fades into its beginning: along rows, and columns
    where asked; the variance stays that of the pattern."""
    field = _fade(field)
    return _fade(field.T).T if rows else field


def _fade(field: Float[np.ndarray, "H W"]) -> Float[np.ndarray, "H W"]:
    turn = np.arange(SEAM) / SEAM * np.pi / 2
    mean = field.mean(axis=1, keepdims=True)  # boards differ in theirs
    out = field[:, :TEXELS].copy()
    out[:, :SEAM] = mean + np.cos(turn) * (field[:, TEXELS:] - mean) + np.sin(turn) * (out[:, :SEAM] - mean)
    return out
