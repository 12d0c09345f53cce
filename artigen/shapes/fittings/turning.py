"""Rotates parts about the vertical by quarter turns: from the front to a side or the back."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.shapes.primitives import move
from artigen.shapes.shape import ShapePart

QUARTERS: dict[str, int] = {"front": 0, "right": 1, "back": 2, "left": 3}
"""Counterclockwise quarter turns, seen from above, from the front (-x) to each side; right is -y."""


def turn_part(part: ShapePart, side: str) -> ShapePart:
    """A part designed for a front at -x, rotated about the z axis to another side; "right" is -y."""
    quarters = QUARTERS[side]
    solids = tuple(move(solid, turn=quarters * np.pi / 2) for solid in part.primitives)
    if part.joint is None:
        return replace(part, primitives=solids)
    motion = replace(
        part.joint, axis=_turn(part.joint.axis, quarters), origin=_turn(part.joint.origin, quarters)
    )
    return replace(part, primitives=solids, joint=motion)


def _turn(vector: Float[np.ndarray, "3"], quarters: int) -> Float[np.ndarray, "3"]:
    x, y, z = vector
    for _ in range(quarters):
        x, y = -y, x
    return np.array([x, y, z])
