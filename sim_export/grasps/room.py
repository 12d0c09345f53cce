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
from sim_export.geometry.hulls import face_planes
from sim_export.package import Hull


@dataclass(frozen=True, kw_only=True, eq=False)
class Solids:
    """Convex solids, prepared for `meet`: hulls, and where each of them is moved."""

    hulls: tuple[Hull, ...]
    T: Float[np.ndarray, "H 4 4"]

    @cached_property
    def vertices(self) -> Float[np.ndarray, "V 3"]:
        """Vertices of all solids, one after the other."""
        moved = [transform_points(T, hull.vertices) for T, hull in zip(self.T, self.hulls, strict=True)]
        return np.concatenate([np.zeros((0, 3)), *moved])

    @cached_property
    def starts(self) -> Int[np.ndarray, "H"]:
        """Index of the first vertex of each."""
        return np.cumsum([0, *(len(hull.vertices) for hull in self.hulls)])[:-1]

    def planes(self, index: int) -> Float[np.ndarray, "F 4"]:
        """Outward normals and offsets of the faces of one solid."""
        planes, T = face_planes(self.hulls[index]), self.T[index]
        normals = planes[:, :3] @ T[:3, :3].T
        return np.c_[normals, planes[:, 3] + normals @ T[:3, 3]]


def near_solids(
    hulls: Sequence[Hull], T: Float[np.ndarray, "H 4 4"], center: Float[np.ndarray, "3"], reach: float
) -> Solids:
    """Hulls, each moved by its ``T``, of which a ball around them comes within ``reach`` of a point."""
    if not hulls:
        return Solids(hulls=(), T=np.zeros((0, 4, 4)))
    bounds = np.array([[hull.vertices.min(axis=0), hull.vertices.max(axis=0)] for hull in hulls])
    middle = np.einsum("hij,hj->hi", T[:, :3, :3], bounds.mean(axis=1)) + T[:, :3, 3]
    radius = np.linalg.norm(bounds[:, 1] - bounds[:, 0], axis=1) / 2.0
    near = np.flatnonzero(np.linalg.norm(middle - center, axis=1) < reach + radius)
    return Solids(hulls=tuple(hulls[index] for index in near.tolist()), T=T[near])


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
    for solid in np.flatnonzero(near.any(axis=(0, 1))).tolist():
        rows, box = np.nonzero(near[:, :, solid] & ~hit[:, None])
        planes = solids.planes(solid)
        normals = planes[:, :3] @ T[rows, :3, :3]  # K F 3, in the grippers' frames
        offset = planes[:, 3] - T[rows, :3, 3] @ planes[:, :3].T
        least = np.einsum("kfi,ki->kf", normals, middle[rows, box])
        least -= np.einsum("kfi,ki->kf", np.abs(normals), half[rows, box])
        hit[rows[(least < offset).all(axis=1)]] = True
    return hit
