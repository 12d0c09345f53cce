"""Fits planes to the exposed cell faces of a blocky part.

Marking every cell that a surface touches makes a solid half a cell too thick on average, and loses the
position of a wall within its cell. This module groups exposed cell faces into coplanar patches and moves each
patch to its most likely plane (a face of the part's box for patches at the part's extremes). It distinguishes
flat patches from the terraces of slanted and curved surfaces.

Lattice units: cell (i, j, k) covers [i, i + 1] x [j, j + 1] x [k, k + 1].
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from artigen.types import Part
from sim_export.geometry.rows import connect_rows

DIRECTIONS: tuple[tuple[int, int], ...] = ((0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1))
"""(axis, sign) of the six face normals, in the order in which faces are listed everywhere."""
INSET = 0.5
"""Inward shift of a patch backed by two or more cells: voxelising dilates by half a cell."""
THIN_INSET = 0.1
"""Inward shift of a patch backed by one cell."""
CONTACT_SHARE = 0.1
"""Share of a patch's faces that other parts must touch for the patch to count as touched."""
MIN_THICKNESS = 0.8
"""Smallest wall thickness between two opposite patches; furniture board is about a cell."""
MIN_BOX_THICKNESS = 0.4
"""The same for two patches on the part's box, which gives the true thickness."""
BOX_REACH = 1.25
"""Largest distance at which a patch at the part's extreme snaps to the box face."""
MAX_STEP_FRACTION = 0.3
"""A patch with more one-cell steps than this along its boundary may be a terrace."""
SPECK_FRACTION = 0.03
"""Steps to patches smaller than this fraction of a patch's own area are ignored."""
MARGIN = 3
"""Empty cells around the grid: the largest distance of a cell that is examined from an exposed face."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FacePlanes:
    """Fitted planes per direction (order of `DIRECTIONS`) and cell.

    ``plane`` is the fitted coordinate along the face's axis in lattice units, NaN where the face is not
    exposed. ``flat`` is True where the face belongs to a plane patch, False on slanted and curved surfaces.
    ``patch`` numbers the patches from 0 over all directions, -1 elsewhere.
    """

    plane: Float[np.ndarray, "6 X Y Z"]
    flat: Bool[np.ndarray, "6 X Y Z"]
    patch: Int[np.ndarray, "6 X Y Z"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Faces:
    """Every exposed face as one row; cells are flat indices into a grid padded by `MARGIN`.

    ``edges``, ``double_up`` and ``double_down`` count the sides of a face where its patch ends, and those
    where the surface continues exactly two cells higher or lower.
    """

    direction: np.ndarray
    cell: np.ndarray
    patch: np.ndarray
    thick: np.ndarray
    inner: np.ndarray
    edges: np.ndarray
    double_up: np.ndarray
    double_down: np.ndarray
    grid: np.ndarray
    solid: np.ndarray


@dataclass(frozen=True, kw_only=True, eq=False)
class _Steps:
    """Boundary edges beyond which a patch continues one cell higher or lower, by patch number."""

    source: np.ndarray
    target: np.ndarray
    riser: np.ndarray
    climbs: np.ndarray


def box_in_lattice(part: Part, resolution: int) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner of a part's box in lattice units."""
    center, size = part.box
    return (np.stack([center - size / 2, center + size / 2]) + 0.5) * resolution


def fit_face_planes(
    occupancy: Bool[np.ndarray, "X Y Z"],
    box: Float[np.ndarray, "2 3"],
    others: Bool[np.ndarray, "X2 Y2 Z2"] | None = None,
) -> FacePlanes:
    """Fits a plane to every exposed face of a part; ``box`` is its lowest and highest corner.

    ``others``, three cells larger on every side, marks the cells of other parts: a surface that another part
    touches lies at the border between their cells. Lattice units, measured from the corner of ``occupancy``.
    Patches are in-plane connected, and all faces of a flat patch share one coordinate. Raises `ValueError` if
    no cell is occupied.
    """
    if not occupancy.any():
        raise ValueError("face planes: no occupied cell")
    faces, steps = _read_faces(np.pad(occupancy, MARGIN))
    level = np.stack(np.unravel_index(faces.cell, faces.grid.shape[1:]), axis=1) - MARGIN
    axis, sign = np.array(DIRECTIONS)[faces.direction].T
    blocky = level[np.arange(len(level)), axis] + (sign > 0)
    touched = np.zeros(len(level), dtype=bool)
    if others is not None:
        beside = level + MARGIN
        beside[np.arange(len(level)), axis] += sign
        touched = others[tuple(beside.T)]
    coordinate, at_box = _place_patches(faces, blocky, box, touched)
    coordinate = _keep_thickness(faces, coordinate, at_box)
    flat = _find_flat(faces, steps)
    plane = coordinate[faces.patch]
    curved = ~flat[faces.patch] & ~at_box[faces.patch]
    if curved.any():
        outward = _outwardness(level, axis, sign, box)
        shift = _curved_inset(faces, outward)[curved]
        plane[curved] = blocky[curved] - sign[curved] * shift
    planes = np.full((6, faces.grid[0].size), np.nan)
    planes[faces.direction, faces.cell] = plane
    inside = (slice(None), *(slice(MARGIN, -MARGIN),) * 3)
    patch = faces.grid[inside]
    return FacePlanes(
        plane=planes.reshape(faces.grid.shape)[inside], flat=np.append(flat, False)[patch], patch=patch
    )


def _curved_inset(faces: _Faces, outward: np.ndarray) -> np.ndarray:
    """Inward shift of every face under the assumption of a curved or slanted wall.

    A voxelised sheet with normal n has |n|_1 cells and 2 |n|_1 exposed faces per area, for every n, and each
    cell of thickness adds one cell. The ratio of cells to pairs of faces around a face therefore estimates
    the wall thickness, and how far both sides may move in until `min_thickness` is left. For thin walls, the
    outer side moves to the surface and the inner side keeps the thickness.
    """
    shape = faces.grid.shape[1:]
    exposed = np.bincount(faces.cell, minlength=faces.grid[0].size).reshape(shape).astype(np.float32)
    solid = faces.solid.astype(np.float32)
    cells, sides = (ndimage.uniform_filter(grid, 5, mode="constant") for grid in (solid, exposed))
    thickness = 2.0 * cells.ravel()[faces.cell] / np.maximum(sides.ravel()[faces.cell], 1e-6)
    even = np.clip((thickness - MIN_THICKNESS) / 2.0, 0.0, INSET)
    return even + outward * (INSET - even)


def _outwardness(level: np.ndarray, axis: np.ndarray, sign: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Ranges from 1 for faces at the box that face outwards to -1 for those that face inwards there."""
    rows = np.arange(len(level))
    center, half = box.mean(axis=0), np.maximum(np.ptp(box, axis=0) / 2.0, 1.0)
    return np.clip(sign * (level[rows, axis] + 0.5 - center[axis]) / half[axis], -1.0, 1.0)


def _read_faces(solid: np.ndarray) -> tuple[_Faces, _Steps]:
    """Lists exposed faces with their patches and boundary edges, and the one-cell steps."""
    strides = np.array(solid.strides) // solid.itemsize
    full = solid.ravel()
    cells = [np.flatnonzero(solid & ~np.roll(solid, -sign, axis)) for axis, sign in DIRECTIONS]
    direction = np.repeat(np.arange(6), [len(cell) for cell in cells])
    cell = np.concatenate(cells)
    axis, sign = np.array(DIRECTIONS)[direction].T
    outward = sign * strides[axis]
    row = np.full((6, full.size), -1, dtype=np.int32)
    row[direction, cell] = np.arange(len(cell))
    # The four in-plane neighbours of each face, as directions of the two other axes.
    around = np.array([[n for n in range(6) if n // 2 != a] for a in range(3)])[axis].T
    shifts = np.array([s * strides[a] for a, s in DIRECTIONS])

    edges, double_up, double_down = (np.zeros(len(cell), dtype=np.int64) for _ in range(3))
    links, steps = [], []
    for toward in around:
        beside = cell + shifts[toward]
        concave = full[beside + outward]
        coplanar = ~concave & full[beside]
        edges += ~coplanar
        at = np.flatnonzero(coplanar)
        links.append(np.stack([at, row[direction[at], beside[at]]]))
        higher, lower = full[beside + 2 * outward], full[beside - outward]
        double_up += concave & higher & ~full[beside + 3 * outward]
        double_down += ~concave & ~coplanar & ~lower & full[beside - 2 * outward]
        at = np.flatnonzero(concave & ~higher)
        above = beside[at] + outward[at]
        steps.append((at, row[direction[at], above], row[toward[at] ^ 1, above], True))
        at = np.flatnonzero(~concave & ~coplanar & lower)
        below = beside[at] - outward[at]
        steps.append((at, row[direction[at], below], row[toward[at], cell[at]], False))

    patch = connect_rows(np.concatenate(links, axis=1), len(cell))
    grid = np.append(patch, -1)[row].reshape(6, *solid.shape)
    first, second = shifts[around[1]], shifts[around[3]]
    by_cell = grid.reshape(6, -1)
    offsets = (a * first + b * second for a in (-3, 0, 3) for b in (-3, 0, 3))
    inner = np.all([by_cell[direction, cell + offset] == patch for offset in offsets], axis=0)
    faces = _Faces(
        direction=direction,
        cell=cell,
        patch=patch,
        thick=full[cell - outward],
        inner=inner,
        edges=edges,
        double_up=double_up,
        double_down=double_down,
        grid=grid,
        solid=solid,
    )
    source, target, riser = (patch[np.concatenate([step[n] for step in steps])] for n in range(3))
    climbs = np.concatenate([np.full(len(step[0]), step[3]) for step in steps])
    return faces, _Steps(source=source, target=target, riser=riser, climbs=climbs)


def _place_patches(
    faces: _Faces, blocky: np.ndarray, box: np.ndarray, touched: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Fitted coordinate of every patch, and whether it was placed on the box."""
    area = np.bincount(faces.patch)
    thick = np.bincount(faces.patch, weights=faces.thick) > area / 2
    level, direction = np.zeros(len(area)), np.zeros(len(area), dtype=np.int64)
    level[faces.patch], direction[faces.patch] = blocky, faces.direction
    axis, sign = np.array(DIRECTIONS)[direction].T
    extreme = np.full(6, -np.inf)
    np.maximum.at(extreme, direction, sign * level)
    side = box[(sign > 0).astype(int), axis]
    at_box = (sign * level == extreme[direction]) & (np.abs(side - level) <= BOX_REACH)
    contact = np.bincount(faces.patch, weights=touched) > CONTACT_SHARE * area
    inset = np.where(thick & ~contact, INSET, THIN_INSET)
    return np.where(at_box, side, level - sign * inset), at_box


def _keep_thickness(faces: _Faces, coordinate: np.ndarray, at_box: np.ndarray) -> np.ndarray:
    """Moves opposite patches apart where a wall of one or two cells became too thin.

    Of two patches, the one that is not on the box moves; otherwise both move by half.
    """
    out = coordinate.copy()
    for axis in range(3):
        low = np.moveaxis(faces.grid[2 * axis], axis, 0)
        high = np.moveaxis(faces.grid[2 * axis + 1], axis, 0)
        pairs = []
        for upper, lower in ((high, low), (high[1:], low[:-1])):
            opposite = (upper >= 0) & (lower >= 0)
            pairs.append(np.stack([lower[opposite], upper[opposite]]))
        lower, upper = np.unique(np.concatenate(pairs, axis=1), axis=1)
        both = at_box[lower] & at_box[upper]
        least = np.where(both, MIN_BOX_THICKNESS, MIN_THICKNESS)
        missing = np.maximum(least - (coordinate[upper] - coordinate[lower]), 0.0)
        share = np.where(at_box[lower] == at_box[upper], 0.5, np.where(at_box[lower], 0.0, 1.0))
        move = np.zeros_like(out)
        np.minimum.at(move, lower, -missing * share)
        np.maximum.at(move, upper, missing * (1.0 - share))
        out += move
    return out


def _find_flat(faces: _Faces, steps: _Steps) -> np.ndarray:
    """Flags patches that are flat and not terraces of slanted or curved surfaces.

    A terrace has steps of one cell up on one side and down on the other. If it is less than seven cells wide,
    one of the two may be a step of two cells. The top of a curved surface only steps down, but to terraces,
    or is as narrow. A raised or sunk panel steps to patches that are no terraces, and stays flat. A riser
    beside a terrace is not flat either, even if it is long. Steps to specks are ignored.
    """
    patch = faces.patch
    area = np.bincount(patch)
    count = len(area)

    def total(rows: np.ndarray, weights: np.ndarray) -> np.ndarray:
        return np.bincount(rows, weights=weights, minlength=count)

    counts = area[steps.target] >= SPECK_FRACTION * area[steps.source]
    edges = np.maximum(total(patch, faces.edges) - total(steps.source, ~counts), 1)
    up = total(steps.source, counts & steps.climbs) / edges
    down = total(steps.source, counts & ~steps.climbs) / edges
    narrow = total(patch, faces.inner) == 0
    most = MAX_STEP_FRACTION
    terrace = (up > most / 2) & (down > most / 2)
    terrace |= narrow & (down > most)
    double_up = up + total(patch, faces.double_up) / edges
    double_down = down + total(patch, faces.double_down) / edges
    terrace |= narrow & (np.minimum(double_up, double_down) > most / 2) & (up + down > most / 2)
    to_terrace = total(steps.source, counts & terrace[steps.target])
    terrace = terrace | ((up + down > most / 2) & (to_terrace > (up + down) * edges / 2))
    beside = terrace[steps.source] | terrace[steps.target]
    # Both ends of a step list the same riser face, once from above and once from below.
    return ~(terrace | (total(steps.riser, beside / 2) > area / 2))
