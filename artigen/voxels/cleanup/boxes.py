"""Greedy maximum-sum box cover of a 3D evidence grid.

Furniture is made of boards, so its cells are evidence for boxes, and single deviating cells are outvoted. A
box grows from a cell by moving each face to where the sum over the box is greatest, until the sum stops
growing. The evidence inside a box is then set to zero, and the next box is sought in the rest.
"""

from itertools import permutations

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import uniform_filter

Box = tuple[slice, slice, slice]
Sums = tuple[np.ndarray, np.ndarray, np.ndarray]
ORDERS = tuple(permutations(range(3)))
"""Orders of axes in which faces move: a wall that meets a shelf grows along itself or along the shelf."""
ROUNDING = 1e-3
"""Cells by which the box of a part may reach into a cell without counting as in it."""
TRIES = 20
"""Starts without a box of enough evidence that end the search."""
NO_SEED = -np.inf
"""Seed value of cells where no box starts."""


def find_boxes(evidence: Float[np.ndarray, "X Y Z"], least: float) -> list[Box]:
    """Boxes that each hold at least ``least`` evidence outside earlier boxes, from the surest cells on.

    Args:
        evidence: Above 0 for cells that belong to a box, below 0 for others.
    """
    rest = evidence.astype(float)
    seeds, sums = _seeds(rest), _summed(rest)
    in_vain, found = np.zeros(rest.shape, dtype=bool), []
    tries = 0
    while tries < TRIES:
        start = np.unravel_index(int(seeds.argmax()), rest.shape)
        if seeds[start] == NO_SEED:
            break
        gain, box = max((_grow(sums, start, order) for order in ORDERS), key=lambda grown: grown[0])
        if gain < least:
            in_vain[box] = True
            seeds[box] = NO_SEED
            tries += 1
            continue
        found.append(box)
        rest[box] = 0.0
        sums, seeds = _summed(rest), np.where(in_vain, NO_SEED, _seeds(rest))
    return found


def fill_boxes(shape: tuple[int, ...], boxes: list[Box]) -> Bool[np.ndarray, "X Y Z"]:
    """Mask of the union of the boxes."""
    filled = np.zeros(shape, dtype=bool)
    for box in boxes:
        filled[box] = True
    return filled


def _seeds(rest: Float[np.ndarray, "X Y Z"]) -> Float[np.ndarray, "X Y Z"]:
    """Mean evidence around each cell; `NO_SEED` where the cell's own evidence is not positive."""
    return np.where(rest > 0, uniform_filter(rest, 3, mode="constant", cval=-1.0), NO_SEED)


def _summed(rest: Float[np.ndarray, "X Y Z"]) -> Sums:
    """Sums over all boxes that start in the corner (a 3D integral image), transposed for each axis."""
    sums = np.pad(rest.cumsum(axis=0).cumsum(axis=1).cumsum(axis=2), ((1, 0), (1, 0), (1, 0)))
    return sums, sums.transpose(1, 0, 2), sums.transpose(2, 0, 1)


def _grow(sums: Sums, start: tuple[np.intp, ...], order: tuple[int, ...]) -> tuple[float, Box]:
    """Sum and extent of the box that grows from a cell when faces are moved in this order of axes."""
    faces = [(int(at), int(at) + 1) for at in start]
    gain, before = 0.0, -np.inf
    while gain > before:
        before = gain
        for axis in order:
            along = _sums_along(sums, faces, axis)
            high = faces[axis][1]
            low = high - 1 - int(along[:high][::-1].argmin())  # of equals, the smallest box
            high = low + 1 + int(along[low + 1 :].argmax())
            faces[axis] = (low, high)
            gain = float(along[high] - along[low])
    x, y, z = (slice(low, high) for low, high in faces)
    return gain, (x, y, z)


def _sums_along(sums: Sums, faces: list[tuple[int, int]], axis: int) -> np.ndarray:
    """Sums over the cross-section of a box from the start of an axis up to each position along it."""
    (a, b), (c, d) = faces[:axis] + faces[axis + 1 :]
    lines = sums[axis]
    return lines[:, b, d] - lines[:, a, d] - lines[:, b, c] + lines[:, a, c]


def reach_box(box: Float[np.ndarray, "6"], resolution: int, slack: float = 0.0) -> Box:
    """The cells that the box of a part reaches, at least one along each axis.

    Args:
        box: Centre and edges in unit-cube lengths.
        slack: Share of a cell by which the box may fall short of a cell that still counts.
    """
    low = (box[:3] - box[3:] / 2 + 0.5) * resolution
    high = (box[:3] + box[3:] / 2 + 0.5) * resolution
    first = np.floor(low - slack + ROUNDING).clip(0, resolution - 1).astype(int)
    last = np.ceil(high + slack - ROUNDING).clip(first + 1, resolution).astype(int)
    x, y, z = (slice(a, b) for a, b in zip(first, last, strict=True))
    return x, y, z
