"""Where a voxel lies: in its part, in the object, and what comes next on every side of it.

What colour a side of a voxel has follows mostly from that: linings look at trays, a plinth lies below all
doors, a panel surrounds its knobs. `artigen.models.painter` reads it instead of learning to look for it.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from artigen.facings import FACINGS, facing_frames
from artigen.types import PART_LABELS

NEAR = 8.0
"""Voxels within which the ends of a part or of the object, and parts of other labels, are told apart."""
GAP = 4.0
"""Voxels over which it fades how far away the next thing is."""
_KINDS = len(PART_LABELS) + 1
_ENDS = 3 + 2 * 6
SURROUNDINGS = 2 * _ENDS + FACINGS * (3 + _KINDS) + 2 * len(PART_LABELS)
"""Numbers that `describe_surroundings` gives for a voxel."""


def describe_surroundings(
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    labels: Int[np.ndarray, "P"],
    resolution: int,
    rows: Int[np.ndarray, "K"] | None = None,
) -> Float[np.ndarray, "K 118"]:
    """Where voxels lie, as numbers of about one (float32).

    Place within the extents of the part, and how near each of their ends is; the same of the object. Then, to
    the outer side, to the inner one, and across: how far the part goes on, how wide the gap beyond it is and
    the label of what comes next. Last, how near every label is.

    Args:
        coords: Cells (x, y, z) of the grid.
        part_ids: Part of each.
        facings: Directions of their outer sides (`artigen.facings`).
        labels: Label of each part, as its number in `PART_LABELS`.
        resolution: Edge of the grid.
        rows: Voxels to describe, all by default.
    """
    cells = coords.astype(np.int64)
    rows = np.arange(len(cells)) if rows is None else rows
    told = (
        _place_within(cells, part_ids, rows),
        _place_within(cells, np.zeros(len(cells), dtype=np.int64), rows),
        _look_around(cells, part_ids, facings, labels, resolution, rows),
        _measure_nearness(cells, labels[part_ids], rows),
    )
    return np.concatenate(told, axis=1).astype(np.float32)


def _place_within(
    cells: Int[np.ndarray, "N 3"], groups: Int[np.ndarray, "N"], rows: Int[np.ndarray, "K"]
) -> Float[np.ndarray, "K 15"]:
    """Place within the extents of a voxel's group, -1 to 1, and nearness and touch of their six ends."""
    count = int(groups.max()) + 1
    low, high = np.full((count, 3), np.iinfo(np.int64).max), np.full((count, 3), -1)
    np.minimum.at(low, groups, cells)
    np.maximum.at(high, groups, cells)
    below, above = cells[rows] - low[groups[rows]], high[groups[rows]] - cells[rows]
    place = (below - above) / np.maximum(below + above, 1)
    ends = np.concatenate([below, above], axis=1)
    return np.concatenate([place, np.minimum(ends, NEAR) / NEAR, ends == 0], axis=1)


def _look_around(
    cells: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    labels: Int[np.ndarray, "P"],
    resolution: int,
    rows: Int[np.ndarray, "K"],
) -> Float[np.ndarray, "K 72"]:
    """What lies in the six directions of the frame of each voxel's outer side: +x, -x, +y, -y, +z, -z."""
    kinds = np.append(labels[part_ids], len(PART_LABELS))  # the last one: nothing
    seen = np.empty((FACINGS, len(rows), 3 + _KINDS))
    for axis in range(3):
        across = np.delete(cells, axis, axis=1)
        line, place = across[:, 0] * resolution + across[:, 1], cells[:, axis]
        for way, sign in enumerate((-1, 1)):
            order = np.lexsort((sign * place, line))
            steps, gap, following = _walk_lines(line[order], place[order], part_ids[order])
            back = np.empty_like(order)
            back[order] = np.arange(len(order))
            at = back[rows]
            after = np.append(order, len(order))[following[at]]
            seen[2 * axis + way] = np.concatenate(
                [
                    np.stack([np.minimum(steps[at], NEAR) / NEAR, np.exp(-gap[at] / GAP)], axis=1),
                    np.minimum(gap[at], resolution)[:, None] / resolution,
                    np.eye(_KINDS)[kinds[after]],
                ],
                axis=1,
            )
    frames = np.round(facing_frames()).astype(np.int64)
    ways = np.concatenate([frames, -frames], axis=2)[:, :, [0, 3, 1, 4, 2, 5]]  # columns: directions
    axes, signs = np.abs(ways).argmax(axis=1), ways.sum(axis=1)
    numbers = (2 * axes + (signs > 0))[facings[rows]]
    return seen[numbers, np.arange(len(rows))[:, None]].reshape(len(rows), -1)


def _walk_lines(
    line: Int[np.ndarray, "N"], place: Int[np.ndarray, "N"], part_ids: Int[np.ndarray, "N"]
) -> tuple[Int[np.ndarray, "N"], Int[np.ndarray, "N"], Int[np.ndarray, "N"]]:
    """Of voxels in the order of their lines: steps to the end of their run of one part, the gap beyond it,
    the voxel after it. Where there is none, their number and a gap without end."""
    count = len(line)
    distance = np.abs(np.diff(place))
    follows = line[1:] == line[:-1]
    goes_on = follows & (distance == 1) & (part_ids[1:] == part_ids[:-1])
    ends = np.flatnonzero(np.append(~goes_on, True))
    last = ends[np.searchsorted(ends, np.arange(count))]
    open_end = np.append(~follows, True)[last]
    following = np.where(open_end, count, last + 1)
    gap = np.where(open_end, np.iinfo(np.int32).max, np.append(distance, 1)[last] - 1)
    return np.abs(place[last] - place), gap, following


def _measure_nearness(
    cells: Int[np.ndarray, "N 3"], kinds: Int[np.ndarray, "N"], rows: Int[np.ndarray, "K"]
) -> Float[np.ndarray, "K 16"]:
    """How near the nearest voxel of every label is, on two scales; 0 where there is none about."""
    out = np.zeros((2, len(PART_LABELS), len(rows)))
    for kind in range(len(PART_LABELS)):
        if not (kinds == kind).any():
            continue
        reach = 3.0 * NEAR
        away = KDTree(cells[kinds == kind]).query(cells[rows], distance_upper_bound=reach)[0]
        away = np.minimum(away, reach)
        out[:, kind] = np.exp(-away / 2.0), 1.0 - away / reach
    return out.reshape(-1, len(rows)).T
