"""Whether the boxes of a gripper meet convex solids: by separating axes, in the gripper's frame.

Axes are those of the boxes and the normals of the solids, not the products of edges: two solids that only
such a product separates count as meeting, so that none that meet are missed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.transforms import inverse, transform_points
from sim_export.geometry.hulls import face_planes, move_hull
from sim_export.package import Hull


@dataclass(frozen=True, kw_only=True, eq=False)
class Solids:
    """Convex solids, prepared for `meet`."""

    hulls: tuple[Hull, ...]

    @cached_property
    def vertices(self) -> Float[np.ndarray, "V 3"]:
        """Vertices of all solids, one after the other."""
        return np.concatenate([np.zeros((0, 3)), *(hull.vertices for hull in self.hulls)])

    @cached_property
    def starts(self) -> Int[np.ndarray, "H"]:
        """Index of the first vertex of each."""
        return np.cumsum([0, *(len(hull.vertices) for hull in self.hulls)])[:-1]


def near_solids(
    hulls: Sequence[Hull], T: Float[np.ndarray, "*K 4 4"], center: Float[np.ndarray, "3"], reach: float
) -> Solids:
    """Hulls displaced by ``T``, one or several times, those of them that come within ``reach`` of a point."""
    found = []
    for pose in T.reshape(-1, 4, 4):
        for hull in hulls:
            points = transform_points(pose, hull.vertices)
            away = np.maximum(np.maximum(points.min(axis=0) - center, center - points.max(axis=0)), 0.0)
            if away @ away < reach**2:
                found.append(move_hull(hull, pose))
    return Solids(hulls=tuple(found))


def meet(
    T: Float[np.ndarray, "G 4 4"], boxes: Float[np.ndarray, "G B 2 3"], solids: Solids
) -> Bool[np.ndarray, "G"]:
    """Whether any of the boxes of each gripper, which has the pose ``T``, meets a solid."""
    hit = np.zeros(len(T), dtype=bool)
    if not solids.hulls or not len(T):
        return hit
    points = transform_points(inverse(T), solids.vertices)  # G V 3
    low = np.minimum.reduceat(points, solids.starts, axis=1)[:, None]  # G 1 H 3
    high = np.maximum.reduceat(points, solids.starts, axis=1)[:, None]
    near = np.ones((len(T), boxes.shape[1], len(solids.hulls)), dtype=bool)
    for axis in range(3):
        near &= (low[..., axis] < boxes[:, :, None, 1, axis]) & (high[..., axis] > boxes[:, :, None, 0, axis])
    middle, half = boxes.mean(axis=2), (boxes[:, :, 1] - boxes[:, :, 0]) / 2.0
    for solid in np.flatnonzero(near.any(axis=(0, 1))):
        rows, box = np.nonzero(near[:, :, solid] & ~hit[:, None])
        planes = face_planes(solids.hulls[solid])
        normals = planes[:, :3] @ T[rows, :3, :3]  # K F 3, in the grippers' frames
        offset = planes[:, 3] - T[rows, :3, 3] @ planes[:, :3].T
        least = np.einsum("kfi,ki->kf", normals, middle[rows, box])
        least -= np.einsum("kfi,ki->kf", np.abs(normals), half[rows, box])
        hit[rows[(least < offset).all(axis=1)]] = True
    return hit
