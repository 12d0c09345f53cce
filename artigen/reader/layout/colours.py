"""Finishes in the colours and materials that were read."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from artigen.kind import kinds
from artigen.reader.reading import Reading
from artigen.shapes.surfaces.color_difference import convert_to_lab
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import (
    METALS,
    STONES,
    WOODS,
    make_glass,
    make_lacquer,
    make_metal,
    make_plastic,
    make_stone,
    make_wood,
)

SAME = 0.06
"""Mean difference of two colours (sRGB in [0, 1]) below which a body has the finish of its fronts: as much as
light from a window changes between two faces."""
DARKEST, BRIGHTEST = 0.04, 0.95
"""Range of the channels of a surface; pictures of lamps and of shadows go beyond."""


WARM = (44.0, 110.0)
"""Hue of woods (degrees, CIELAB): `WOODS` have 48 to 84, and light from windows shifts it towards green."""
PALE = 6.0
"""Chroma (CIELAB) below which a surface is grey, as no wood brighter than `BLACK` is; grey oak has 11."""
BLACK = 16.0
"""Lightness (CIELAB) of black ash, below which chroma and hue tell nothing."""


def is_wooden(color: Color) -> bool:
    """Whether a colour, sRGB in [0, 1], may be that of a wood."""
    light, a, b = convert_to_lab(np.array(color))
    hue = float(np.degrees(np.arctan2(b, a)))
    return bool(light <= BLACK or (np.hypot(a, b) >= PALE and WARM[0] <= hue <= WARM[1]))


def match_finish(material: str | None, color: Color, seed: int) -> Finish:
    """A finish of a material in a colour: the nearest one of its kind, tinted.

    Args:
        material: wood, lacquer, steel, plastic, glass, rubber or stone; None for lacquer.
        color: sRGB in [0, 1].
        seed: Selects the pattern.
    """
    red, green, blue = np.clip(color, DARKEST, BRIGHTEST).tolist()
    color = (red, green, blue)
    match material:
        case "wood":
            return tint_finish(make_wood(_find_nearest(WOODS, color), seed), color)
        case "steel":
            return tint_finish(make_metal(_find_nearest(METALS, color), seed), color)
        case "stone":
            return tint_finish(make_stone(_find_nearest(STONES, color), seed), color)
        case "plastic" | "rubber":
            return make_plastic(color)
        case "glass":
            return make_glass(color)
    return make_lacquer(color)


def tint_finish(finish: Finish, color: Color) -> Finish:
    """A finish in another colour, its pattern as strong as before; what no wood looks like is painted."""
    if finish.kind == "wood" and not is_wooden(color):
        return make_lacquer(color)
    red, green, blue = (
        min(1.0, own * to / max(was, 1e-3))
        for own, was, to in zip(finish.accent, finish.color, color, strict=True)
    )
    return replace(finish, color=color, accent=(red, green, blue))


def _find_nearest(named: Mapping[str, tuple[Color, Color]], color: Color) -> str:
    return min(named, key=lambda name: float(np.abs(np.subtract(named[name][0], color)).sum()))


def find_finishes(reading: Reading, seed: int) -> dict[str, Finish]:
    """Finishes of body, top, fronts and handles as far as they were read, by role."""
    furniture = kinds()[reading.kind].trade == "furniture"
    solid = [front for front in reading.fronts if not front.pane] or ([] if furniture else reading.fronts)
    materials = [front.material for front in solid if front.material not in (None, "glass")]
    material = max(sorted(set(materials)), key=materials.count) if materials else None
    found: dict[str, Finish] = {}
    colors = [front.color for front in solid if front.color is not None]
    body = _scale(reading.color)
    seen = _scale(np.median(np.array(colors, dtype=np.float64), axis=0)) if colors else body
    metal = kinds()[reading.kind].build not in (None, "board")
    if material == "wood" and (metal or not is_wooden(seen)):
        material = "lacquer"
    if colors:
        front = seen
        if float(np.abs(np.subtract(front, body)).mean()) < SAME:
            body = front
        found["front"] = match_finish(material, front, seed)
    found["body"] = found["top"] = match_finish(material, body, seed)
    pulls = [part.color for part in reading.parts if part.label == "handle" and part.color is not None]
    if pulls:
        color = _scale(np.median(np.array(pulls, dtype=np.float64), axis=0))
        metal = make_metal(_find_nearest(METALS, color), seed)
        front = found.get("front", found["body"])
        as_front = _differ(color, front.color) < _differ(color, metal.color)
        found["handle"] = front if as_front else metal
    return found


def _scale(color: object) -> Color:
    red, green, blue = (float(value) / 255.0 for value in np.asarray(color).tolist())
    return red, green, blue


def _differ(one: Color, other: Color) -> float:
    return float(np.abs(np.subtract(one, other)).sum())
