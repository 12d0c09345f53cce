"""Pairs of links between which engines need not look for contact.

Engines ignore contact between links that a joint connects. Three kinds of other pairs are listed for them:
what a screw connects, since a screw is two joints with a link between them; what touches at rest; and what
is near and never meets, whatever the positions of the joints. PhysX takes some hulls that are 10 mm apart for
deep inside each other, and between such links every contact is false.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from artigen.types import Joint
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import convex_hull
from sim_export.motion.kinematics import link_displacements
from sim_export.package import Link, SimPackage

TOUCH_DISTANCE = 1e-4
"""Hulls nearer than this (m) touch."""
TOUCH_DEPTH = 1e-3
"""A deeper overlap (m) is a fault, which is not hidden here."""
CLEAR = 1e-3
"""Links that come nearer than this (m) may meet: engines round hulls, and limits of joints give way."""
NEAR = 0.02
"""Distance (m) up to which PhysX makes contacts: SAPIEN's contact offset, 10 mm, for each of two hulls."""
SIDES = 64
"""Sides of the prism around all positions of what turns without limits."""
MOST_POSES = 128
"""Poses at which a pair is measured, at most; pairs that need more are not listed."""


def ignored_pairs(package: SimPackage) -> tuple[tuple[str, str], ...]:
    """Pairs of links without a joint between them, by name; those of screws first, then those that touch,
    then those that never meet, nearest first."""
    links, joints = package.links, package.joints
    sets = {link.name: HullSet(hulls=link.hulls) for link in links if link.hulls}
    parents = {joint.child: joint for joint in joints}
    screws = [(joint.child, parents[joint.parent].parent) for joint in joints if joint.is_travel]
    screws = [pair for pair in screws if sets.keys() >= set(pair)]
    joined = {frozenset(pair) for pair in [*screws, *((joint.parent, joint.child) for joint in joints)]}
    solids = {name: _swept_solid(hulls, parents.get(name)) for name, hulls in sets.items()}
    still, touching, apart = np.eye(4), [], []
    for first, second in combinations(sets, 2):
        if frozenset((first, second)) in joined:
            continue
        found = signed_distances(sets[first], sets[second], still, still, CLEAR).distance
        nearest = float(found.min(initial=np.inf))
        if -TOUCH_DEPTH <= nearest <= TOUCH_DISTANCE:
            touching.append((nearest, first, second))
        elif nearest > CLEAR:
            nearest = kept_distance(links, joints, (first, second), solids)
            if nearest is not None and nearest <= NEAR:
                apart.append((nearest, first, second))
    return (*screws, *(pair[1:] for pair in (*sorted(touching), *sorted(apart))))


def kept_distance(
    links: Sequence[Link], joints: Sequence[Joint], pair: tuple[str, str], sets: dict[str, HullSet]
) -> float | None:
    """A distance (m) that two links keep at all positions of the joints; None if they may meet.

    The ranges of the joints that move one against the other are halved until no point moves so far within a
    part of them as the two are apart in its middle.

    Args:
        sets: The hulls of all links that have any; of a link that turns without limits against its parent,
            hulls that hold all its positions.
    """
    own, other = sets[pair[0]], sets[pair[1]]
    moves = _relative_moves(joints, pair, sets)
    reach = [
        np.stack([np.zeros(len(s.hulls)), *(move.reach[k] for move in moves)])
        for k, s in enumerate((own, other))
    ]
    where = [next(k for k, link in enumerate(links) if link.name == name) for name in pair]
    parts = np.array([[[0.0, 0.0], *([move.lower, move.upper] for move in moves)]])
    least, tried = np.inf, 0
    while len(parts):
        tried += len(parts)
        if tried > MOST_POSES:
            return None
        middle, half = parts.mean(axis=2), np.ptp(parts, axis=2) / 2.0
        qpos = {move.driver: middle[:, 1 + k] for k, move in enumerate(moves)}
        T = np.broadcast_to(link_displacements(links, joints, qpos), (len(parts), len(links), 4, 4))
        first, second = T[:, where[0]], T[:, where[1]]
        slack = (half @ reach[0])[:, :, None] + (half @ reach[1])[:, None, :]
        found = signed_distances(own, other, first, second, NEAR)
        if float(found.distance.min(initial=np.inf)) <= CLEAR:
            return None
        distance = np.maximum(_box_gaps(own, other, first, second), NEAR)
        distance[found.pose, found.first, found.second] = found.distance
        sure = (distance - slack).min(axis=(1, 2))
        least = min(least, float(sure[sure > CLEAR].min(initial=np.inf)))
        parts = _halve(parts[sure <= CLEAR], reach)
    return least


def _turns_freely(joint: Joint | None) -> bool:
    return joint is not None and joint.type == "continuous" and joint.follows is None


def _swept_solid(hulls: HullSet, joint: Joint | None) -> HullSet:
    """Hulls that hold all positions of a link that turns without limits; those of other links as they are."""
    if joint is None or not _turns_freely(joint):
        return hulls
    across = np.cross(joint.axis, np.eye(3)[int(np.abs(joint.axis).argmin())])
    across /= np.linalg.norm(across)
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    ring = np.outer(np.cos(angles), across) + np.outer(np.sin(angles), np.cross(joint.axis, across))
    ring /= np.cos(np.pi / SIDES)
    solids = []
    for hull in hulls.hulls:
        arms = hull.vertices - joint.origin
        along = arms @ joint.axis
        radii = np.linalg.norm(arms - np.outer(along, joint.axis), axis=1)
        outline = np.concatenate([np.column_stack([along, side * radii]) for side in (1.0, -1.0)])
        kept = [row for row in ConvexHull(outline).vertices if row < len(along)]
        rings = joint.origin + along[kept, None, None] * joint.axis + radii[kept, None, None] * ring
        solids.append(convex_hull(rings.reshape(-1, 3)))
    return HullSet(hulls=tuple(solids))


def _halve(
    parts: Float[np.ndarray, "N D 2"], reach: Sequence[Float[np.ndarray, "D H"]]
) -> Float[np.ndarray, "M D 2"]:
    """Two parts for each, divided where points move furthest."""
    if not len(parts):
        return parts
    farthest = sum(own.max(axis=1) for own in reach)
    rows, widest = np.arange(len(parts)), (np.ptp(parts, axis=2) * farthest).argmax(axis=1)
    low, high = parts.copy(), parts.copy()
    low[rows, widest, 1] = high[rows, widest, 0] = parts[rows, widest].mean(axis=1)
    return np.concatenate([low, high])


def _box_gaps(
    first: HullSet, second: HullSet, T_first: Float[np.ndarray, "P 4 4"], T_second: Float[np.ndarray, "P 4 4"]
) -> Float[np.ndarray, "P A B"]:
    """Distances (m) between the boxes of all hulls of one link and all of another, 0 where they overlap."""
    own, other = first.bounds(T_first)[:, :, None], second.bounds(T_second)[:, None]
    gap = np.maximum(own[..., 0, :] - other[..., 1, :], other[..., 0, :] - own[..., 1, :])
    return np.linalg.norm(np.maximum(gap, 0.0), axis=-1)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Move:
    """Range of a joint that moves one link of a pair against the other, and for both links how far (m) points
    of each hull move per unit of its coordinate, at most."""

    driver: str
    lower: float
    upper: float
    reach: tuple[Float[np.ndarray, "A"], Float[np.ndarray, "B"]]


def _relative_moves(
    joints: Sequence[Joint], pair: tuple[str, str], sets: dict[str, HullSet]
) -> tuple[_Move, ...]:
    """Every coordinate that moves one link of a pair against the other."""
    by_child, by_name = {joint.child: joint for joint in joints}, {joint.name: joint for joint in joints}
    paths: list[list[Joint]] = []
    for link in pair:
        paths.append([])
        while link in by_child:
            paths[-1].append(by_child[link])
            link = by_child[link].parent
        if paths[-1] and _turns_freely(paths[-1][0]):  # its hulls hold all positions
            del paths[-1][0]
    shared = {joint.name for joint in paths[0]} & {joint.name for joint in paths[1]}
    reach: dict[str, list[Float[np.ndarray, "H"]]] = {}
    for side, (link, path) in enumerate(zip(pair, paths, strict=True)):
        hulls = sets[link]
        carried = np.zeros(len(hulls.hulls))  # how far joints between this one and the link move points
        for joint in path:
            if joint.name in shared or joint.type == "fixed":
                continue
            driver, ratio = (joint.follows, joint.ratio) if joint.follows else (joint.name, 1.0)
            arms = np.linalg.norm(np.cross(joint.axis, hulls.vertices - joint.origin), axis=1)
            radius = np.maximum.reduceat(arms, hulls.starts) + carried
            per_unit = abs(ratio) * (np.ones_like(radius) if joint.type == "prismatic" else radius)
            known = reach.setdefault(driver, [np.zeros(len(sets[name].hulls)) for name in pair])
            known[side] = known[side] + per_unit
            carried = carried + per_unit * (by_name[driver].upper - by_name[driver].lower)
    return tuple(
        _Move(driver=name, lower=by_name[name].lower, upper=by_name[name].upper, reach=(own[0], own[1]))
        for name, own in reach.items()
    )
