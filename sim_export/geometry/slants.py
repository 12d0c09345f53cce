"""Detects slanted planes in stepped surfaces: tapered legs, sloping lids, rotated boxes.

A slightly slanted wall becomes long terraces one cell apart, too long for smoothing to level. Chains
of terraces that one plane explains are found by growing, and their vertices put on that plane.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from sim_export.geometry.face_planes import DIRECTIONS, FacePlanes

_LEAST_LEVELS = 3
"""Heights of the terraces of a plane: two are those of a step, however often it goes up and down."""
_LEAST_AREA = 36
_WIDE = 14
"""Cells; a patch that is wider both ways, and part of no slanted plane, is a panel between steps."""
_MOST_ERROR = 0.34
"""Root mean square distance of the faces from their plane; an exact digital plane has 0.29."""
_MOST_SLOPE = 0.4
"""Steeper surfaces have short terraces, which smoothing levels better: they may be curved."""
_TERRACE = (0.55, 1.7)
"""Cells by which the plane rises within one terrace; a flat panel beside a step has much less."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Slants:
    """Which faces lie on slanted planes, and which are flat for good.

    ``slant`` numbers the planes per direction and cell, -1 elsewhere. Row ``s`` of ``planes`` is
    (a, b, c): the coordinate along the face's axis is ``a u + b v + c`` with u and v along the next
    two axes, cyclically; lattice units. ``flat`` is `FacePlanes.flat` without slanted terraces and
    the risers between them, and with wide terraces that are on no slanted plane.
    """

    slant: Int[np.ndarray, "6 X Y Z"]
    planes: Float[np.ndarray, "S 3"]
    flat: Bool[np.ndarray, "6 X Y Z"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Patches:
    """Sums over the faces of every patch, and which patches are one step apart."""

    area: np.ndarray
    moments: np.ndarray  # P 4 4, outer products of (u, v, 1, level)
    lengths: np.ndarray  # P 2, mean run of faces along u and along v
    neighbours: dict[int, list[int]]


def find_slants(planes: FacePlanes) -> Slants:
    """Groups chains of terraces at three heights or more that one slanted plane explains."""
    padded = np.pad(planes.patch, ((0, 0), (1, 1), (1, 1), (1, 1)), constant_values=-1)
    count = int(padded.max()) + 1
    slant_of = np.full(count + 1, -1)
    flat = np.zeros(count + 1, dtype=bool)
    flat[planes.patch[planes.flat]] = True
    area = np.bincount(padded[padded >= 0], minlength=count)
    riser_hits = np.zeros(count)
    found: list[np.ndarray] = []
    for number, (axis, sign) in enumerate(DIRECTIONS):
        patches, steps, risers = _read_patches(padded, number, area)
        for group, plane in _grow_groups(patches):
            rows = np.isin(planes.patch[number], group)
            cells = np.argwhere(rows)
            depth = sign * (cells[:, axis] + (sign > 0) - planes.plane[number][rows])
            plane[2] -= sign * float(np.median(depth))
            slant_of[group] = len(found)
            found.append(plane)
        flat[:-1] |= (slant_of[:-1] < 0) & (patches.lengths.min(axis=1) >= _WIDE)
        inside = (slant_of[steps[0]] >= 0) & (slant_of[steps[0]] == slant_of[steps[1]])
        np.add.at(riser_hits, risers[inside], 1)
    flat[:-1] &= (slant_of[:-1] < 0) & (riser_hits <= area / 2)
    return Slants(
        slant=slant_of[planes.patch], planes=np.array(found).reshape(-1, 3), flat=flat[planes.patch]
    )


def _read_patches(
    padded: np.ndarray, number: int, area: np.ndarray
) -> tuple[_Patches, np.ndarray, np.ndarray]:
    """Sums of one direction's patches, its one-cell steps (lower, upper patch) and their risers."""
    axis, sign = DIRECTIONS[number]
    grid = padded[number]
    cells = np.argwhere(grid >= 0)
    ids = grid[tuple(cells.T)]
    out = np.eye(3, dtype=np.int64)
    in_plane = [(axis + 1) % 3, (axis + 2) % 3]
    columns = np.stack(
        [
            *(cells[:, other] - 0.5 for other in in_plane),
            np.ones(len(cells)),
            cells[:, axis] - 1.0 + (sign > 0),
        ],
        axis=1,
    )
    moments = np.zeros((len(area), 4, 4))
    for row, column in ((r, c) for r in range(4) for c in range(r, 4)):
        total = np.bincount(ids, weights=columns[:, row] * columns[:, column], minlength=len(area))
        moments[:, row, column] = moments[:, column, row] = total
    lengths = np.zeros((len(area), 2))
    steps, risers = [], []
    for place, other in enumerate(in_plane):
        starts = grid[tuple((cells - out[other]).T)] != ids
        runs = np.bincount(ids, weights=starts, minlength=len(area))
        lengths[:, place] = np.where(runs > 0, area / np.maximum(runs, 1), 0.0)
        for toward in (-1, 1):
            upper = cells + toward * out[other] + sign * out[axis]
            target = grid[tuple(upper.T)]
            at = np.flatnonzero(target >= 0)
            facing = DIRECTIONS.index((other, -toward))
            riser = padded[facing][tuple(upper[at].T)]
            steps.append(np.stack([ids[at], target[at]])[:, riser >= 0])
            risers.append(riser[riser >= 0])
    pairs = np.concatenate(steps, axis=1)
    neighbours: dict[int, list[int]] = {}
    for lower, upper in np.unique(np.concatenate([pairs, pairs[::-1]], axis=1), axis=1).T.tolist():
        neighbours.setdefault(lower, []).append(upper)
    patches = _Patches(area=area, moments=moments, lengths=lengths, neighbours=neighbours)
    return patches, pairs, np.concatenate(risers)


def _grow_groups(patches: _Patches) -> Iterable[tuple[list[int], np.ndarray]]:
    """Groups of patches on one slanted plane, from the largest patch down."""
    taken: set[int] = set()
    seeds = sorted(patches.neighbours, key=lambda patch: (-patches.area[patch], patch))
    for seed in seeds:
        if seed in taken or patches.area[seed] < 3:
            continue
        group, plane = _grow(patches, seed, taken)
        if plane is not None and _is_slanted(patches, group, plane):
            taken.update(group)
            yield group, plane


def _grow(patches: _Patches, seed: int, taken: set[int]) -> tuple[list[int], np.ndarray | None]:
    """Adds neighbouring terraces, largest first, as long as one plane explains all."""
    group, moments, plane = [seed], patches.moments[seed], None
    refused = set(taken) | {seed}
    waiting = set(patches.neighbours[seed]) - refused
    while waiting:
        best = max(waiting, key=lambda patch: (patches.area[patch], -patch))
        waiting.discard(best)
        refused.add(best)
        together = moments + patches.moments[best]
        fitted = _fit(together)
        if (
            _error(together, fitted) > _MOST_ERROR
            or _error(patches.moments[best], fitted) > 1.5 * _MOST_ERROR
        ):
            continue
        group.append(best)
        moments, plane = together, fitted
        waiting |= set(patches.neighbours[best]) - refused
    return group, plane


def _fit(moments: np.ndarray) -> np.ndarray:
    """Least squares plane (a, b, c) of the faces behind summed moments."""
    # A whisper of ridge keeps single rows of faces solvable: no slope where none can be seen.
    ridge = np.diag([1e-6, 1e-6, 0.0]) * moments[2, 2]
    return np.linalg.solve(moments[:3, :3] + ridge, moments[:3, 3])


def _error(moments: np.ndarray, plane: np.ndarray) -> float:
    """Root mean square residual of the faces behind summed moments."""
    row = np.append(plane, -1.0)
    return float(np.sqrt(max(row @ moments @ row, 0.0) / moments[2, 2]))


def _is_slanted(patches: _Patches, group: list[int], plane: np.ndarray) -> bool:
    """Whether a group is long enough, not too steep, and rises by about one cell per terrace."""
    area = patches.area[group]
    levels = np.unique(np.rint(patches.moments[group, 2, 3] / area))
    slope = np.abs(plane[:2])
    if len(levels) < _LEAST_LEVELS or area.sum() < _LEAST_AREA or slope.max() > _MOST_SLOPE:
        return False
    rise = (slope * patches.lengths[group]).max(axis=1)
    fits = (rise > _TERRACE[0]) & (rise < _TERRACE[1])
    return bool(fits.sum() >= 2 and area[fits].sum() > 0.6 * area.sum())
