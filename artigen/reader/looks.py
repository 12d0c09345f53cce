"""`look_closer`: what the pixels around an object tell once its parts are known."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float

from artigen.reader.boxes import overlap_boxes
from artigen.reader.ground import bound_outline, find_outline
from artigen.reader.legs import find_legs
from artigen.reader.panels import look_at_panels
from artigen.reader.proportions import fit_outline
from artigen.reader.reading import Reading, Stand

if TYPE_CHECKING:
    from PIL import Image

EDGE = 768
"""Longest edge (pixels) at which a photograph is looked at."""
LOW = 0.05
"""Height below the lowest front, as a share of the object's, below which there is no room for legs."""
STRIP = 0.06
"""Width of what is looked at on either side of an object, as a share of its width."""
SAME = 0.05
"""Mean difference of two colours (sRGB in [0, 1]) up to which they are one."""
ALIKE = 0.12
"""The same of two places of one surface, one of them in shadow; a cabinet's inside is darker."""
CELLS = 64
"""Cells in which a photograph's colours are compared with those of fronts, along either edge."""
OWN = 0.6
"""Overlap (intersection over union) of an outline's box with the one that was read from which it is the
object's: a photograph of a whole kitchen before white paper is outlined as well."""
FAR_OFF = 0.4
"""Logarithm of the factor between a length by the outline and the one that was read from which the former is
not believed: twice the standard deviation of what is read."""
COVERED = 0.6
"""Share of the width that legs cover at most; six legs that are seen from aside cover half of it."""
MOST = 0.5
"""Share of the rows below the fronts in which the ground shows between legs: rails and stretchers hide it in
others."""


def look_closer(reading: Reading, image: "Image.Image") -> Reading:
    """The reading with what a second look tells.

    - Before plain ground, or cut out, the object ends where its outline does, has the proportions that this
      tells, and stands on legs where the ground shows below it.
    - Elsewhere it stands on legs where `find_legs` finds them; what seems to be legs is a closed base where
      the body goes on below the fronts.
    - A body that has the colour of what is beside the object has that of its fronts.
    - Places in the colour of the nearest front are closed (`Reading.surface`).
    - Fronts have fields (`look_at_panels`).

    Args:
        reading: What was read.
        image: The photograph, of any size.
    """
    small = image.convert("RGB")
    small.thumbnail((EDGE, EDGE))
    pixels = np.asarray(small, dtype=np.float64) / 255.0
    left, _, right, bottom = reading.box
    beside = _look_beside(pixels, (left, right), (bottom - 0.5 * (bottom - reading.box[1]), bottom))
    body, color = np.array(reading.color) / 255.0, reading.color
    solid = [front.color for front in reading.fronts if front.color is not None and not front.pane]
    if solid and any(_differ(body, one) <= SAME for one in beside):
        red, green, blue = np.median(np.array(solid), axis=0)
        color = int(red), int(green), int(blue)
    outline = find_outline(image)
    bounds = None if outline is None else bound_outline(outline)
    if outline is not None and bounds is not None and _overlap(bounds, reading.box) >= OWN:
        reading = replace(reading, box=bounds)
        reading = replace(measure_outline(reading, outline), stand=_find_feet(reading, outline))
    elif (end := find_legs(reading, image)) is not None:
        left, top, right, bottom = reading.box
        reading = replace(reading, stand="legs", box=np.array([left, top, right, max(bottom, end)]))
    else:
        reading = replace(reading, stand=_find_stand(reading, np.array(color) / 255.0, pixels))
    reading = replace(reading, color=color, surface=_find_surface(reading, image))
    return look_at_panels(reading, image)


def measure_outline(reading: Reading, outline: Bool[np.ndarray, "H W"]) -> Reading:
    """The reading with the lengths and the view that an outline tells, unless they are far from those that
    were read: then the object is no cuboid, or its fronts are others."""
    boxes = [front.box for front in reading.fronts if not front.open]
    ends = (float(min(box[0] for box in boxes)), float(max(box[2] for box in boxes))) if boxes else None
    size, view = fit_outline(outline, reading.size, reading.view, ends)
    if float(np.abs(np.log(size) - np.log(reading.size)).max()) > FAR_OFF:
        return reading
    return replace(reading, size=size, view=view, measured=True)


def _find_surface(reading: Reading, image: "Image.Image") -> Bool[np.ndarray, "R C"] | None:
    """Where the picture has the colour of the nearest closed front."""
    from PIL import Image as PillowImage

    fronts = [front for front in reading.fronts if front.color is not None and not (front.open or front.pane)]
    if not fronts:
        return None
    cells = image.convert("RGB").resize((CELLS, CELLS), PillowImage.Resampling.BOX)
    pixels = np.asarray(cells, dtype=np.float64) / 255.0
    middles = (np.arange(CELLS) + 0.5) / CELLS
    at = np.stack(np.meshgrid(middles, middles), axis=-1)[:, :, None]
    boxes = np.stack([front.box for front in fronts])
    away = np.maximum(np.maximum(boxes[:, :2] - at, at - boxes[:, 2:]), 0.0)
    nearest = np.linalg.norm(away, axis=-1).argmin(axis=-1)
    colors = np.array([front.color for front in fronts], dtype=np.float64) / 255.0
    return np.asarray(np.abs(pixels - colors[nearest]).mean(axis=-1) <= ALIKE)


def _overlap(one: Float[np.ndarray, "4"], other: Float[np.ndarray, "4"]) -> float:
    return float(overlap_boxes(one[None], np.asarray(other, dtype=np.float64)[None])[0, 0])


def _find_feet(reading: Reading, outline: Bool[np.ndarray, "H W"]) -> Stand:
    """Legs where the ground shows below the lowest front across most of the object."""
    if not reading.fronts:
        return reading.stand
    left, top, right, bottom = reading.box
    lowest = max(float(front.box[3]) for front in reading.fronts)
    if bottom - lowest < LOW * (bottom - top):
        return "flat"
    high, wide = outline.shape
    rows = slice(round((lowest + 0.3 * (bottom - lowest)) * high), max(round(bottom * high) - 1, 1))
    covered = outline[rows, round(left * wide) : round(right * wide)].mean(axis=1)
    shows = float((covered < COVERED).mean()) >= MOST if len(covered) else False
    return ("wheels" if reading.stand == "wheels" else "legs") if shows else "flat"


def _find_stand(reading: Reading, body: Float[np.ndarray, "3"], pixels: Float[np.ndarray, "H W 3"]) -> Stand:
    """Legs only where there is room below the fronts, and what shows there differs from the body more than
    from what is beside the object."""
    if reading.stand != "legs" or not reading.fronts:
        return reading.stand
    left, top, right, bottom = reading.box
    below = bottom - max(float(front.box[3]) for front in reading.fronts)
    if below < LOW * (bottom - top):
        return "flat"
    inset, rows = 0.25 * (right - left), (bottom - 0.5 * below, bottom - 0.1 * below)
    beside = _look_beside(pixels, (left, right), rows)
    under = _find_median(pixels, (left + inset, right - inset), rows)
    outside = min((_differ(under, one) for one in beside), default=0.0)
    return "legs" if outside < _differ(under, body) else "flat"


def _look_beside(
    pixels: Float[np.ndarray, "H W 3"], across: tuple[float, float], rows: tuple[float, float]
) -> list[Float[np.ndarray, "3"]]:
    """Median colours to the left and right of an object, as far as the picture goes."""
    left, right = across
    wide = STRIP * (right - left)
    places = [(left - wide, left), (right, right + wide)]
    return [_find_median(pixels, place, rows) for place in places if place[0] >= 0 and place[1] <= 1]


def _find_median(
    pixels: Float[np.ndarray, "H W 3"], across: tuple[float, float], rows: tuple[float, float]
) -> Float[np.ndarray, "3"]:
    """Median colour of a box (shares)."""
    high, wide = pixels.shape[:2]
    x0, x1 = np.clip(np.round(np.array(across) * wide).astype(int), 0, wide - 1)
    y0, y1 = np.clip(np.round(np.array(rows) * high).astype(int), 0, high - 1)
    return np.asarray(np.median(pixels[y0 : y1 + 1, x0 : x1 + 1].reshape(-1, 3), axis=0))


def _differ(one: Float[np.ndarray, "3"], other: Float[np.ndarray, "3"]) -> float:
    return float(np.abs(one - other).mean())
