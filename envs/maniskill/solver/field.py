"""Distances of points to solid hulls from a grid, for thousands of arm poses at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt

from sim_export.package import Hull

FINEST = 0.008
"""Edge of a cell where there are few enough of them, metres."""
MOST_CELLS = 800_000
AROUND = 0.12
"""How far the grid reaches beyond the hulls; farther away everything is free."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Field:
    """Distances (m) of cell middles to the nearest cell that holds something solid, good to about half a
    ``cell``; ``low`` is the middle of the first one. Below the height ``ground`` everything is solid."""

    low: Float[np.ndarray, "3"]
    cell: float
    distance: Float[np.ndarray, "X Y Z"]
    ground: float = -np.inf


def build_field(
    hulls: Sequence[Hull],
    box: Float[np.ndarray, "2 3"] | None = None,
    finest: float = FINEST,
    *,
    ground: float = -np.inf,
) -> Field:
    """The field of hulls, in the frame of their vertices.

    Args:
        hulls: what is solid.
        box: the only part of space that matters; everything unless given.
        ground: height of the ground, z up in the frame of the hulls; none unless given.
        finest: edge of a cell where there are few enough of them, metres.

    Raises:
        ValueError: if there are no hulls.
    """
    if not hulls:
        raise ValueError("no hulls: there is nothing to keep away from")
    if box is None:
        corners = np.concatenate([hull.vertices for hull in hulls])
        box = np.stack([corners.min(axis=0) - AROUND, corners.max(axis=0) + AROUND])
    low, high = box
    cell = max(finest, float(np.prod(high - low) / MOST_CELLS) ** (1.0 / 3.0))
    shape = np.ceil((high - low) / cell).astype(int) + 1
    solid = np.zeros(shape, dtype=bool)
    for hull in hulls:
        first = np.floor((hull.vertices.min(axis=0) - low) / cell).astype(int).clip(0, None)
        last = np.minimum(np.ceil((hull.vertices.max(axis=0) - low) / cell).astype(int) + 1, shape)
        if (first >= last).any():
            continue
        axes = [low[k] + cell * np.arange(first[k], last[k]) for k in range(3)]
        where = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
        solid[where] |= _within(hull, axes, cell / 2.0)
    distance = distance_transform_edt(~solid, sampling=cell) if solid.any() else np.full(shape, AROUND)
    return Field(low=low, cell=cell, distance=np.asarray(distance, dtype=np.float32), ground=ground)


def distances(field: Field, points: Float[np.ndarray, "*N 3"]) -> Float[np.ndarray, "*N"]:
    """Distance of every point to what is solid, metres; `AROUND` for those outside of the grid."""
    at = np.rint((points - field.low) / field.cell).astype(np.int64)
    inside = np.all((at >= 0) & (at < np.array(field.distance.shape)), axis=-1)
    at = np.where(inside[..., None], at, 0)
    near = np.where(inside, field.distance[at[..., 0], at[..., 1], at[..., 2]], AROUND)
    return np.minimum(near, np.maximum(points[..., 2] - field.ground, 0.0))


def _within(hull: Hull, axes: list[np.ndarray], slack: float) -> Bool[np.ndarray, "X Y Z"]:
    """Which grid points lie in a hull or at most ``slack`` beyond one of its planes."""
    a, b, c = (hull.vertices[hull.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1)
    keep = length > 1e-12
    normals = normals[keep] / length[keep, None]
    planes = np.c_[normals, (normals * a[keep]).sum(axis=1)]
    inside = np.ones([len(axis) for axis in axes], dtype=bool)
    for nx, ny, nz, d in np.unique(np.round(planes, 7), axis=0):
        level = nx * axes[0][:, None, None] + ny * axes[1][None, :, None] + nz * axes[2][None, None, :]
        inside &= level <= d + slack
    return inside
