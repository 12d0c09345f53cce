"""`find_legs`: legs below the fronts of an object, by the pixels between and beside them."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from artigen.reader.layout.plane import frame_box
from artigen.reader.reading import Reading

if TYPE_CHECKING:
    from PIL import Image

EDGE = 512
"""Longest edge (pixels) at which a photograph is looked at."""
BELOW, BESIDE = 0.45, 0.3
"""How far below the fronts, and to either side, is looked at: shares of the height and the width of all."""
ROWS, COLUMNS = 45, 160
"""Samples of that."""
INNER, OUTER = 0.3, 0.12
"""Distance of legs from the ends of the fronts, inwards and outwards, as a share of the width of all."""
APART = 0.06
"""Least mean difference of the channels (sRGB in [0, 1]) of a leg from what is between legs."""
NOISE = 2.5
"""Least ratio of that to the usual difference of what is between legs from its own median."""
LEAST = 0.1
"""Least height of legs, as a share of the height of all fronts: floors before walls, boxes that are off and
patterns of carpets give lower ones."""
ALIKE = 0.5
"""Height of the highest line between legs over that of the legs, up to which they are legs."""
WIDE = 0.16
"""Width of a leg, as a share of the width of all fronts, up to which it is one."""


def find_legs(reading: Reading, image: "Image.Image") -> float | None:
    """Where legs end, as a share of the picture's height; None where there are none.

    What is between legs is the same across a row; a leg differs from it, in a narrow column from the fronts
    downwards, at either end. Of 21 rendered pieces on legs in plain rooms it finds 8, of 34 others it takes 2
    for such.

    Args:
        reading: Its fronts say where to look.
        image: The photograph, of any size.
    """
    fronts = [front for front in reading.fronts if not front.open]
    if not fronts:
        return None
    small = image.convert("RGB")
    small.thumbnail((EDGE, EDGE))
    quad = _hull([frame_box(front.box) if front.corners is None else front.corners for front in fronts])
    across, down = np.linspace(-BESIDE, 1 + BESIDE, COLUMNS), np.linspace(0.01, BELOW, ROWS)
    lower = quad[3] + (quad[2] - quad[3]) * across[:, None]
    along = (quad[3] - quad[0]) * (1 - across[:, None]) + (quad[2] - quad[1]) * across[:, None]
    points = lower[None] + along[None] * down[:, None, None]
    pixels = _sample(small, points)
    middle = (across > INNER) & (across < 1 - INNER)
    shown: Bool[np.ndarray, "R C"] = np.isfinite(pixels).all(axis=-1)  # type: ignore[assignment]
    rows: Bool[np.ndarray, "R"] = shown[:, middle].all(axis=1)  # type: ignore[assignment]
    if rows.sum() < LEAST * ROWS / BELOW:
        return None
    between = np.median(pixels[rows][:, middle], axis=1)
    apart = np.where(shown[rows], np.abs(pixels[rows] - between[:, None]).mean(axis=-1), 0.0)
    lengths, ends = _measure_runs(apart > max(APART, NOISE * float(np.median(apart[:, middle]))))
    step = down[1] - down[0]
    left, right = (
        _find_leg(lengths[end], across[end], outer)
        for end, outer in ((across < INNER, 0), (across > 1 - INNER, -1))
    )
    high = min(left, right)
    if high * step < LEAST or lengths[middle].max() > ALIKE * high:
        return None
    last = max(int(ends[lengths >= high].min()), 0)
    return float(points[np.flatnonzero(rows)[last], COLUMNS // 2, 1])


def _hull(quads: list[Float[np.ndarray, "4 2"]]) -> Float[np.ndarray, "4 2"]:
    """The outermost of the upper left, upper right, lower right and lower left corners."""
    corners = np.stack(quads)
    out = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return np.stack([corners[np.argmax(corners[:, k] @ out[k]), k] for k in range(4)])


def _sample(image: "Image.Image", points: Float[np.ndarray, "R C 2"]) -> Float[np.ndarray, "R C 3"]:
    """Colours at shares of a picture; NaN beyond its edges."""
    values = np.asarray(image, dtype=np.float64) / 255.0
    places = np.moveaxis(points[..., ::-1] * values.shape[:2], -1, 0)
    channels = [
        ndimage.map_coordinates(values[..., channel], places, order=1, cval=np.nan) for channel in range(3)
    ]
    return np.stack(channels, axis=-1)


def _measure_runs(on: Bool[np.ndarray, "R C"]) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the longest run of every column, and its last row; -1 without one."""
    length, current = np.zeros(on.shape[1], int), np.zeros(on.shape[1], int)
    end = np.full(on.shape[1], -1)
    for index, row in enumerate(on):
        current = np.where(row, current + 1, 0)
        end = np.where(current > length, index, end)
        length = np.maximum(length, current)
    return length, end


def _find_leg(lengths: np.ndarray, across: Float[np.ndarray, "C"], outer: int) -> int:
    """Rows of the longest line at one end that is narrow and does not reach the outer edge of the strip."""
    for rows in np.unique(lengths)[:0:-1]:
        groups, count = ndimage.label(lengths >= rows)  # type: ignore[misc]
        for group in range(1, count + 1):
            held = across[groups == group]
            near = -OUTER <= held.mean() <= 1 + OUTER
            if near and np.ptp(held) <= WIDE and across[outer] not in held:
                return int(rows)
    return 0
