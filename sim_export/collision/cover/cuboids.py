"""The largest boxes in a solid or between cells: few, with faces on the mesh.

Boxes may overlap. That needs fewer of them than a partition, leaves no seam between neighbours,
and costs nothing: mass comes from the part's own volume, and no simulator collides the hulls of
one link with each other.
"""

from collections.abc import Iterator, Sequence
from itertools import islice, pairwise, permutations

import numpy as np
from jaxtyping import Bool, Float, Int

from sim_export.collision.hull_limits import MIN_WIDTH
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.solids import inside_grid
from sim_export.geometry.triangles import area_normals, diagonal_of
from sim_export.package import Hull

FIRST_SEEDS = 48
"""Uncovered cells tried as the start of the first box."""
MORE_SEEDS = 12
"""Uncovered cells tried for every further box; what grew from earlier ones is still at hand."""
MIN_ALIGNED_AREA = 0.5
"""Share of the surface that must be axis-aligned before boxes are tried."""
PLANE_DETAIL = 3e-3
"""Share of the surface that a plane must hold for boxes to end there."""
CELLS = 64
"""Cells along the longest edge at least, between which boxes may end, too."""
MOST = 40
"""Boxes of a solid, at most."""
LEAST_GAIN = 0.002
"""Share of a solid that a box must newly fill."""
SNAP = 5e-4
"""Planes closer together than this share of the diagonal are one."""
UNEVEN = 0.012
"""Nearly aligned faces within this share of the diagonal make one plane."""
LEAST_UNEVEN = 0.005
"""Least share of the surface of such a plane."""
MAX_PLANES = 64
"""Planes per axis, largest first."""


def largest_cuboids(
    occupancy: Bool[np.ndarray, "X Y Z"], edges: Sequence[Float[np.ndarray, "A"]], count: int, least: float
) -> Float[np.ndarray, "K 2 3"]:
    """Few boxes that cover every occupied cell and no other, each as large as can be: lowest and highest
    corner, in the order found.

    Args:
        edges: Coordinates between the cells along each axis.
        count: Where more boxes are needed, the rest is left out, which is detail.
        least: So are boxes that newly cover no more than this share of what is occupied.
    """
    boxes = [*islice(_greedy_cuboids(occupancy, edges, least), count)]
    corners = [[[edges[n][box[end, n]] for n in range(3)] for end in range(2)] for box in boxes]
    return np.array(corners).reshape(-1, 2, 3)


def _greedy_cuboids(occupancy: np.ndarray, ends: Sequence[np.ndarray], least: float) -> Iterator[np.ndarray]:
    """Of the maximal boxes around some uncovered cells, the one that covers most that is new comes next."""
    compressed, edges = compress(occupancy)
    sizes = [np.diff(end[edge]) for end, edge in zip(ends, edges, strict=True)]
    weights = sizes[0][:, None, None] * sizes[1][:, None] * sizes[2]
    filled = count_filled(compressed)
    enough = least * float(weights[compressed].sum())
    missing = compressed.copy()
    candidates = np.zeros((0, 2, 3), dtype=np.int64)
    seeds = FIRST_SEEDS
    while missing.any():
        # The heaviest uncovered cells lie in the largest boxes; strides keep the choice spread out.
        cells = np.argwhere(missing)
        cells = cells[np.argsort(-weights[tuple(cells.T)], kind="stable")]
        cells = cells[:: max(1, len(cells) // seeds)][: 2 * seeds]
        candidates = np.concatenate([candidates, grow_boxes(filled, cells)])
        gains = box_sums(count_filled(missing * weights), candidates)
        candidates, gains = candidates[gains > enough], gains[gains > enough]
        if not len(candidates):
            return
        seeds = MORE_SEEDS
        best = candidates[gains.argmax()]
        missing[tuple(slice(low, high) for low, high in best.T)] = False
        yield np.array([[edges[axis][best[end, axis]] for axis in range(3)] for end in range(2)])


def fill_with_boxes(triangles: Float[np.ndarray, "F 3 3"]) -> tuple[Hull, ...]:
    """The largest boxes in a solid (m), with faces on its own; none where few of these are axis-aligned.

    Its planes, and more between them, divide space into cells of unequal size.
    """
    vertices, faces = triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    planes = face_coordinates(vertices, faces, PLANE_DETAIL)
    if planes is None:
        return ()
    step = float(np.ptp(vertices, axis=0).max()) / CELLS
    edges = [_subdivide(plane, step) for plane in planes]
    x, y, z = ((edge[:-1] + 0.4871 * np.diff(edge)) for edge in edges)  # on no plane of symmetry
    boxes = largest_cuboids(inside_grid(vertices, faces, (x, y, z)), edges, MOST, LEAST_GAIN)
    return tuple(box_hull(low, high) for low, high in boxes if (high - low).min() >= MIN_WIDTH)


def _subdivide(planes: Float[np.ndarray, "A"], step: float) -> Float[np.ndarray, "B"]:
    """Coordinates with more in between, none farther than ``step`` from the next."""
    out = [planes[:1]]
    for low, high in pairwise(planes):
        out.append(np.linspace(low, high, int(np.ceil((high - low) / step)) + 1)[1:])
    return np.concatenate(out)


def face_coordinates(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], detail: float
) -> tuple[Float[np.ndarray, "X"], Float[np.ndarray, "Y"], Float[np.ndarray, "Z"]] | None:
    """Coordinates of the axis-aligned faces along each axis, the mesh's bounds included.

    Faces that are aligned but for a few degrees or bumps count as well, at their mean coordinate,
    where no other plane is near: else a whole board would have no face to end at.
    """
    diagonal = diagonal_of(vertices)
    corners = vertices[faces]
    normals = area_normals(corners)
    area = np.linalg.norm(normals, axis=1)
    least = detail * area.sum()
    aligned = np.abs(normals) > 0.999 * area[:, None]
    nearly = np.abs(normals) > 0.94 * area[:, None]
    if area[nearly.any(axis=1)].sum() < MIN_ALIGNED_AREA * area.sum():
        return None
    out = []
    for axis in range(3):
        kept = [vertices[:, axis].min(), vertices[:, axis].max()]
        at = corners[:, :, axis].mean(axis=1)
        for chosen, gap, enough in (
            (aligned[:, axis], SNAP * diagonal, least),
            (nearly[:, axis], UNEVEN * diagonal, max(least, LEAST_UNEVEN * area.sum())),
        ):
            kept += _new_planes(kept, at[chosen], area[chosen], gap, enough)
        out.append(np.sort(kept))
    return out[0], out[1], out[2]


def _new_planes(
    kept: list[float], at: np.ndarray, weight: np.ndarray, gap: float, enough: float
) -> list[float]:
    """Coordinates where faces of total area ``enough`` lie, largest first, none within ``gap`` of another."""
    new: list[float] = []
    left = np.abs(at[:, None] - np.array(kept)).min(axis=1) >= gap
    at, weight = at[left], weight[left]
    order = np.argsort(at, kind="stable")
    at, weight = at[order], weight[order]
    while len(at) and len(kept) + len(new) < MAX_PLANES:
        # Area within a gap of each face, from running sums over the sorted coordinates.
        sums = np.concatenate([[0.0], np.cumsum(weight)])
        low, high = np.searchsorted(at, at - gap / 2), np.searchsorted(at, at + gap / 2, side="right")
        near = sums[high] - sums[low]
        best = int(near.argmax())
        if near[best] < enough:
            break
        members = slice(low[best], high[best])
        new.append(float(np.average(at[members], weights=weight[members])))
        left = np.abs(at - new[-1]) >= gap
        at, weight = at[left], weight[left]
    return new


def compress(occupancy: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Merges equal neighbouring slices along every axis; returns the small grid and its cell edges."""
    edges = []
    for axis in range(3):
        slices = np.moveaxis(occupancy, axis, 0).reshape(occupancy.shape[axis], -1)
        changes = np.flatnonzero((slices[1:] != slices[:-1]).any(axis=1)) + 1
        edges.append(np.array([0, *changes, occupancy.shape[axis]]))
    return occupancy[np.ix_(*(edge[:-1] for edge in edges))], edges


def count_filled(values: np.ndarray) -> np.ndarray:
    """Sums over all boxes from the origin, padded by one."""
    sums = np.zeros(np.add(values.shape, 1), dtype=np.int32 if values.dtype == bool else values.dtype)
    sums[1:, 1:, 1:] = values
    for axis in range(3):
        np.cumsum(sums, axis=axis, out=sums)
    return sums


def empty_box(values: np.ndarray, sums: np.ndarray, box: np.ndarray) -> None:
    """Makes the values in a box ``[2 3]`` zero, and subtracts them from the sums (`count_filled`)."""
    window = tuple(slice(low, high) for low, high in box.T)
    inner = count_filled(values[window])
    # Beyond the box all of it counts.
    at = [
        np.minimum(np.arange(count - low), high - low)
        for count, (low, high) in zip(sums.shape, box.T, strict=True)
    ]
    sums[tuple(slice(low, None) for low in box[0])] -= inner[np.ix_(*at)]
    values[window] = 0


def box_sums(integral: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """Sum of the values in every box ``[K 2 3]``."""
    (x0, y0, z0), (x1, y1, z1) = boxes[:, 0].T, boxes[:, 1].T
    return (
        integral[x1, y1, z1] - integral[x0, y1, z1] - integral[x1, y0, z1] - integral[x1, y1, z0]
        + integral[x0, y0, z1] + integral[x0, y1, z0] + integral[x1, y0, z0] - integral[x0, y0, z0]
    )  # fmt: skip


def grow_boxes(filled: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Grows boxes from every cell as far as they stay filled, once for each order of the axes.

    Args:
        filled: Counts of filled cells in all boxes from the origin (`count_filled`).
        cells: Filled cells ``[N 3]``.

    Returns:
        Boxes ``[6 N, 2, 3]``.
    """
    orders = np.array(list(permutations(range(3))))
    seeds = np.tile(cells, (len(orders), 1))
    boxes = np.stack([seeds, seeds + 1], axis=1)
    every = np.arange(len(boxes))
    flat, strides = filled.ravel(), np.array(filled.strides) // filled.itemsize
    for axes in np.repeat(orders, len(cells), axis=0).T:
        along = strides[axes]
        # The counts up to a plane across the axis, between the box's other sides: four corners of `filled`.
        (low, high), (left, right) = (
            boxes[every, :, other].T * strides[other] for other in ((axes + 1) % 3, (axes + 2) % 3)
        )
        area = np.prod(boxes[:, 1] - boxes[:, 0], axis=1) // (boxes[every, 1, axes] - boxes[every, 0, axes])
        corners = high + right, low + left, low + right, high + left
        for end, step in ((0, -1), (1, 1)):
            start = boxes[every, end, axes]
            below = _count_below(flat, corners, start * along)
            # Layers by which the box certainly grows, and by which it certainly does not.
            sure = np.zeros(len(boxes), dtype=np.int64)
            never = (start if end == 0 else np.array(filled.shape)[axes] - 1 - start) + 1
            while (sure + 1 < never).any():
                middle = (sure + never) // 2
                counted = step * (_count_below(flat, corners, (start + step * middle) * along) - below)
                full = counted == middle * area
                sure, never = np.where(full, middle, sure), np.where(full, never, middle)
            boxes[every, end, axes] = start + step * sure
    return boxes


def _count_below(flat: np.ndarray, corners: tuple[np.ndarray, ...], plane: np.ndarray) -> np.ndarray:
    """Filled cells of some columns below planes across them, both as places in the flat counts."""
    far, near, *mixed = (flat[corner + plane] for corner in corners)
    return far + near - mixed[0] - mixed[1]
