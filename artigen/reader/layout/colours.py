"""Finishes in the colours and materials that were read."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from artigen.kind import kinds
from artigen.reader.reading import Reading
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
            return _tint(make_wood(_find_nearest(WOODS, color), seed), color)
        case "steel":
            return _tint(make_metal(_find_nearest(METALS, color), seed), color)
        case "stone":
            return _tint(make_stone(_find_nearest(STONES, color), seed), color)
        case "plastic" | "rubber":
            return make_plastic(color)
        case "glass":
            return make_glass(color)
    return make_lacquer(color)


def _tint(finish: Finish, color: Color) -> Finish:
    """A finish in another colour, its pattern as strong as before."""
    red, green, blue = (
        min(1.0, own * to / max(was, 1e-3))
        for own, was, to in zip(finish.accent, finish.color, color, strict=True)
    )
    return replace(finish, color=color, accent=(red, green, blue))


def _find_nearest(named: Mapping[str, tuple[Color, Color]], color: Color) -> str:
    return min(named, key=lambda name: float(np.abs(np.subtract(named[name][0], color)).sum()))


def find_finishes(reading: Reading, seed: int) -> dict[str, Finish]:
    """Finishes of body, top, fronts and handles as far as they were read, by role."""
    solid = [front for front in reading.fronts if not front.pane]
    materials = [front.material for front in solid if front.material is not None]
    material = max(sorted(set(materials)), key=materials.count) if materials else None
    if material == "wood" and kinds()[reading.kind].build not in (None, "board"):
        material = "lacquer"  # sheet metal in the colour of wood
    found: dict[str, Finish] = {}
    colors = [front.color for front in solid if front.color is not None]
    body = _scale(reading.color)
    if colors:
        front = _scale(np.median(np.array(colors, dtype=np.float64), axis=0))
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
