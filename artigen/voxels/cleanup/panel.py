"""Depth of the panel of a front."""

import numpy as np
from jaxtyping import Bool

DEEP = 0.3
"""Share of a part's depth, from its front, in which its panel is sought."""
NEAR = 3
"""Layers of cells in which it is sought at least."""


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
