"""Texture atlases for part meshes: charts by facing axis, packed on shelves, and the surface point of each
texel.

Most faces of furniture are perpendicular to an axis. Every connected set of faces with the same dominant axis
therefore becomes one chart, flattened by dropping that coordinate. This is exact for panels, stretches round
surfaces by at most a factor of 1.7, and makes every chart an orthographic view along one axis.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from sim_export.geometry.rows import connect_rows
from sim_export.geometry.triangles import area_normals, face_edges
from sim_export.package import Mesh

PADDING = 1
"""Texels of border around every chart."""
_EDGE = 1e-4
"""Distance (texels) from a triangle within which a texel centre counts as covered."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Atlas:
    """Texel coordinates of every face corner, and the surface points of the covered texels.

    ``corners`` are (column, row) texel coordinates with texel centres at integers, rows from the top.
    ``texels`` are the (row, column) of the covered texels, ``points`` their positions on the mesh and
    ``faces`` the face of each.
    """

    shape: tuple[int, int]
    corners: Float[np.ndarray, "F 3 2"]
    texels: Int[np.ndarray, "T 2"]
    points: Float[np.ndarray, "T 3"]
    faces: Int[np.ndarray, "T"]


def make_atlas(mesh: Mesh, texel_size: float, max_size: int) -> Atlas:
    """Charts of a mesh in one image of at most ``max_size`` texels a side.

    ``texel_size`` is in the mesh's unit and grows as needed to fit. Equal meshes give equal atlases. Raises
    `ValueError` if not even one texel per chart fits.
    """
    triangles = mesh.vertices[mesh.faces]
    normals = area_normals(triangles)
    axis = np.abs(normals).argmax(axis=1)
    facing = 2 * axis + (np.take_along_axis(normals, axis[:, None], 1)[:, 0] > 0)
    chart = _charts(mesh.faces, facing)
    # Each face's two in-plane coordinates; the charts of one axis need no common orientation.
    flat_axes = np.array([[1, 2], [0, 2], [0, 1]])[axis]
    flat = np.take_along_axis(triangles, flat_axes[:, None, :], axis=2)  # F 3 2
    count = int(chart.max()) + 1
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    np.minimum.at(low, chart, flat.min(axis=1))
    np.maximum.at(high, chart, flat.max(axis=1))
    tall = (high - low)[:, 1] > (high - low)[:, 0]
    size = np.where(tall[:, None], (high - low)[:, ::-1], high - low)

    while True:
        cells = np.ceil(size / texel_size - 1e-6).astype(np.int64) + 1
        at, shape = _pack(cells + 2 * PADDING)
        if max(shape) <= max_size:
            break
        if (cells <= 2).all():
            raise ValueError(f"texture: {count} charts do not fit into {max_size} x {max_size} texels")
        texel_size *= max(1.05, np.sqrt(max(shape) / max_size))
    # The border of a chart passes through texel centres, so that thin charts are covered too.
    scale = (np.maximum(cells, 2) - 1) / np.maximum(size, 1e-12)
    local = flat - low[chart][:, None]
    local = np.where(tall[chart][:, None, None], local[:, :, ::-1], local)
    corners = local * scale[chart][:, None] + at[chart][:, None] + PADDING
    texels, points, faces = _cover(corners, triangles)
    return Atlas(shape=shape, corners=corners, texels=texels, points=points, faces=faces)


def _charts(faces: np.ndarray, facing: np.ndarray) -> np.ndarray:
    """Labels the connected sets of faces with equal facing."""
    edges = np.sort(face_edges(faces), axis=1)
    owner = np.tile(np.arange(len(faces)), 3)
    code = edges[:, 0] * (int(faces.max()) + 1) + edges[:, 1]
    order = np.argsort(code, kind="stable")
    same = code[order][1:] == code[order][:-1]
    pairs = np.stack([owner[order][1:][same], owner[order][:-1][same]])
    pairs = pairs[:, facing[pairs[0]] == facing[pairs[1]]]
    return connect_rows(pairs, len(faces))


def _pack(cells: np.ndarray) -> tuple[np.ndarray, tuple[int, int]]:
    """Upper left corners (column, row) of rectangles on shelves, and the image's (height, width)."""
    width = max(int(np.ceil(np.sqrt(cells.prod(axis=1).sum() * 1.1))), int(cells[:, 0].max()))
    at = np.zeros_like(cells)
    column, row, shelf = 0, 0, 0
    for index in np.lexsort((-cells[:, 0], -cells[:, 1])):
        wide, high = cells[index]
        if column + wide > width:
            column, row, shelf = 0, row + shelf, 0
        at[index] = column, row
        column, shelf = column + wide, max(shelf, high)
    return at, (int(row + shelf), width)


def _cover(corners: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Texels whose centres lie on a triangle, plus the one nearest to each corner."""
    face, column, row = _scan(corners)
    nearest = np.rint(corners).astype(np.int64).reshape(-1, 2)
    face = np.concatenate([face, np.repeat(np.arange(len(corners)), 3)])
    column, row = np.concatenate([column, nearest[:, 0]]), np.concatenate([row, nearest[:, 1]])
    width = int(column.max()) + 1
    _, first = np.unique(row * width + column, return_index=True)
    face, column, row = face[first], column[first], row[first]
    weights = _barycentric(corners[face], np.stack([column, row], axis=1))
    points = np.einsum("tc,tcd->td", weights, triangles[face])
    return np.stack([row, column], axis=1), points, face


def _scan(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Every (face, column, row) whose texel centre is inside the triangle, by scan lines."""
    top = np.ceil(corners[:, :, 1].min(axis=1) - _EDGE).astype(np.int64)
    bottom = np.floor(corners[:, :, 1].max(axis=1) + _EDGE).astype(np.int64)
    face, row = _runs(top, bottom)
    left, right = np.full(len(face), np.inf), np.full(len(face), -np.inf)
    for n in range(3):
        a, b = corners[face, n], corners[face, (n + 1) % 3]
        step = b[:, 1] - a[:, 1]
        level = np.abs(step) < _EDGE
        share = np.where(level, 0.0, (row - a[:, 1]) / np.where(level, 1.0, step))
        hit = np.where(level, np.abs(row - a[:, 1]) <= _EDGE, (share >= -_EDGE) & (share <= 1 + _EDGE))
        x = a[:, 0] + np.clip(share, 0.0, 1.0) * (b[:, 0] - a[:, 0])
        left = np.where(hit, np.minimum(left, np.where(level, np.minimum(x, b[:, 0]), x)), left)
        right = np.where(hit, np.maximum(right, np.where(level, np.maximum(x, b[:, 0]), x)), right)
    met = np.isfinite(left)
    face, row, left, right = face[met], row[met], left[met], right[met]
    span, column = _runs(np.ceil(left - _EDGE).astype(np.int64), np.floor(right + _EDGE).astype(np.int64))
    return face[span], column, row[span]


def _runs(first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lists (index, value) for all integers from ``first[index]`` to ``last[index]``."""
    length = np.maximum(last - first + 1, 0)
    index = np.repeat(np.arange(len(first)), length)
    start = np.cumsum(length) - length
    return index, first[index] + np.arange(len(index)) - start[index]


def _barycentric(corners: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Weights of the three corners at 2D positions, clipped into the triangle; degenerate ones get thirds."""
    edge_b, edge_c, to = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], at - corners[:, 0]
    area = edge_b[:, 0] * edge_c[:, 1] - edge_b[:, 1] * edge_c[:, 0]
    good = np.abs(area) > 1e-12
    divisor = np.where(good, area, 1.0)
    b = (to[:, 0] * edge_c[:, 1] - to[:, 1] * edge_c[:, 0]) / divisor
    c = (edge_b[:, 0] * to[:, 1] - edge_b[:, 1] * to[:, 0]) / divisor
    weights = np.clip(np.stack([1.0 - b - c, b, c], axis=1), 0.0, 1.0)
    weights[~good] = 1.0 / 3.0
    return weights / weights.sum(axis=1, keepdims=True)
