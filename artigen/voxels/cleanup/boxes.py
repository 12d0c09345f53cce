"""Greedy maximum-sum box cover of a 3D evidence grid.

Furniture is made of boards, and evidence for a board is evidence for a box: single cells that say otherwise
are outvoted. A box is grown from a cell by moving its faces, each to wherever the sum over the box is
greatest, until no face moves. What a box holds counts as told, and the next is sought in the rest.
"""

from itertools import permutations

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import uniform_filter

Box = tuple[slice, slice, slice]
Sums = tuple[np.ndarray, np.ndarray, np.ndarray]
ORDERS = tuple(permutations(range(3)))
"""In which faces are moved: a wall that meets a shelf is found along itself or along the shelf."""
SWEEPS = 12
"""At most this often are all faces moved; they rest after three or four."""
ROUNDING = 1e-3
"""Cells that the box of a part may reach into a cell without being in it."""
MOST = 200
"""No more boxes are sought: what takes so many is no furniture."""
TRIES = 20
"""So many starts that lead to no box of enough evidence end the search."""
TOLD = -np.inf
"""Where no box starts."""


def find_boxes(evidence: Float[np.ndarray, "X Y Z"], least: float) -> list[Box]:
    """Boxes that each hold at least ``least`` evidence that no box before holds, the surest cells first.

    Args:
        evidence: above 0 for cells that belong to a box, below 0 for others.
        least: sum over a box for it to be one.
    """
    rest = evidence.astype(float)
    seeds, sums = _seeds(rest), _summed(rest)
    in_vain, found = np.zeros(rest.shape, dtype=bool), []
    tries = 0
    while len(found) < MOST and tries < TRIES:
        start = np.unravel_index(int(seeds.argmax()), rest.shape)
        if seeds[start] == TOLD:
            break
        gain, box = max((_grow(sums, start, order) for order in ORDERS), key=lambda grown: grown[0])
        if gain < least:
            in_vain[box] = True
            seeds[box] = TOLD
            tries += 1
            continue
        found.append(box)
        rest[box] = 0.0
        sums, seeds = _summed(rest), np.where(in_vain, TOLD, _seeds(rest))
    return found


def fill_boxes(shape: tuple[int, ...], boxes: list[Box]) -> Bool[np.ndarray, "X Y Z"]:
    """The cells of any of the boxes."""
    filled = np.zeros(shape, dtype=bool)
    for box in boxes:
        filled[box] = True
    return filled


def _seeds(rest: Float[np.ndarray, "X Y Z"]) -> Float[np.ndarray, "X Y Z"]:
    """How sure a cell is with its neighbours; cells that are not for a box start none."""
    return np.where(rest > 0, uniform_filter(rest, 3, mode="constant", cval=-1.0), TOLD)


def _summed(rest: Float[np.ndarray, "X Y Z"]) -> Sums:
    """Sums over all boxes that start in the corner, seen along each axis."""
    sums = np.pad(rest.cumsum(axis=0).cumsum(axis=1).cumsum(axis=2), ((1, 0), (1, 0), (1, 0)))
    return sums, sums.transpose(1, 0, 2), sums.transpose(2, 0, 1)


def _grow(sums: Sums, start: tuple[np.intp, ...], order: tuple[int, ...]) -> tuple[float, Box]:
    """The box that grows from a cell when faces are moved in this order of axes, and its sum."""
    faces = [(int(at), int(at) + 1) for at in start]
    gain = -np.inf
    for _ in range(SWEEPS):
        before = gain
        for axis in order:
            along = _sums_along(sums, faces, axis)
            high = faces[axis][1]
            low = high - 1 - int(along[:high][::-1].argmin())  # of equals, the smallest box
            high = low + 1 + int(along[low + 1 :].argmax())
            faces[axis] = (low, high)
            gain = float(along[high] - along[low])
        if gain <= before:
            break
    x, y, z = (slice(low, high) for low, high in faces)
    return gain, (x, y, z)


def _sums_along(sums: Sums, faces: list[tuple[int, int]], axis: int) -> np.ndarray:
    """Sums over the cross-section of a box from the start of an axis to each place along it."""
    (a, b), (c, d) = faces[:axis] + faces[axis + 1 :]
    lines = sums[axis]
    return lines[:, b, d] - lines[:, a, d] - lines[:, b, c] + lines[:, a, c]


def reach_box(box: Float[np.ndarray, "6"], resolution: int, slack: float = 0.0) -> Box:
    """The cells that a box of an outline (centre and edges, unit lengths) reaches, at least one each way.

    Args:
        box: of a part.
        resolution: edge of the grid.
        slack: share of a cell that it may lie short of one that still counts.
    """
    low = (box[:3] - box[3:] / 2 + 0.5) * resolution
    high = (box[:3] + box[3:] / 2 + 0.5) * resolution
    first = np.floor(low - slack + ROUNDING).clip(0, resolution - 1).astype(int)
    last = np.ceil(high + slack - ROUNDING).clip(first + 1, resolution).astype(int)
    x, y, z = (slice(a, b) for a, b in zip(first, last, strict=True))
    return x, y, z
