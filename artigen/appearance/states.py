"""Joint states for training pictures, over the full range of every joint.

The paper opens all joints together (section 4.2.1). A drawer then hides the inside of the one below it in
every picture. States can therefore be staggered: every joint still visits the same shares of its range once
each, but neighbours are open by different shares at a time.
"""

import numpy as np
from jaxtyping import Float

from artigen.shapes.poses import joint_ranges
from artigen.shapes.shape import Shape
from artigen.types import Asset

GOLDEN = 0.3819660112501051
"""Step between the shifts of joints as a share of all states: golden ratio, far from small fractions."""


def plan_fractions(shape: Shape, count: int, *, staggered: bool) -> Float[np.ndarray, "S P"]:
    """Share of its range that each part is open by, state by state; the first state is closed.

    A part that needs another one open follows the order of that one, and is closed where that is not open
    enough.
    """
    if count < 1:
        raise ValueError(f"{count} joint states, expected at least 1")
    shares = np.linspace(0.0, 1.0, count)
    out = np.tile(shares[:, None], (1, len(shape.parts)))
    row = {part.name: index for index, part in enumerate(shape.parts)}
    if staggered and count > 2:
        moving = [index for index, part in enumerate(shape.parts) if part.joint is not None]
        for rank, index in enumerate(moving):
            leader, needs = rank, shape.parts[index].needs
            while needs and row[needs[0].part] in moving:
                leader = moving.index(row[needs[0].part])
                needs = shape.parts[moving[leader]].needs
            shift = round(leader * (count - 1) * GOLDEN)
            out[1:, index] = np.roll(shares[1:], -shift)
    for _ in shape.parts:  # a need may itself depend on another
        for index, part in enumerate(shape.parts):
            for need in part.needs:
                out[out[:, row[need.part]] < need.fraction, index] = 0.0
    return out


def shape_coordinates(
    shape: Shape, asset: Asset, fractions: Float[np.ndarray, "S P"]
) -> Float[np.ndarray, "S P"]:
    """Joint coordinates of a shape (metres, radians), one per part; zero for parts that its asset lacks."""
    kept = {part.name for part in asset.parts}
    return fractions * np.where([part.name in kept for part in shape.parts], joint_ranges(shape), 0.0)


def asset_coordinates(
    shape: Shape, asset: Asset, fractions: Float[np.ndarray, "S P"]
) -> Float[np.ndarray, "S J"]:
    """The same states in the coordinates of the shape's asset (unit lengths, radians; movable parts)."""
    row = {part.name: index for index, part in enumerate(shape.parts)}
    columns = [
        fractions[:, row[part.name]] * part.joint.upper for part in asset.parts if part.joint.type != "fixed"
    ]
    return np.stack(columns, axis=1) if columns else np.zeros((len(fractions), 0))
