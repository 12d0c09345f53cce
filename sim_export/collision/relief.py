"""Separates two overlapping hulls at all poses in which they meet.

Three ways, of which the one wins that takes least: half-space cuts pose by pose (a door's edge gets a
chamfer), one half-space cut for all poses at once (a knob is cut off where it dips into a door), and a notch
in the shape of the other hull, which leaves several smaller hulls.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from sim_export.collision.hull_limits import MAX_ASPECT, box_along, hull_aspect
from sim_export.geometry.contacts import Distances, HullSet, signed_distances
from sim_export.geometry.hulls import (
    clip_hull,
    convex_hull,
    face_planes,
    hull_volume,
    hull_width,
    subtract_hull,
)
from sim_export.geometry.primitives import find_primitive
from sim_export.package import Hull

NEARLY = 1e-5
"""A face normal stands for a contact's own normal if it needs at most this much (m) more to separate."""

MARGIN = 0.0025
"""Gap (m) that a cut leaves, so that poses between the sampled ones are free too, and hulls that an
engine rounds (PhysX takes faces for one that differ by 0.7 mm per metre) do not touch."""
MARGIN_SHARE = 0.006
"""The same over the object's longest side, where that is less, as what engines round grows with hulls."""
MAX_DEPTH = 0.032
"""Deepest cut, over the object's longest side: about two voxels. Deeper ones may only take slivers."""
MAX_SLIVER_DEPTH = 0.1
"""Deepest cut, over the object's longest side, that takes no more than a sliver: the end of a board, or
a shaft. What overlaps more is an error of the object, not of its hulls."""
MAX_REMOVED = 0.65
"""Greatest share of a hull's volume that all its cuts together may remove."""
SLIVER = 0.02
"""This share of its link's volume may be cut off a hull in any case; a hull below it may be dropped
where cuts do not help."""
SLIVER_LENGTH = 0.12
"""Longest hull that goes as a sliver where there are sheets, over the object's longest side."""
END = 0.12
"""Share of a slender hull that deeper cuts may take: the end of a post above a wheel."""
SLENDER = 4.0
"""Least length of such a hull over its width."""
MIN_WIDTH = 0.001
"""Least thickness (m) that a cut may leave."""
NOTCH_ABOVE = 0.1
"""Share of a hull above which half-space cuts are compared with a notch."""
MAX_CUTS = 12
"""Most cuts per pair of hulls; swings need several."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OverlappingPair:
    """Two hulls in their links' rest frames that overlap at some poses, and what may be done to each.

    ``volumes`` are those before any cut, of which all cuts may take ``allowances`` (m^3). Cuts that go deeper
    than `MAX_DEPTH`, up to `MAX_SLIVER_DEPTH`, may take ``least`` (m^3). ``slivers`` tells which may be
    dropped, ``room`` how many hulls each link may still gain. ``size`` is the object's longest side (m), and
    ``axis`` the moving joint's direction in the frame of the first hull's link: one cut along it may free all
    poses. ``margin`` (m) is the gap that a cut leaves.
    """

    hulls: tuple[Hull, Hull]
    poses: tuple[Float[np.ndarray, "P 4 4"], Float[np.ndarray, "P 4 4"]]
    volumes: tuple[float, float]
    allowances: tuple[float, float]
    least: tuple[float, float]
    slivers: tuple[bool, bool]
    room: tuple[int, int]
    size: float
    axis: Float[np.ndarray, "3"]
    margin: float = MARGIN

    @property
    def max_depth(self) -> float:
        """Deepest cut (m) that may take more than a sliver."""
        return MAX_DEPTH * self.size

    def allows(self, side: int, left: float, depth: float) -> bool:
        """Whether cuts ``depth`` deep may leave a volume of ``left`` (m^3) of a hull."""
        if depth > self.max_depth and hull_volume(self.hulls[side]) - left > self.least[side]:
            return False
        return depth <= MAX_SLIVER_DEPTH * self.size and self.volumes[side] - left <= self.allowances[side]


@dataclass(frozen=True, kw_only=True, eq=False)
class Relief:
    """What is left of the two hulls (several pieces after a notch, none if dropped), cuts and deepest cut
    (m) of each, and why they still overlap (or ""). After a notch there may be more to do."""

    hulls: tuple[tuple[Hull, ...], tuple[Hull, ...]]
    cuts: tuple[int, int]
    depths: tuple[float, float]
    reason: str = ""


def relieve_pair(pair: OverlappingPair, gap: float, *, sheets: bool = False, shares: bool = False) -> Relief:
    """Cuts two hulls so that they stay ``gap`` (m) apart at all of the poses.

    A sliver is dropped where cuts would take more of the other hull. Where hulls may be ``sheets``, which
    have much surface and hardly any volume, one more hull costs a tenth of the larger of the two volumes,
    and notches leave boxes of boxes. With ``shares`` the plan wins that takes the smallest share of a hull
    rather than the least volume: thin leaves keep their thickness, and bodies lose more.
    """
    found = _measure(pair.hulls, pair.poses, gap)
    plans = [_cut_by_pose(pair, found, gap), *_cut_for_all(pair, found, gap)]
    good = [plan for plan in plans if not plan.reason]
    if not good or min(_lost_share(plan, pair) for plan in good) > NOTCH_ABOVE:
        good += _notch(pair, found, gap, sheets=sheets)
        good += [_one_sided(pair, side, (), 0.0) for side in range(2) if pair.slivers[side]]
    if good:
        return min(good, key=lambda plan: _cost(plan, pair, sheets=sheets, shares=shares))
    return plans[0]


def _cost(plan: Relief, pair: OverlappingPair, *, sheets: bool, shares: bool) -> float:
    """Volume lost (m^3), or share of each hull; every hull more, oblong ones counted as the several they will
    be cut to, is as bad as the loss of a tenth of its side, or of the larger side where there are sheets."""
    cost, larger = 0.0, max(map(hull_volume, pair.hulls))
    for hull, left in zip(pair.hulls, plan.hulls, strict=True):
        if left == (hull,):
            continue
        volume = hull_volume(hull)
        more = max(sum(np.ceil(hull_aspect(piece) / MAX_ASPECT) for piece in left) - 1.0, 0.0)
        lost = volume - sum(map(hull_volume, left))
        if shares:
            cost += lost / volume + 0.1 * more
        else:
            cost += lost + 0.1 * more * (larger if sheets else volume)
    return cost


def _measure(
    hulls: tuple[Hull, Hull], poses: tuple[Float[np.ndarray, "P 4 4"], Float[np.ndarray, "P 4 4"]], gap: float
) -> Distances:
    """Distances of two hulls at the poses at which they are nearer than ``gap`` (m)."""
    return signed_distances(HullSet(hulls=hulls[:1]), HullSet(hulls=hulls[1:]), *poses, gap)


def _lost_share(plan: Relief, pair: OverlappingPair) -> float:
    """Greatest share that a hull has lost of what it was before any cut."""
    return max(
        1.0 - sum(map(hull_volume, left)) / volume
        for left, volume in zip(plan.hulls, pair.volumes, strict=True)
    )


def _cut_by_pose(pair: OverlappingPair, found: Distances, gap: float) -> Relief:
    """Again and again, the deepest contact's separating plane cuts the hull that loses less.

    Poses that are free stay free, since cuts only take away.
    """
    current, poses = list(pair.hulls), pair.poses
    cuts, depths = [0, 0], [0.0, 0.0]
    reason = f"{MAX_CUTS} cuts were not enough"
    for _ in range(MAX_CUTS):
        if not len(found.distance) or found.distance.min() >= gap:
            reason = ""
            break
        at = int(found.distance.argmin())
        depth, pose = -float(found.distance[at]), int(found.pose[at])
        there = poses[0][pose], poses[1][pose]
        normal = _face_normal((current[0], current[1]), there, found.normal[at], depth)
        options = []
        for side, outward in enumerate((normal, -normal)):
            own, other = there[side], there[1 - side]
            points = transform_points(inverse(own) @ other, current[1 - side].vertices)
            cut = _cut(current[side], own[:3, :3].T @ outward, points, pair.margin)
            if cut is not None and pair.allows(side, hull_volume(cut), depth):
                options.append((hull_volume(current[side]) - hull_volume(cut), side, cut))
        if not options:
            reason = f"a cut would take more than {MAX_REMOVED:.0%} of a hull"
            if depth > pair.max_depth:
                reason = f"a cut of {1000 * depth:.1f} mm is deeper than {1000 * pair.max_depth:.0f} mm"
            break
        _, side, current[side] = min(options, key=lambda option: option[:2])
        cuts[side] += 1
        depths[side] = max(depths[side], depth)
        near = np.unique(found.pose[found.distance < gap])
        poses = poses[0][near], poses[1][near]
        found = _measure((current[0], current[1]), poses, gap)
    return Relief(
        hulls=((current[0],), (current[1],)),
        cuts=(cuts[0], cuts[1]),
        depths=(depths[0], depths[1]),
        reason=reason,
    )


def _face_normal(
    hulls: tuple[Hull, Hull],
    poses: tuple[Float[np.ndarray, "4 4"], Float[np.ndarray, "4 4"]],
    normal: Float[np.ndarray, "3"],
    depth: float,
) -> Float[np.ndarray, "3"]:
    """The face normal, of either hull, along which the two separate as easily as along ``normal``.

    Where hulls only just touch, the contact's own normal is hardly defined, and a cut that leans a
    little takes a wedge off a whole panel. ``normal`` and the result point from the first to the second.
    """
    first, second = (transform_points(T, hull.vertices) for T, hull in zip(poses, hulls, strict=True))
    normals = np.concatenate(
        [
            sign * face_planes(hull)[:, :3] @ T[:3, :3].T
            for sign, T, hull in zip((1.0, -1.0), poses, hulls, strict=True)
        ]
    )
    needed = (first @ normals.T).max(axis=0) - (second @ normals.T).min(axis=0)
    best = int(needed.argmin())
    return normals[best] if needed[best] <= depth + NEARLY else normal


def _cut_for_all(pair: OverlappingPair, found: Distances, gap: float) -> list[Relief]:
    """Single cuts that free all poses: along the joint's axis, along the deepest contacts, or across the
    ends of a post, as one above a wheel needs it."""
    deepest = np.argsort(found.distance, kind="stable")[:3]
    if not len(deepest) or found.distance[deepest[0]] >= gap:
        return []
    plans = []
    for side in range(2):
        own, other = pair.poses[side], pair.poses[1 - side]
        points = transform_points(inverse(own) @ other, pair.hulls[1 - side].vertices).reshape(-1, 3)
        turn = np.swapaxes(own[:, :3, :3], -1, -2)
        axis = (turn @ pair.poses[0][:, :3, :3] @ pair.axis)[found.pose[deepest[0]]]
        contact = (1.0 - 2.0 * side) * np.einsum(
            "kij,kj->ki", turn[found.pose[deepest]], found.normal[deepest]
        )
        normals = np.concatenate([[axis, -axis], contact, find_ends(pair.hulls[side])])
        for normal in normals:
            cut = _cut(pair.hulls[side], normal, points, pair.margin)
            if cut is None:
                continue
            depth = float((pair.hulls[side].vertices @ normal).max() - (cut.vertices @ normal).max())
            if pair.allows(side, hull_volume(cut), depth):
                plans.append(_one_sided(pair, side, (cut,), depth))
    return plans


def find_ends(hull: Hull) -> Float[np.ndarray, "K 3"]:
    """The two directions (K = 2) in which a slender hull ends; none (K = 0) for others."""
    extents = np.ptp(hull.vertices, axis=0)
    _, width, length = np.sort(extents)
    if length < SLENDER * width:
        return np.zeros((0, 3))
    along = np.eye(3)[int(extents.argmax())]
    return np.stack([along, -along])


def _notch(pair: OverlappingPair, found: Distances, gap: float, *, sheets: bool) -> list[Relief]:
    """Takes the other hull's shape out of one hull: all its way if it slides, else at the deepest pose.

    However deep the two overlap, a slot for a board may take a sliver: it is as deep as the board is thick.
    """
    at = int(found.distance.argmin()) if len(found.distance) else -1
    if at < 0 or found.distance[at] >= gap:
        return []
    pose, depth, plans = int(found.pose[at]), -float(found.distance[at]), []
    for side in range(2):
        T_own_other = inverse(pair.poses[side]) @ pair.poses[1 - side]
        slides = np.allclose(T_own_other[:, :3, :3], T_own_other[:1, :3, :3], atol=1e-9)
        chosen = T_own_other[np.unique(found.pose)] if slides else T_own_other[[pose]]
        other = convex_hull(transform_points(chosen, pair.hulls[1 - side].vertices).reshape(-1, 3))
        own = find_primitive(pair.hulls[side])
        if sheets and own is not None and own.kind == "box":  # what is left of a box is boxes
            other = box_along(other.vertices, own.T_object_shape[:3, :3].T)
        planes = face_planes(other) + np.array([0.0, 0.0, 0.0, pair.margin])
        pieces = subtract_hull(pair.hulls[side], planes, MIN_WIDTH)
        left = sum(map(hull_volume, pieces))
        if not pieces or len(pieces) - 1 > pair.room[side]:
            continue
        allowed = pair.allows(side, left, depth)
        if not allowed:
            thin = max(pair.max_depth, min(depth, _shared_width(pair.hulls[side], planes)))
            allowed = depth > thin and pair.allows(side, left, thin + NEARLY)
        if allowed:
            plans.append(_one_sided(pair, side, pieces, depth))
    return plans


def _shared_width(hull: Hull, planes: Float[np.ndarray, "F 4"]) -> float:
    """Thickness (m) of what a hull has in common with a convex region."""
    shared: Hull | None = hull
    for plane in planes:
        shared = None if shared is None else clip_hull(shared, plane[:3], plane[3])
    return 0.0 if shared is None else hull_width(shared)[0]


def _one_sided(pair: OverlappingPair, side: int, left: tuple[Hull, ...], depth: float) -> Relief:
    """A plan that changes one hull only."""
    if side == 0:
        return Relief(hulls=(left, (pair.hulls[1],)), cuts=(1, 0), depths=(depth, 0.0))
    return Relief(hulls=((pair.hulls[0],), left), cuts=(0, 1), depths=(0.0, depth))


def _cut(
    hull: Hull, normal: Float[np.ndarray, "3"], points: Float[np.ndarray, "N 3"], margin: float
) -> Hull | None:
    """A hull cut back to a ``margin`` (m) before ``points`` begin along ``normal``; ``None`` if too little is
    left."""
    cut = clip_hull(hull, normal, float((points @ normal).min()) - margin)
    return None if cut is None or hull_width(cut)[0] < MIN_WIDTH else cut
