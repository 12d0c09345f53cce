"""Grid of distances to solid hulls, for evaluating thousands of arm poses at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt

from sim_export.geometry.hulls import hull_planes
from sim_export.package import Hull

FINEST = 0.008
"""Smallest edge of a cell, metres, if the grid stays small enough."""
MOST_CELLS = 800_000
AROUND = 0.12
"""Margin of the grid around the hulls, metres; everything beyond is free."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Field:
    """Distances (m) of cell centres to the nearest solid cell, accurate to about half a ``cell``; ``low`` is
    the centre of the first cell. Everything below the height ``ground`` is solid."""

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
    """The distance field of hulls, in the frame of their vertices.

    Args:
        hulls: Solid hulls.
        box: Relevant region; default: everything.
        ground: Height of the ground, z up in the frame of the hulls; default: none.
        finest: Smallest edge of a cell, metres.

    Raises:
        ValueError: If there are no hulls.
    """
    if not hulls:
        raise ValueError("no hulls, expected at least one")
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
    """Distance of every point to the nearest solid, metres; `AROUND` outside of the grid."""
    at = np.rint((points - field.low) / field.cell).astype(np.int64)
    inside = np.all((at >= 0) & (at < np.array(field.distance.shape)), axis=-1)
    at = np.where(inside[..., None], at, 0)
    near = np.where(inside, field.distance[at[..., 0], at[..., 1], at[..., 2]], AROUND)
    return np.minimum(near, np.maximum(points[..., 2] - field.ground, 0.0))


def _within(hull: Hull, axes: list[np.ndarray], slack: float) -> Bool[np.ndarray, "X Y Z"]:
    """Grid points inside a hull or at most ``slack`` beyond one of its planes."""
    inside = np.ones([len(axis) for axis in axes], dtype=bool)
    for nx, ny, nz, d in np.unique(np.round(hull_planes(hull), 7), axis=0):
        level = nx * axes[0][:, None, None] + ny * axes[1][None, :, None] + nz * axes[2][None, None, :]
        inside &= level <= d + slack
    return inside
