"""The surface of a box as triangles."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from sim_export.geometry.hulls import box_hull

Ends = Sequence[float] | Float[np.ndarray, "3"]


def box(low: Ends, high: Ends) -> Float[np.ndarray, "12 3 3"]:
    """Triangles of a closed box."""
    hull = box_hull(np.array(low, dtype=float), np.array(high, dtype=float))
    return hull.vertices[hull.faces]
