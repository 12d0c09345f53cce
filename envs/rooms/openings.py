"""Openings of walls around what lies in them, such as windows."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float

from .room import Opening, Side, from_wall

CLEARANCE = 5e-4
"""Distance (m) between a wall and what lies in its openings."""


def find_openings(
    boxes: Float[np.ndarray, "N 2 3"], side: Side, size: tuple[float, float, float]
) -> tuple[Opening, ...]:
    """Openings around the boxes of an object that reach into a wall: for each range of heights one from the
    first box to the last."""
    turned = from_wall(side, size, boxes)
    inside = turned[turned[:, 0, 1] < -CLEARANCE][..., [0, 2]]
    bands: list[list[float]] = []  # start, stop, bottom, top
    for bottom, top in pairwise(np.unique(inside[..., 1]).tolist()):
        crossed = inside[(inside[:, 0, 1] < top) & (inside[:, 1, 1] > bottom), :, 0]
        if not len(crossed) or top - bottom < CLEARANCE / 10.0:  # rounded edges of hulls that meet
            continue
        start, stop = float(crossed[:, 0].min()), float(crossed[:, 1].max())
        if bands and np.allclose(bands[-1], (start, stop, bands[-1][2], bottom), atol=CLEARANCE):
            bands[-1][3] = top
        else:
            bands.append([start, stop, bottom, top])
    return tuple(
        Opening(
            side=side,
            start=start - CLEARANCE,
            width=stop - start + 2 * CLEARANCE,
            bottom=bottom - CLEARANCE,
            height=top - bottom + 2 * CLEARANCE,
        )
        for start, stop, bottom, top in bands
    )
