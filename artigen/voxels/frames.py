"""Outward direction of each voxel: a board thinner than a voxel has two sides, an outer and an inner one.

The direction depends on the voxels alone. It is therefore the same in training, where pictures show both
sides, and for a sampled structure, whose sides are yet to be coloured. Functions take the cells (x, y, z) of
the grid, each at most once, and the part and outward direction of each.
"""

import numpy as np
from jaxtyping import Bool, Float, Int, Integer, Real
from scipy.ndimage import uniform_filter

from artigen.types import VoxelGrid

FACINGS = 6
"""Directions: -x, +x, -y, +y, -z, +z."""
SIDES = 2
"""Sides of a voxel: outer, inner."""
AROUND = 4
"""Neighbours of a voxel in the plane of its sides."""
CLEAR = 3
"""Distance in cells from which a voxel before a side covers it; nearer ones are the board's other face."""
LONGEST = 5
"""Cells at which run lengths are clipped, and coordinate span from which a part is not thin."""


def find_facings(
    coords: Integer[np.ndarray, "N 3"], part_ids: Integer[np.ndarray, "N"], resolution: int
) -> Int[np.ndarray, "N"]:
    """Direction (0 to 5) that the outer side of each voxel faces.

    Its axis is the one along which the part is locally thinnest. It points away from the middle of the part
    or, along axes on which the part as a whole is thin, away from the middle of the object.
    """
    cells, grid = coords.astype(np.int64), mark_voxels(coords, part_ids, resolution)
    runs = np.stack([np.minimum(_measure_runs(grid, axis), LONGEST) for axis in range(3)]).astype(np.float32)
    thickness = np.empty((3, len(cells)), dtype=np.float32)
    for part in np.unique(part_ids):
        own = part_ids == part
        low, high = cells[own].min(axis=0), cells[own].max(axis=0)
        within = tuple(slice(first, last + 1) for first, last in zip(low, high, strict=True))
        place, inside = tuple((cells[own] - low).T), grid[within] == part
        count = uniform_filter(inside.astype(np.float32), 3, mode="constant")[place]
        for axis in range(3):
            total = uniform_filter(np.where(inside, runs[axis][within], 0.0), 3, mode="constant")[place]
            thickness[axis, own] = total / count
    return find_outward(coords, part_ids, np.round(thickness, 3).argmin(axis=0))


def find_outward(
    coords: Integer[np.ndarray, "N 3"], part_ids: Integer[np.ndarray, "N"], axes: Integer[np.ndarray, "N"]
) -> Int[np.ndarray, "N"]:
    """Direction (0 to 5) along each voxel's axis that points away from the inside."""
    cells, every = coords.astype(np.int64), np.arange(len(coords))
    middle = _find_middles(cells, part_ids, float(LONGEST))
    return 2 * axes + (cells[every, axes] > middle[every, axes])


def find_covered(
    coords: Integer[np.ndarray, "N 3"], facings: Integer[np.ndarray, "N"], resolution: int
) -> Bool[np.ndarray, "N 2"]:
    """Whether the object has a voxel straight before the outer and the inner side of each voxel."""
    cells = coords.astype(np.int64)
    lowest, highest = np.full((2, 3, resolution, resolution), -1)
    lowest[:] = resolution
    across = [np.delete(cells, axis, axis=1).T for axis in range(3)]
    for axis, (row, column) in enumerate(across):
        np.minimum.at(lowest[axis], (row, column), cells[:, axis])
        np.maximum.at(highest[axis], (row, column), cells[:, axis])
    below, above = (
        np.stack([ends[axis, row, column] for axis, (row, column) in enumerate(across)], axis=1)
        for ends in (lowest, highest)
    )
    every, axis = np.arange(len(cells)), facings // 2
    place = cells[every, axis]
    down, up = place - below[every, axis] >= CLEAR, above[every, axis] - place >= CLEAR
    return np.where((facings % 2 == 1)[:, None], np.stack([up, down], axis=1), np.stack([down, up], axis=1))


def find_joined(
    coords: Integer[np.ndarray, "N 3"],
    part_ids: Integer[np.ndarray, "N"],
    facings: Integer[np.ndarray, "N"],
    resolution: int,
) -> Bool[np.ndarray, "N 2 2"]:
    """Whether the part of each voxel continues in the adjacent cells in the plane of its sides.

    Returns:
        By axis (+y and +z of the frame of the outer side, `facing_frames`), then before and after the voxel.
    """
    grid = np.pad(mark_voxels(coords, part_ids, resolution), 1, constant_values=-1)
    cells = coords.astype(np.int64) + 1
    across = np.round(facing_frames()[facings]).astype(np.int64)[:, :, 1:]
    around = [[cells + way * across[:, :, axis] for way in (-1, 1)] for axis in range(2)]
    return np.stack(
        [np.stack([grid[tuple(place.T)] == part_ids for place in ways], axis=1) for ways in around], axis=1
    )


def count_behind(
    coords: Integer[np.ndarray, "N 3"],
    part_ids: Integer[np.ndarray, "N"],
    facings: Integer[np.ndarray, "N"],
    resolution: int,
) -> Int[np.ndarray, "N"]:
    """Thickness in cells of each voxel's part at the voxel, along the axis of its facing."""
    grid, place = mark_voxels(coords, part_ids, resolution), tuple(coords.astype(np.int64).T)
    return np.choose(facings // 2, [_measure_runs(grid, axis)[place] for axis in range(3)])


def mark_voxels(
    coords: Integer[np.ndarray, "N 3"], numbers: Integer[np.ndarray, "N"], resolution: int
) -> Int[np.ndarray, "R R R"]:
    """Dense grid of the number of each voxel, such as its part id; -1 in empty cells."""
    grid = np.full((resolution,) * 3, -1)
    grid[tuple(coords.astype(np.int64).T)] = numbers
    return grid


def gather_voxels(owners: Int[np.ndarray, "R R R"]) -> VoxelGrid:
    """The voxels of a dense grid of part ids, -1 in empty cells: inverse of `mark_voxels`."""
    coords = np.argwhere(owners >= 0)
    return VoxelGrid(resolution=len(owners), coords=coords, part_ids=owners[tuple(coords.T)])


def facing_frames() -> Float[np.ndarray, "6 3 3"]:
    """Rotation per direction from the frame of an outer side, which faces +x in it, to the grid's frame."""
    frames = np.zeros((FACINGS, 3, 3))
    for axis in range(3):
        for way, sign in enumerate((-1.0, 1.0)):
            frame = frames[2 * axis + way]
            frame[axis, 0] = sign
            frame[(axis + 1) % 3, 1] = 1.0
            frame[(axis + 2) % 3, 2] = sign
    return frames


def _find_middles(
    points: Real[np.ndarray, "N 3"], part_ids: Integer[np.ndarray, "N"], thin: float
) -> Float[np.ndarray, "N 3"]:
    """Middle of each point's part, or of the object along axes on which the part spans less than ``thin``."""
    out = np.tile(_middle(points), (len(points), 1))
    for part in np.unique(part_ids):
        own = part_ids == part
        wide = np.ptp(points[own], axis=0) >= thin
        out[own] = np.where(wide, _middle(points[own]), out[own])
    return out


def _middle(points: Real[np.ndarray, "N 3"]) -> Float[np.ndarray, "3"]:
    return (points.min(axis=0) + points.max(axis=0)) / 2.0


def _measure_runs(grid: Int[np.ndarray, "R R R"], axis: int) -> Int[np.ndarray, "R R R"]:
    """Length of the run of equal values through each cell along an axis."""
    lines = np.moveaxis(grid, axis, 2)
    starts = np.ones(lines.shape, dtype=bool)
    starts[:, :, 1:] = lines[:, :, 1:] != lines[:, :, :-1]
    run = np.cumsum(starts.ravel()) - 1
    return np.moveaxis(np.bincount(run)[run].reshape(lines.shape), 2, axis)
