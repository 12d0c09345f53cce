"""Moulded edges: tops of tables and cabinets, cornices, all of two courses."""

import numpy as np

from artigen.shapes.primitives import Primitive, block, polytope
from artigen.shapes.ranges import Range, narrow

UPPER = 0.45
"""Share of the height that the upper course takes."""
BEVEL = 0.1
"""Bevel of the upper course, relative to its height."""


def build_moulding(
    x: Range, y: Range, z: Range, inset: float, finish: str, *, back: bool = False
) -> tuple[Primitive, ...]:
    """A board over a course that flares out to it from below.

    Args:
        x: Extent of the board (m).
        y: Extent of the board (m).
        z: Lower end of the flare and upper face of the board (m).
        inset: How far the lower end of the flare is set back (m), in front and at both sides.
        finish: Role of the finish.
        back: Whether it is set back behind as well.
    """
    middle = z[1] - UPPER * (z[1] - z[0])
    low_x, low_y = (x[0] + inset, x[1] - (inset if back else 0.0)), narrow(y, inset)
    corners = [
        (a, b, level) for level, (p, q) in ((z[0], (low_x, low_y)), (middle, (x, y))) for a in p for b in q
    ]
    return (
        block(x, y, (middle, z[1]), finish, BEVEL * (z[1] - middle)),
        polytope(np.array(corners), finish),
    )
