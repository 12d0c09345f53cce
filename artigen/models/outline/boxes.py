"""Boxes of the parts of an outline, for stages that change them in place."""

import numpy as np
from jaxtyping import Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout
from artigen.types import PartLabel

CELL = 1 / 64
"""Edge of a cell of the shipped models' grid, in unit-cube lengths."""
FRONTS: tuple[PartLabel, ...] = ("door", "drawer")
"""Parts that lie side by side in the front of an object."""


def box_views(
    rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Float[np.ndarray, "N 3"], Float[np.ndarray, "N 3"]]:
    """Views of the centres and the sizes of the boxes: writing to them changes the outline."""
    start = layout.box.start - 1
    return rows[:, start : start + 3], rows[:, start + 3 : start + 6]
