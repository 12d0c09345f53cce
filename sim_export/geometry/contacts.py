"""Exact signed distances between convex hulls.

Depths are those of GJK/EPA (`coal`): the length of the shortest translation that separates two
hulls. Simulators filter parent-child contacts and report speculative ones; these do neither.
Poses are rigid displacements ``T`` of a whole `HullSet`; every pose argument is ``4 4`` or ``P 4 4``
and the two broadcast, so that a sweep is one call.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import isfinite

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.transforms import inverse, transform_points
from artigen.types import frozen_array
from sim_export.errors import DegeneratePart
from sim_export.geometry.rows import all_three
from sim_export.package import Hull

# coal is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false


FEW_POSES = 64
"""Poses of a pair of hulls up to which all are measured."""


@dataclass(frozen=True, kw_only=True, eq=False)
class HullSet:
    """The hulls of one link, prepared once: vertices in one array, bounds, and coal shapes on demand."""

    hulls: tuple[Hull, ...]

    @cached_property
    def vertices(self) -> Float[np.ndarray, "V 3"]:
        """Vertices of all hulls, one hull after the other."""
        chunks = [hull.vertices for hull in self.hulls]
        return frozen_array(np.concatenate(chunks) if chunks else np.zeros((0, 3)), float, (None, 3), "hulls")

    @cached_property
    def starts(self) -> Int[np.ndarray, "H"]:
        """Index of each hull's first vertex in ``vertices``."""
        counts = [len(hull.vertices) for hull in self.hulls]
        return np.cumsum([0, *counts[:-1]]) if counts else np.zeros(0, dtype=np.int64)

    @cached_property
    def shapes(self) -> tuple[object, ...]:
        """One coal shape per hull."""
        return tuple(_coal_shape(hull) for hull in self.hulls)

    @cached_property
    def rest_bounds(self) -> Float[np.ndarray, "H 2 3"]:
        """Lowest and highest corner of every hull where it is."""
        return self.bounds(np.eye(4))

    @cached_property
    def corners(self) -> Float[np.ndarray, "8 3"]:
        """Corners of the box around all hulls."""
        low, high = self.rest_bounds[:, 0].min(axis=0), self.rest_bounds[:, 1].max(axis=0)
        return np.array(list(product(*np.stack([low, high], axis=1))))

    def bounds(self, T: Float[np.ndarray, "*P 4 4"]) -> Float[np.ndarray, "*P H 2 3"]:
        """Lowest and highest corner of every hull at the poses ``T``, exact in the frame ``T`` maps to."""
        points = transform_points(T, self.vertices)
        low = np.minimum.reduceat(points, self.starts, axis=-2)
        high = np.maximum.reduceat(points, self.starts, axis=-2)
        return np.stack([low, high], axis=-2)


@dataclass(frozen=True, kw_only=True, eq=False)
class Distances:
    """Hull pairs nearer than the distance asked for, in order of pose, first hull, second hull.

    ``distance`` is negative where the two penetrate. ``normal`` is a unit vector from the first
    hull towards the second: moving the second by ``-distance * normal`` makes the two touch.
    ``points`` are the two witness points, on the first and on the second hull, and like the
    normals are given in the frame the poses map to.
    """

    pose: Int[np.ndarray, "K"]
    first: Int[np.ndarray, "K"]
    second: Int[np.ndarray, "K"]
    distance: Float[np.ndarray, "K"]
    normal: Float[np.ndarray, "K 3"]
    points: Float[np.ndarray, "K 2 3"]


def signed_distances(
    first: HullSet,
    second: HullSet,
    T_first: Float[np.ndarray, "*P 4 4"],
    T_second: Float[np.ndarray, "*Q 4 4"],
    max_distance: float = 0.0,
) -> Distances:
    """Exact signed distance of every pair of hulls closer than ``max_distance`` (m), pose by pose.

    Args:
        T_first: Displacements of ``first``, one or P of them.
        T_second: Displacements of ``second``, one or P of them.
        max_distance: Pairs further apart than this are left out; 0 keeps overlaps and touches.

    Raises:
        DegeneratePart: if a hull is so flat or small that its distance is no number.
    """
    T_first, T_relative = _pose_pairs(T_first, T_second)
    if not first.hulls or not second.hulls:
        return _as_distances([], T_first)
    candidates = _candidates(first, second, T_relative, max_distance)
    measured = _narrow_phase(first, second, T_relative, candidates)
    return _as_distances([row for row in measured if row[3] <= max_distance], T_first)


def penetration_depths(
    first: HullSet,
    second: HullSet,
    T_first: Float[np.ndarray, "*P 4 4"],
    T_second: Float[np.ndarray, "*Q 4 4"],
) -> Float[np.ndarray, "P"]:
    """Deepest overlap at each pose, 0 where nothing overlaps; one entry also for a single pose."""
    poses = len(_pose_pairs(T_first, T_second)[0])
    found = signed_distances(first, second, T_first, T_second)
    depths = np.zeros(poses)
    np.maximum.at(depths, found.pose, -found.distance)
    return depths


def _coal_shape(hull: Hull) -> object:
    import coal

    points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in hull.vertices:
        points.append(vertex)
    for a, b, c in hull.faces.tolist():
        triangles.append(coal.Triangle(a, b, c))
    return coal.Convex(points, triangles)


def _pose_pairs(T_first: np.ndarray, T_second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Poses of the first set, and of the second relative to the first, both ``P 4 4``."""
    T_first, T_second = np.broadcast_arrays(
        np.asarray(T_first, np.float64).reshape(-1, 4, 4), np.asarray(T_second, np.float64).reshape(-1, 4, 4)
    )
    return T_first, inverse(T_first) @ T_second


def _candidates(first: HullSet, second: HullSet, T_relative: np.ndarray, margin: float) -> np.ndarray:
    """Rows (pose, first hull, second hull) whose boxes come within ``margin``, in either set's own frame.

    All poses of two hulls where there are few of them, which take less time to measure than boxes do.
    """
    if len(first.hulls) == len(second.hulls) == 1 and len(T_relative) <= FEW_POSES:
        return np.stack([np.arange(len(T_relative)), *np.zeros((2, len(T_relative)), dtype=np.int64)], axis=1)
    poses = np.flatnonzero(_may_meet(first, second, T_relative, margin))
    near = _boxes_meet(first.rest_bounds, second.bounds(T_relative[poses]), margin)
    some = near.any(axis=(1, 2))
    poses, near = poses[some], near[some]
    # Boxes in the second's frame are as tight for it as the first's are for the first: a slanted
    # door leaves only the hulls that it really passes.
    back = _boxes_meet(second.rest_bounds, first.bounds(inverse(T_relative[poses])), margin)
    pose, i, j = np.nonzero(near & np.swapaxes(back, -1, -2))
    return np.stack([poses[pose], i, j], axis=1)


def _may_meet(
    first: HullSet, second: HullSet, T_relative: np.ndarray, margin: float
) -> Bool[np.ndarray, "P"]:
    """Poses at which the box around all of ``second`` comes within ``margin`` of that around ``first``.

    False only where no hulls do: the margin is widened by what rounding may cost.
    """
    still, moved = first.corners, transform_points(T_relative, second.corners)
    reach = margin + 1e-9 * (1.0 + float(np.abs(moved).max()) + float(np.abs(still).max()))
    above = moved.min(axis=1) <= still.max(axis=0) + reach
    below = moved.max(axis=1) >= still.min(axis=0) - reach
    return all_three(above & below)


def _boxes_meet(still: np.ndarray, moved: np.ndarray, margin: float) -> np.ndarray:
    """Which boxes of ``still [A 2 3]`` and ``moved [P B 2 3]`` come within ``margin``: ``P A B``."""
    near = np.ones((len(moved), len(still), moved.shape[1]), dtype=bool)
    for axis in range(3):  # several times as fast as a reduction over three entries
        near &= moved[:, None, :, 0, axis] <= still[:, None, 1, axis] + margin
        near &= moved[:, None, :, 1, axis] >= still[:, None, 0, axis] - margin
    return near


def _narrow_phase(first: HullSet, second: HullSet, T_relative: np.ndarray, candidates: np.ndarray):
    """Yields (pose, i, j, distance, normal, two witness points) in the frame of the first set."""
    import coal

    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    here = coal.Transform3s()
    there, placed = here, -1
    for pose, i, j in candidates.tolist():
        if pose != placed:
            there, placed = coal.Transform3s(T_relative[pose, :3, :3], T_relative[pose, :3, 3]), pose
        result = coal.DistanceResult()
        distance = coal.distance(first.shapes[i], here, second.shapes[j], there, request, result)
        normal = result.normal
        if not (isfinite(distance) and isfinite(normal @ normal)):
            raise DegeneratePart(
                f"distance between hulls {i} and {j} is {distance}: sizes "
                f"{np.ptp(first.hulls[i].vertices, axis=0).tolist()} and "
                f"{np.ptp(second.hulls[j].vertices, axis=0).tolist()} m; remove hulls thinner than 1 mm"
            )
        yield pose, i, j, distance, normal, result.getNearestPoint1(), result.getNearestPoint2()


def _as_distances(rows: list[tuple], T_first: np.ndarray) -> Distances:
    """Rows of the narrow phase as arrays, turned into the frame the poses map to."""
    pose = np.array([row[0] for row in rows], dtype=np.int64)
    rotation = T_first[pose, :3, :3]
    normal = np.array([row[4] for row in rows]).reshape(-1, 3)
    points = np.array([row[5:7] for row in rows]).reshape(-1, 2, 3)
    return Distances(
        pose=pose,
        first=np.array([row[1] for row in rows], dtype=np.int64),
        second=np.array([row[2] for row in rows], dtype=np.int64),
        distance=np.array([row[3] for row in rows], dtype=np.float64),
        normal=(rotation @ normal[..., None])[..., 0],
        points=transform_points(T_first[pose], points),
    )
