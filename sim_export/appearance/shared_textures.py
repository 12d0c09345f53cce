"""Shared textures: one image per set of finishes, mapped by coordinates in metres.

`make_sheet` stacks one band per finish. A band is as large as the largest furniture part and does not depend
on the object. The faces of a part are laid into the bands along their grain. Parts with the same finishes
therefore share an image, byte for byte, across objects.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.shapes.surfaces.finishes import Color, Finish, FinishKind
from artigen.shapes.surfaces.noise import hash_unit
from artigen.shapes.surfaces.textures import KINDS, PATTERN_OF, PaintTable, paint
from sim_export.geometry.triangles import area_normals
from sim_export.package import Mesh

WIDTH = 256
"""Texels of a sheet along the grain."""
LENGTH = 2.56
"""Length (metres) of the width of a sheet."""
COLORS = 256
"""Largest number of colours of a sheet, so that its file uses one byte per texel."""
EVEN_ROWS = 4
"""Rows of a band of one colour."""
MARGIN = 1.0
"""Distance (texels) of mapped faces from the edge of a band."""
PATTERNS: dict[int, FinishKind] = {1: "wood", 2: "steel", 3: "stone"}
ROWS = {1: (320, 0.004), 2: (128, 0.010), 3: (128, 0.010)}
"""For patterned bands: the number of rows, and the size (metres) of a row across the grain."""
DARKEST = 1
"""Darkest level of a texel; V106 treats black as missing."""


@dataclass(frozen=True, kw_only=True)
class Look:
    """Properties of a finish that determine its band: pattern and colours, but not the boards cut from it."""

    pattern: int
    """As in `artigen.shapes.surfaces.textures.PATTERN_OF`; 0 and 4 have one colour."""
    color: Color
    accent: Color
    period: float

    @property
    def is_even(self) -> bool:
        """Whether the band is one colour."""
        return self.pattern not in ROWS


@dataclass(frozen=True, kw_only=True, eq=False)
class Sheet:
    """An image with one band per look, from top to bottom."""

    image: UInt8[np.ndarray, "H W 3"]
    starts: tuple[int, ...]
    """First row of each band."""


def even_color(look: Look) -> Color:
    """Mean visible colour of a finish without a pattern."""
    share = 0.5 if look.pattern else 0.0
    red, green, blue = (
        float(np.clip(a + share * (b - a), 0.0, 1.0)) for a, b in zip(look.color, look.accent, strict=True)
    )
    return red, green, blue


def lay_shared(mesh: Mesh, rows: Int[np.ndarray, "F"], table: PaintTable, offset: np.ndarray) -> Mesh:
    """Maps a mesh to the image that its finishes share, or gives it one colour if its finish has no pattern.

    Args:
        rows: Row of ``table`` that each face shows.
        table: The paint of the object, see `artigen.shapes.surfaces.textures.make_paint`.
        offset: Translation from the mesh's frame to that of the table (m).
    """
    looks = {int(row): _look(table, int(row)) for row in np.unique(rows)}
    ordered = tuple(sorted(set(looks.values()), key=lambda look: (look.pattern, look.color, look.accent)))
    if len(ordered) == 1 and ordered[0].is_even:
        return replace(mesh, color=even_color(ordered[0]), uv=None, texture=None)
    sheet = make_sheet(ordered)
    points = mesh.vertices[mesh.faces] + offset  # F 3 3
    local = np.einsum("fcd,fkd->fck", points, table.axes[rows].astype(np.float64))
    facing = np.abs(np.einsum("fd,fkd->fk", area_normals(points), table.axes[rows])).argmax(axis=1)
    flat = np.take_along_axis(local, np.array([[1, 2], [0, 2], [0, 1]])[facing][:, None, :], axis=2)
    uv = np.zeros((len(rows), 3, 2))
    for group, row, side in _boards(rows, facing):
        band = ordered.index(looks[row])
        uv[group] = _place(flat[group], ordered[band], sheet, band, seed=int(table.seed[row]) + 31 * side)
    return replace(mesh, uv=uv, texture=sheet.image)


def _boards(rows: np.ndarray, facing: np.ndarray) -> list[tuple[np.ndarray, int, int]]:
    """Groups faces by paint row and facing axis."""
    code, where = np.unique(3 * rows + facing, return_inverse=True)
    return [
        (np.flatnonzero(where == index), int(value) // 3, int(value) % 3) for index, value in enumerate(code)
    ]


def _place(
    flat: Float[np.ndarray, "G 3 2"], look: Look, sheet: Sheet, band: int, *, seed: int
) -> Float[np.ndarray, "G 3 2"]:
    """Texture coordinates of the faces of one board, scaled down if it exceeds the band.

    The seed determines the position of the board in the band.
    """
    height = sheet.image.shape[0]
    rows, across = ROWS.get(look.pattern, (EVEN_ROWS, LENGTH / EVEN_ROWS))
    texel = np.array([LENGTH / WIDTH, across])
    room = np.array([WIDTH, rows]) - 2.0 * MARGIN
    low = flat.min(axis=(0, 1))
    size = (flat.max(axis=(0, 1)) - low) / texel
    scale = np.minimum(1.0, room / np.maximum(size, 1e-9))
    lot = np.array([float(hash_unit(np, np.array([seed + k], np.int32))[0]) for k in (0, 1)])
    start = MARGIN + lot * (room - size * scale) + np.array([0.0, sheet.starts[band]])
    texels = (flat - low) / texel * scale + start
    return np.stack([texels[..., 0] / WIDTH, 1.0 - texels[..., 1] / height], axis=2)


def _look(table: PaintTable, row: int) -> Look:
    def color(values: np.ndarray) -> Color:
        red, green, blue = (round(float(value), 5) for value in values[row])
        return red, green, blue

    pattern = PATTERN_OF[KINDS[int(table.kind[row])]]
    return Look(
        pattern=pattern if pattern in ROWS else min(pattern, 4),
        color=color(table.color),
        accent=color(table.accent),
        period=round(float(table.period[row]), 6),
    )


@lru_cache(maxsize=256)
def make_sheet(looks: tuple[Look, ...]) -> Sheet:
    """The image of a set of finishes; equal sets give equal bytes, with at most `COLORS` colours each."""
    bands = [_band(look) for look in looks]
    starts = np.cumsum([0, *(len(band) for band in bands)])
    image = _reduce(np.concatenate(bands, axis=0))
    image.setflags(write=False)
    return Sheet(image=image, starts=tuple(int(start) for start in starts[:-1]))


def _band(look: Look) -> UInt8[np.ndarray, "R W 3"]:
    if look.is_even:
        color = np.rint(255.0 * np.array(even_color(look))).astype(np.uint8)
        return np.tile(np.maximum(color, DARKEST), (EVEN_ROWS, WIDTH, 1))
    count, across = ROWS[look.pattern]
    finish = Finish(
        kind=PATTERNS[look.pattern], color=look.color, accent=look.accent, grain=(1.0, 0.0, 0.0),
        period=look.period,
    )  # fmt: skip
    column, row = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(count) + 0.5)
    points = np.stack([column.ravel() * LENGTH / WIDTH, row.ravel() * across, np.zeros(column.size)], axis=1)
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    colors = np.asarray(paint(finish, points, normals, footprint=across))
    levels = np.rint(255.0 * colors).astype(np.uint8).reshape(count, WIDTH, 3)
    return np.maximum(levels, DARKEST)


def _reduce(image: UInt8[np.ndarray, "H W 3"]) -> UInt8[np.ndarray, "H W 3"]:
    """Quantises the image to at most `COLORS` colours, without dithering."""
    from PIL import Image

    reduced = Image.fromarray(image).quantize(COLORS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    return np.maximum(np.asarray(reduced.convert("RGB")), DARKEST)
