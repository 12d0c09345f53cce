"""Normals at the corners of triangles: smooth across flat edges, sharp elsewhere."""

import numpy as np
from jaxtyping import Float
from scipy import sparse

from sim_export.geometry.rows import number_rows
from sim_export.geometry.triangles import area_normals

CREASE = 50.0
"""Angle (degrees) between two faces up to which the edge between them is smooth."""


def corner_normals(
    triangles: Float[np.ndarray, "F 3 3"], crease: float = CREASE
) -> Float[np.ndarray, "F 3 3"]:
    """Unit normals at triangle corners: neighbours within ``crease`` (degrees) are averaged.

    Corners at the same position are neighbours even if they share no vertex, weighted by the areas of their
    faces; faces without area keep the zero normal.
    """
    weighted = area_normals(triangles)
    lengths = np.linalg.norm(weighted, axis=1, keepdims=True)
    normals = weighted / np.where(lengths > 0, lengths, 1.0)
    flat = np.repeat(normals[:, None], 3, axis=1)
    if crease <= 0 or len(triangles) == 0:
        return flat
    extent = max(float(np.ptp(triangles.reshape(-1, 3), axis=0).max()), 1e-12)
    cells = np.round(triangles.reshape(-1, 3) / (extent * 1e-6)).astype(np.int64)
    _, places = number_rows(cells)
    # A rounded face direction stands for all coplanar faces, so that large fans stay cheap.
    first, kinds = number_rows(np.round(normals * 500).astype(np.int64))
    kinds = np.repeat(kinds, 3)
    corner_of_pair, pair_of_corner = number_rows(np.column_stack([places, kinds]))
    pairs = np.stack([places, kinds])[:, corner_of_pair]
    sums = np.zeros((pairs.shape[1], 3))
    np.add.at(sums, pair_of_corner, np.repeat(weighted, 3, axis=0))
    incidence = sparse.csr_matrix(
        (np.ones(pairs.shape[1]), (np.arange(pairs.shape[1]), pairs[0])),
        shape=(pairs.shape[1], int(places.max()) + 1),
    )
    near = (incidence @ incidence.T).tocoo()
    direction = normals[first][pairs[1]]
    close = (direction[near.row] * direction[near.col]).sum(axis=1) > np.cos(np.radians(crease))
    blend = sparse.csr_matrix((np.ones(close.sum()), (near.row[close], near.col[close])), shape=near.shape)
    smooth = (blend @ sums)[pair_of_corner].reshape(-1, 3, 3)
    size = np.linalg.norm(smooth, axis=2, keepdims=True)
    return np.where(size > 1e-9 * extent**2, smooth / np.where(size > 0, size, 1.0), flat)
