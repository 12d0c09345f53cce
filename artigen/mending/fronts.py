"""Fronts of doors and drawers are whole: a stage of its own for those drawn in shreds.

The front of a true door is a whole rectangle or ellipse; a drawer may have a grip cut into it, but shows
three quarters. What was drawn with less has lost cells, and gets them back.
"""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_rows
from artigen.mending.rows import Owners

WHOLE: Mapping[str, float] = {"door": 0.93, "drawer": 0.75}
"""Share of the rectangle or ellipse of its front that a part shows at least; below, it is filled."""
DEEP = 0.3
"""Share of a part's depth, from its front, in which its panel is sought."""
NEAR = 3
"""Layers of cells in which it is sought at least."""


def fill_fronts(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which doors and drawers have whole fronts, and a note of how many were filled.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    owners, labels = owners.copy(), name_rows(rows, layout)
    boxes = rows[:, after_occupancy(layout.box)]
    base = np.array([label == "base" for label in labels])
    filled = []
    for number, label in enumerate(labels):
        mine = owners == number
        if label not in WHOLE or not mine.any():
            continue
        missing = _find_missing(mine, boxes[number], WHOLE[label]) & ((owners < 0) | base[owners])
        if missing.any():
            owners[missing] = number
            filled.append(int(missing.sum()))
    if not filled:
        return owners, ()
    note = f"{len(filled)} fronts of doors and drawers were filled, by {max(filled)} cells at most"
    return owners, (note,)


def _find_missing(
    mine: Bool[np.ndarray, "X Y Z"], box: Float[np.ndarray, "6"], whole: float
) -> Bool[np.ndarray, "X Y Z"]:
    """The cells that a front lacks in its panel; none where it is as whole as others."""
    missing = np.zeros_like(mine)
    layers, lacks = (view_front(cells, box[:3], box[3:]) for cells in (mine, missing))
    shown = np.asarray(layers.any(axis=0))
    shape = _find_shape(shown)
    if shown.any() and (shown & shape).sum() < whole * shape.sum():
        lacks[find_panel(layers)] = shape & ~shown
    return missing


def view_front(
    cells: Bool[np.ndarray, "X Y Z"], center: Float[np.ndarray, "3"], size: Float[np.ndarray, "3"]
) -> Bool[np.ndarray, "D H W"]:
    """A view of the cells along the front of a box, the layers first: those along x, of a lid from below."""
    low = np.round((center - size / 2 + 0.5) * len(cells)).clip(0, len(cells) - 1).astype(int)
    high = np.round((center + size / 2 + 0.5) * len(cells)).clip(low + 1, len(cells)).astype(int)
    along = 0 if size[0] <= size[1:].max() else 1 + int(size[1:].argmin())  # fronts face -x, lids lie
    face = (slice(low[axis], high[axis]) for axis in range(3) if axis != along)
    return np.moveaxis(cells, along, 0)[(slice(None), *face)]


def find_panel(layers: Bool[np.ndarray, "D H W"]) -> slice:
    """The layers of the panel: those around the fullest near the front that hold half as much as it."""
    held = layers.sum(axis=(1, 2)).astype(float)
    there = np.flatnonzero(held)
    deepest = there[0] + max(NEAR, round(DEEP * (there[-1] - there[0] + 1)))
    fullest = int(held[:deepest].argmax())
    full = 2 * held >= held[fullest]
    first = last = fullest
    while first > 0 and full[first - 1]:
        first -= 1
    while last + 1 < deepest and full[last + 1]:
        last += 1
    return slice(first, last + 1)


def _find_shape(shown: Bool[np.ndarray, "H W"]) -> Bool[np.ndarray, "H W"]:
    """The rectangle or the ellipse of the front, whichever is more like what is shown."""
    shapes = (np.ones_like(shown), draw_ellipse(*shown.shape))
    return max(shapes, key=lambda shape: (shape & shown).sum() / (shape | shown).sum())


def draw_ellipse(height: int, width: int) -> Bool[np.ndarray, "H W"]:
    """The cells of a rectangle whose middles lie in its ellipse."""
    y, z = (np.linspace(-1, 1, 2 * count + 1)[1::2] for count in (height, width))
    return y[:, None] ** 2 + z[None] ** 2 <= 1.0
