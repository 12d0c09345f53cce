"""Estimates the colour of handles and knobs from a picture and the labels that the encoder finds in it.

They are a few pixels wide, so a drawn shape rarely has them at the exact pixels where the picture shows
them. The encoder's labels say which cells of the picture show one; of a cell's pixels, the half that differs
most from the surroundings is taken for the handle.
"""

import numpy as np
from jaxtyping import Float

from artigen.sketch.overlay import SOLID
from artigen.types import PART_LABELS, PartLabel

THIN: tuple[PartLabel, ...] = ("handle", "knob")
"""Labels of parts that are thin in a picture."""
SHOWN, AROUND = 0.5, 0.2
"""Probability above which a cell shows a handle, and below which it belongs to the surroundings."""
REACH = 2
"""Surrounding cells to each side."""
HALF = 0.5
"""Share of a cell's pixels, those that differ most from the surroundings, that are taken for the handle."""
LEAST_PIXELS, LEAST_CELLS = 8, 2
"""Smallest number of pixels of a cell and of its surroundings, and of such cells."""


def read_handle(
    picture: Float[np.ndarray, "4 S S"], chances: Float[np.ndarray, "L h w"]
) -> Float[np.ndarray, "3"] | None:
    """Colour (sRGB) at which a picture shows handles and knobs, light included; None if it shows too few.

    Args:
        picture: RGBA in [0, 1], premultiplied on black; an integer number of pixels per cell.
        chances: Probability of each part label, by cell.
    """
    alpha, edge = picture[3], picture.shape[-1] // chances.shape[-1]
    color = np.moveaxis(picture[:3] / np.maximum(alpha, 1e-3), 0, -1)
    handle = chances[[PART_LABELS.index(label) for label in THIN]].sum(axis=0)
    rest = np.kron(handle < AROUND, np.ones((edge, edge), dtype=bool)) & (alpha > SOLID)
    margin = REACH * edge
    colors = np.pad(color, ((margin, margin), (margin, margin), (0, 0)))
    masks = np.pad(rest, margin)
    found = []
    for row, column in edge * np.argwhere(handle > SHOWN):
        cell = slice(row, row + edge), slice(column, column + edge)
        wide = slice(row, row + edge + 2 * margin), slice(column, column + edge + 2 * margin)
        own, behind = color[cell][alpha[cell] > SOLID], colors[wide][masks[wide]]
        if min(len(own), len(behind)) >= LEAST_PIXELS:
            apart = np.abs(own - np.median(behind, axis=0)).sum(axis=1)
            found.append(np.median(own[apart >= np.quantile(apart, 1 - HALF)], axis=0))
    return np.median(found, axis=0) if len(found) >= LEAST_CELLS else None
