"""L2: no penetration at rest or along the range of any joint (V201, V202).

Simulators do not detect this, because they filter contacts between parent and child. Here every pair of links
counts, measured by exact hull distances.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from artigen.types import Joint
from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, at_most
from sim_export.checks.subject import Subject
from sim_export.errors import PackageError
from sim_export.geometry.contacts import penetration_depths, signed_distances
from sim_export.geometry.overlap import TOUCH, swept_overlap
from sim_export.motion.kinematics import needed_fractions, required_openings, sample_range


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """Poses to check: displacement of every link, and the pairs of links to test."""

    name: str
    T: dict[str, np.ndarray]
    pairs: tuple[tuple[str, str], ...]


def has_colliding_joints(subject: Subject) -> str:
    """Applies if a moving link has collision geometry."""
    if not subject.driven:
        return "no joint moves"
    carried = {name for joint in subject.driven for name in subject.moved(joint)}
    if not any(subject.hull_sets[name].hulls for name in carried):
        return "nothing that moves has collision geometry"
    return ""


def check_sweep(subject: Subject, cfg: CheckConfig) -> Finding:
    """V201: no link enters another one along any joint's range, or at sampled poses of all joints."""
    motions = [joint_motion(subject, joint, cfg) for joint in subject.driven]
    motions.append(joint_poses(subject, cfg))
    depth, depth_where = 0.0, ""
    overlap, overlap_where = 0.0, ""
    meeting: list[str] = []
    for motion in motions:
        for mover, other in motion.pairs:
            first, second = subject.hull_sets[mover], subject.hull_sets[other]
            found = signed_distances(first, second, motion.T[mover], motion.T[other])
            if not len(found.distance):
                continue
            excess = -float(found.distance.min()) - _rest_depth(subject, mover, other)
            where = f"{mover} into {other} ({motion.name})"
            if excess > depth:
                depth, depth_where = excess, where
            if excess > TOUCH:
                share = swept_overlap(first, second, motion.T[mover], motion.T[other], found)
                if share > overlap:
                    overlap, overlap_where = share, where
                if excess > cfg.max_penetration or share > cfg.max_swept_overlap:
                    meeting += [mover, other]
    if depth / cfg.max_penetration >= overlap / cfg.max_swept_overlap:
        value, threshold, unit, where = depth, cfg.max_penetration, "m", depth_where
    else:
        value, threshold, unit, where = overlap, cfg.max_swept_overlap, "of the volume", overlap_where
    message = (
        f"{len(subject.driven)} joints: {1e3 * depth:.3g} mm at most beyond rest "
        f"({depth_where or 'nowhere'}; allowed {1e3 * cfg.max_penetration:g} mm), "
        f"{100 * overlap:.2g} % of a link's volume (allowed {100 * cfg.max_swept_overlap:g} %)"
    )
    return at_most(value, threshold, unit, where=where, message=message, links=meeting)


def open_positions(subject: Subject, joint: Joint) -> dict[str, float]:
    """Coordinates of the joints that must be open before ``joint`` can move, recursively."""
    known = {other.name for other in subject.driven}
    lost = [name for name in needed_fractions(joint.name, subject.requires_open) if name not in known]
    if lost:
        raise PackageError(
            f"annotations.json: {joint.name!r} needs {lost[0]!r}, which is no joint that moves"
        )
    return required_openings(joint, subject.driven, subject.requires_open)


def joint_motion(subject: Subject, joint: Joint, cfg: CheckConfig) -> Motion:
    """One joint through its range, the others closed or as far open as `requires_open` demands.

    In a folder without such requirements, a link is tested against ancestors and static links only, because
    two movable neighbours may collide where one should have been opened first.
    """
    movers = subject.moved(joint)
    poses = cfg.sweep_samples, cfg.max_sweep_samples
    moved = [subject.hull_sets[name].vertices for name in movers if subject.hull_sets[name].hulls]
    qpos: dict[str, ArrayLike] = {
        **open_positions(subject, joint),
        joint.name: sample_range(joint, moved, cfg.sweep_step, poses),
    }
    others = [name for name in subject.links if name not in movers]
    pairs = [
        (mover, other)
        for mover in movers
        for other in others
        if subject.is_package or other in subject.static_links or other in subject.ancestors(mover)
    ]
    return Motion(name=joint.name, T=subject.displacements(qpos), pairs=_solid(subject, pairs))


def joint_poses(subject: Subject, cfg: CheckConfig) -> Motion:
    """Sampled poses of all joints; links are tested against ancestors and static links only, since movable
    neighbours may collide.

    A latch is at least as far open as the part it holds requires; otherwise the door would be blocked.
    """
    from scipy.stats.qmc import Sobol

    lower = np.array([joint.lower for joint in subject.driven])
    upper = np.array([joint.upper for joint in subject.driven])
    unit = Sobol(len(lower), scramble=False).random(cfg.sobol_poses)
    values = (lower + unit * (upper - lower)).T
    qpos = {joint.name: row for joint, row in zip(subject.driven, values, strict=True)}
    children = {joint.name: joint.child for joint in subject.driven}
    for joint in subject.driven:
        carried = subject.carried(joint.child)
        for name, opened in open_positions(subject, joint).items():
            if children[name] in carried:
                qpos[name] = np.maximum(qpos[name], opened)
    moving = [name for name in subject.links if name not in subject.static_links]
    pairs = [
        (name, other)
        for name in moving
        for other in subject.links
        if other in subject.ancestors(name) or other in subject.static_links
    ]
    return Motion(name="all joints", T=subject.displacements(qpos), pairs=_solid(subject, pairs))


def _solid(subject: Subject, pairs: list[tuple[str, str]]) -> tuple[tuple[str, str], ...]:
    return tuple(p for p in pairs if subject.hull_sets[p[0]].hulls and subject.hull_sets[p[1]].hulls)


def _rest_depth(subject: Subject, first: str, second: str) -> float:
    still = np.eye(4)
    return float(penetration_depths(subject.hull_sets[first], subject.hull_sets[second], still, still)[0])


def has_two_solids(subject: Subject) -> str:
    """Applies if two links have collision geometry."""
    solid = [name for name, hulls in subject.hull_sets.items() if hulls.hulls]
    return "" if len(solid) > 1 else "fewer than two links have collision geometry"


def check_rest(subject: Subject, cfg: CheckConfig) -> Finding:
    """V202: links do not overlap at rest; the tolerance between a link and its ancestors is that of
    motions."""
    names = [name for name, hulls in subject.hull_sets.items() if hulls.hulls]
    worst = (0.0, 0.0, cfg.max_rest_overlap, "")
    meeting: list[str] = []
    for index, first in enumerate(names):
        for second in names[:index]:
            related = first in subject.ancestors(second) or second in subject.ancestors(first)
            allowed = cfg.max_rest_overlap_parent if related else cfg.max_rest_overlap
            depth = _rest_depth(subject, first, second)
            worst = max(worst, (depth / allowed, depth, allowed, f"{second} and {first}"))
            meeting += [first, second] if depth > allowed else []
    _, depth, allowed, where = worst
    message = (
        f"{where or 'no two links'} overlap by {1e3 * depth:.3g} mm at rest, allowed is {1e3 * allowed:g} mm"
    )
    return at_most(depth, allowed, "m", where=where, message=message, links=meeting)


SWEEP_CHECKS = (
    CheckSpec(id="V201", level="L2", title="sweep", applies=has_colliding_joints, function=check_sweep),
    CheckSpec(id="V202", level="L2", title="rest overlap", applies=has_two_solids, function=check_rest),
)
