"""Cuts collision hulls back until joints sweep their range without penetration.

Parent and child are included, because simulators never report contact between them and a package
should not depend on that. Where hulls overlap, the contact's separating plane cuts the one that
loses less volume; what cuts cannot free is shortened or reported, never hidden. Every cut only
removes collision volume, so that no cut can cause new contact.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.types import Joint
from sim_export.collision.cut_hulls import CutHulls, LinkRelief
from sim_export.collision.relief import (
    MARGIN,
    MARGIN_SHARE,
    OverlappingPair,
    Relief,
    relieve_pair,
)
from sim_export.geometry.contacts import HullSet, penetration_depths, signed_distances
from sim_export.geometry.hulls import replace_hulls
from sim_export.geometry.solids import as_solid
from sim_export.motion.kinematics import (
    driven_joints,
    link_displacements,
    moved_links,
    required_openings,
    sample_sweep,
)
from sim_export.package import Link, Requirement

_FRONTS = {"door", "drawer"}
GAP = 1e-3
"""Hulls nearer than this (m) are cut. Engines push apart what touches at rest, however little, and
round hulls by some tenths of a millimetre."""
PASSING = 3e-3
"""The same between a leaf that turns and what else moves: engines foresee contacts where the corner of
a leaf swings close past its neighbour, and keep some."""
PASSING_SHARE = 0.008
"""The same over the object's longest side, where that is less."""
THREAD = 1e-4
"""The same between what a screw connects, which are one in the other and whose contacts engines ignore
(`sim_export.motion.ignored_pairs`); cuts leave twice this."""
ENOUGH = 1.2
"""Gap that cuts leave at least, over the one required: the next pass finds nothing to cut there."""
TOLERANCE = 2e-5
"""Depth (m) from which an overlap that cannot be cut counts as one."""
CARRIED = (0.25, 0.5, 0.75, 1.0)
"""Shares of their ranges to which joints are open that another one carries along its sweep; a bar reaches
farthest half-way."""
ROUNDS = 12
"""Most passes over all joints; cuts for one joint seldom leave anything to do for another."""
MIN_RANGE = 0.5
"""Share of a joint's range that must be free for it to be shortened rather than reported."""


@dataclass(frozen=True, kw_only=True)
class LimitChange:
    """A joint's upper limit before and after (rad or m), and the two links that met beyond it."""

    joint: str
    before: float
    after: float
    links: tuple[str, str]


@dataclass(frozen=True, kw_only=True)
class Residual:
    """A penetration (m) that is left, at coordinate ``q`` of ``joint``, and why it was not cut."""

    joint: str
    links: tuple[str, str]
    depth: float
    q: float
    reason: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Clearance:
    """Links with relieved hulls, joints with final limits, and everything that was done or is left."""

    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    reliefs: tuple[LinkRelief, ...] = ()
    limits: tuple[LimitChange, ...] = ()
    residuals: tuple[Residual, ...] = ()

    @property
    def records(self) -> tuple[str, ...]:
        """One sentence for everything that was done or is left."""
        cuts = [
            f"{item.link}: {item.cuts} cuts and {item.dropped} hulls dropped for clearance, "
            f"{item.removed_share:.1%} of its collision volume, deepest {1000 * item.largest_depth:.1f} mm"
            for item in self.reliefs
        ]
        limits = [
            f"{item.joint}: upper limit {item.before:.4g} lowered to {item.after:.4g}, "
            f"where {item.links[0]} meets {item.links[1]}"
            for item in self.limits
        ]
        left = [
            f"{item.joint}: {item.links[0]} penetrates {item.links[1]} by {1000 * item.depth:.1f} mm "
            f"at {item.q:.4g} ({item.reason})"
            for item in self.residuals
        ]
        return (*cuts, *limits, *left)


def clear_joints(
    links: Sequence[Link],
    joints: Sequence[Joint],
    requirements: Sequence[Requirement] = (),
    *,
    sheets: bool = False,
    shares: bool = False,
) -> Clearance:
    """Cuts hulls back until every joint sweeps its range freely, others closed or open as required.

    Args:
        links: Links with hulls, object frame at rest.
        requirements: Joints that must be open while another moves (`find_requirements`).
        sheets: Whether hulls may be sheets, as those of a source's own surface (`relieve_pair`).
        shares: Whether the hull is cut that loses the smaller share, rather than the smaller volume.

    Returns:
        New links and joints; links without changes are the same objects. Penetrations that the
        limits do not allow to cut are in ``residuals``.
    """
    work = CutHulls(links, joints, sheets=sheets, shares=shares)
    stuck: dict[tuple[int, int, int, int], str] = {}
    waiting = driven_joints(joints)
    for _ in range(ROUNDS):
        # Cuts only take away, so that a joint that has been found free stays free.
        waiting = tuple(joint for joint in waiting if _clear_joint(work, joint, joints, requirements, stuck))
    final, limits, residuals = _settle_limits(work, joints, requirements, stuck)
    for index in range(len(links)):
        if work.cuts[index]:
            work.trim(index)
    cleared = replace_hulls(links, [hulls.hulls for hulls in work.sets()])
    return Clearance(links=cleared, joints=final, reliefs=work.reliefs(), limits=limits, residuals=residuals)


def _poses(work: CutHulls, joint: Joint, joints: Sequence[Joint],
           requirements: Sequence[Requirement], q: Float[np.ndarray, "P"],
           opened: Mapping[str, float] | None = None) -> np.ndarray:  # fmt: skip
    """Displacements ``P L 4 4`` along a joint's sweep, with what it requires open, and others ``opened``."""
    qpos = required_openings(joint, joints, requirements)
    for name, at in (opened or {}).items():
        qpos[name] = max(qpos.get(name, at), at)
    return link_displacements(work.links, joints, {**qpos, joint.name: q})


def _clear_joint(
    work: CutHulls,
    joint: Joint,
    joints: Sequence[Joint],
    requirements: Sequence[Requirement],
    stuck: dict[tuple[int, int, int, int], str],
) -> int:
    """Relieves every overlapping pair of hulls along one joint's sweep; returns the number of cuts.

    Joints that it carries are closed, and once more open to every share of `CARRIED`: the lever of a
    door may turn while the door swings. ``stuck`` is what could not be freed before; it grows.
    """
    q = sample_sweep(work.links, joints, joint)
    T = _poses(work, joint, joints, requirements, q)
    moving = moved_links(work.links, joints, joint)
    names = {work.links[index].name for index in moving}
    carried = [other for other in driven_joints(joints) if other is not joint and other.parent in names]
    for share in CARRIED if carried else ():
        opened = {other.name: other.lower + share * (other.upper - other.lower) for other in carried}
        T = np.concatenate([T, _poses(work, joint, joints, requirements, q, opened)])
    turned = {other.child for other in joints if other.is_travel and other.follows == joint.name}
    passing = max(GAP, min(PASSING, PASSING_SHARE * work.size))
    cutting = min(MARGIN, MARGIN_SHARE * work.size)
    changes = 0
    for a in moving:
        for b in (index for index in range(len(work.links)) if index not in moving):
            leaves = joint.type == "revolute" and {work.links[a].label, work.links[b].label} <= _FRONTS
            threaded = work.links[a].name in turned and work.links[b].name == joint.parent
            gap = THREAD if threaded else passing if leaves else GAP
            (first, slots_a), (second, slots_b) = work.prepared(a), work.prepared(b)
            found = signed_distances(first, second, T[:, a], T[:, b], gap)
            deep = found.distance < gap
            pairs: dict[tuple[int, int], list[int]] = {}
            order = np.argsort(found.distance[deep], kind="stable")
            for pose, i, j in np.stack([found.pose, found.first, found.second])[:, deep][:, order].T.tolist():
                pairs.setdefault((slots_a[i], slots_b[j]), []).append(pose)
            for (i, j), poses in pairs.items():
                mine, theirs = work.hulls[a][i], work.hulls[b][j]
                if mine is None or theirs is None or (a, i, b, j) in stuck:
                    continue
                hidden = (as_solid(mine) ^ as_solid(theirs)).volume()  # nothing can touch it, so it may go
                pair = OverlappingPair(
                    hulls=(mine, theirs),
                    poses=(T[poses, a], T[poses, b]),
                    volumes=(work.volumes[a][i], work.volumes[b][j]),
                    allowances=(work.allowance(a, i, hidden), work.allowance(b, j, hidden)),
                    least=(work.end(a, i), work.end(b, j)),
                    slivers=(work.is_sliver(a, i), work.is_sliver(b, j)),
                    room=(work.room(a), work.room(b)),
                    size=work.size,
                    axis=joint.axis,
                    margin=2.0 * THREAD if threaded else max(cutting, ENOUGH * gap),
                )
                done = relieve_pair(pair, gap, sheets=work.sheets, shares=work.shares)
                changes += _apply(work, ((a, i), (b, j)), done)
                if not done.reason:
                    continue
                skin = next((at for at in ((a, i), (b, j)) if work.is_skin(*at)), None)
                if skin is not None:
                    work.put(*skin, ())
                    work.cuts[skin[0]] += 1
                    changes += 1
                else:
                    stuck[a, i, b, j] = done.reason
    return changes


def _apply(work: CutHulls, places: tuple[tuple[int, int], tuple[int, int]], done: Relief) -> int:
    """Replaces two hulls, each given by its link and its place there, by what is left; the number of cuts."""
    for side, (link, slot) in enumerate(places):
        work.put(link, slot, done.hulls[side])
        work.cuts[link] += done.cuts[side]
        work.deepest[link] = max(work.deepest[link], done.depths[side])
    return sum(done.cuts)


def _settle_limits(
    work: CutHulls,
    joints: Sequence[Joint],
    requirements: Sequence[Requirement],
    stuck: dict[tuple[int, int, int, int], str],
) -> tuple[tuple[Joint, ...], tuple[LimitChange, ...], tuple[Residual, ...]]:
    """Lowers limits where most of the range is free; reports what is left."""
    limits, residuals = [], []
    final = list(joints)
    sets = work.sets()
    for slot, joint in enumerate(joints):
        if joint not in driven_joints(joints):
            continue
        q = sample_sweep(work.links, joints, joint)
        depths, pairs = _depths(work, sets, joint, joints, requirements, q)
        blocked = np.flatnonzero(depths > TOLERANCE)
        if not len(blocked):
            continue
        worst = int(depths.argmax())
        names = (work.links[pairs[worst][0]].name, work.links[pairs[worst][1]].name)
        free = int(blocked[0]) - 1
        share = 0.0 if free < 0 else (q[free] - q[0]) / (q[-1] - q[0])
        if joint.type != "continuous" and share >= MIN_RANGE:
            final[slot] = replace(joint, upper=float(q[free]))
            limits.append(
                LimitChange(joint=joint.name, before=joint.upper, after=float(q[free]), links=names)
            )
            continue
        reasons = sorted({reason for (a, _, b, _), reason in stuck.items() if {a, b} == set(pairs[worst])})
        residuals.append(
            Residual(
                joint=joint.name,
                links=names,
                depth=float(depths[worst]),
                q=float(q[worst]),
                reason=reasons[0] if reasons else "more cuts needed than allowed",
            )
        )
    return tuple(final), tuple(limits), tuple(residuals)


def _depths(
    work: CutHulls,
    sets: Sequence[HullSet],
    joint: Joint,
    joints: Sequence[Joint],
    requirements: Sequence[Requirement],
    q: Float[np.ndarray, "P"],
) -> tuple[Float[np.ndarray, "P"], list[tuple[int, int]]]:
    """Deepest penetration at each coordinate, and between which links."""
    T = _poses(work, joint, joints, requirements, q)
    moving = moved_links(work.links, joints, joint)
    depths = np.zeros(len(q))
    pairs = [(moving[0], moving[0])] * len(q)
    for a in moving:
        for b in (index for index in range(len(work.links)) if index not in moving):
            measured = penetration_depths(sets[a], sets[b], T[:, a], T[:, b])
            for pose in np.flatnonzero(measured > depths):
                depths[pose], pairs[pose] = measured[pose], (a, b)
    return depths, pairs
