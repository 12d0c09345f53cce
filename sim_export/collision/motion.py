"""Motion of package links: kinematics, required openings, sweeps, and limits that keep drawers held.

Links and joints are given in the object frame at rest, so that the displacement of a link is its parent's
displacement times its own joint's motion, as in `artigen.kinematics`. A joint *requires* another, such as
that of a door before a drawer, when its sweep runs deep into the other's closed link and is free of it
once the other is open. Requirements never form a cycle; shallow contact is clearance's business.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import screw_motion
from sim_export.collision.contacts import HullSet, penetration_depths
from sim_export.errors import InvalidKinematics
from sim_export.package import Link, PackageJoint, Requirement
from sim_export.tree import hanging_links, needed_fractions

MOVING_TYPES = ("revolute", "prismatic", "continuous")
POSES = 21
"""Samples of each joint's range."""
MIN_DEPTH = 0.025
"""Depth beyond the depth at rest, over the object's longest side, from which a link counts as blocked."""
FREE_DEPTH = 0.01
"""Depth beyond the depth at rest, over the object's longest side, up to which the way counts as free."""
FRACTIONS = (0.25, 0.5, 0.75, 1.0)
"""Openings of the other joint that are tried, least first."""
STEP = 4e-3
"""Farthest (m) that a point may move from one pose of a sweep to the next where hulls are cut or added: what
is left of cut hulls is thin, and the edge of a door would jump over it."""
SWEEP_POSES = (41, 401)
"""Fewest and most poses of such a sweep."""
HELD_LABELS = ("drawer", "tray")
HELD_SHARE = 0.12
"""Share of a drawer's depth that must stay inside what carries it."""
MIN_HELD_RANGE = 0.5
"""A limit is not lowered below this share of its range; such a drawer is reported instead."""


def driven_joints(joints: Sequence[PackageJoint]) -> tuple[PackageJoint, ...]:
    """The joints with a coordinate of their own: those that move and mimic no other."""
    return tuple(joint for joint in joints if joint.type in MOVING_TYPES and joint.mimic is None)


def box_sides(links: Sequence[Link]) -> Float[np.ndarray, "3"]:
    """Sides (m) of the box around all hulls at rest; 0 without hulls."""
    chunks = [hull.vertices for link in links for hull in link.hulls]
    return np.ptp(np.concatenate(chunks), axis=0) if chunks else np.zeros(3)


def package_joint_motion(joint: PackageJoint, q: Float[np.ndarray, "*B"]) -> Float[np.ndarray, "*B 4 4"]:
    """Displacement by one joint at its own coordinate ``q`` (rad or m)."""
    turns, slides = joint.type in ("revolute", "continuous"), joint.type == "prismatic"
    still = np.zeros_like(np.asarray(q, dtype=np.float64))
    return screw_motion(joint.axis, joint.origin, q if turns else still, q if slides else still)


def link_displacements(
    links: Sequence[Link], joints: Sequence[PackageJoint], qpos: Mapping[str, object]
) -> Float[np.ndarray, "*B L 4 4"]:
    """Displacement of every link from rest, in the order of ``links`` and in the object frame.

    Args:
        links: The links of a package.
        joints: Its joints.
        qpos: Coordinate of driven joints by name, numbers or arrays of poses that broadcast;
            joints that are not named stay at 0, mimicking ones follow theirs.

    Raises:
        InvalidKinematics: if joints and links do not form a tree.
        ValueError: if ``qpos`` names a joint that is not driven.
    """
    driven = {joint.name for joint in driven_joints(joints)}
    unknown = sorted(set(qpos) - driven)
    if unknown:
        raise ValueError(f"qpos names {', '.join(unknown)}; driven joints are {', '.join(sorted(driven))}")
    coordinates = {name: np.asarray(value, dtype=np.float64) for name, value in qpos.items()}
    poses = np.broadcast_shapes(*(value.shape for value in coordinates.values()))
    out = np.tile(np.eye(4), (*poses, len(links), 1, 1))
    slot = {link.name: index for index, link in enumerate(links)}
    for joint in _parents_first(links, joints):
        source, ratio = (joint.name, 1.0) if joint.mimic is None else (joint.mimic, joint.mimic_multiplier)
        own = package_joint_motion(joint, ratio * coordinates.get(source, np.zeros(())))
        out[..., slot[joint.child], :, :] = out[..., slot[joint.parent], :, :] @ own
    return out


def moved_links(
    links: Sequence[Link], joints: Sequence[PackageJoint], joint: PackageJoint
) -> tuple[int, ...]:
    """Indices of the links that ``joint`` moves: its child, what follows it, and all that hangs from them."""
    moving = [joint.child, *(other.child for other in joints if other.mimic == joint.name)]
    moved = frozenset().union(*(hanging_links(joints, link) for link in moving))
    return tuple(index for index, link in enumerate(links) if link.name in moved)


def farthest_travel(joint: PackageJoint, moved: Sequence[Float[np.ndarray, "N 3"]]) -> float:
    """Length (m) of the way that the farthest of the points that a joint moves goes over its whole range."""
    travel = joint.upper - joint.lower
    if joint.type == "prismatic" or not moved:
        return travel
    arms = np.concatenate(moved) - joint.origin
    return travel * float(np.linalg.norm(np.cross(joint.axis, arms), axis=1).max())


def _parents_first(links: Sequence[Link], joints: Sequence[PackageJoint]) -> list[PackageJoint]:
    """Joints ordered so that each comes after the joint that moves its parent."""
    children = [joint.child for joint in joints]
    names = {link.name for link in links}
    strangers = sorted(({joint.parent for joint in joints} | set(children)) - names)
    if strangers or len(set(children)) != len(children):
        raise InvalidKinematics(
            f"joints name links that are not there ({', '.join(strangers) or 'none'}) or move one twice"
        )
    placed = names - set(children)
    ordered: list[PackageJoint] = []
    waiting = list(joints)
    while waiting:
        ready = [joint for joint in waiting if joint.parent in placed]
        if not ready:
            raise InvalidKinematics(f"joints form a cycle: {', '.join(joint.name for joint in waiting)}")
        ordered += ready
        placed |= {joint.child for joint in ready}
        waiting = [joint for joint in waiting if joint.child not in placed]
    return ordered


def sweep_coordinates(joint: PackageJoint, poses: int) -> Float[np.ndarray, "P"]:
    """Evenly spaced coordinates from closed to fully open."""
    return np.linspace(joint.lower, joint.upper, poses)


def required_openings(
    joint: PackageJoint, joints: Sequence[PackageJoint], requirements: Sequence[Requirement]
) -> dict[str, float]:
    """Coordinates of the joints that must be open for ``joint`` to move, requirements of theirs included."""
    by_name = {other.name: other for other in joints}
    return {
        name: by_name[name].lower + fraction * (by_name[name].upper - by_name[name].lower)
        for name, fraction in needed_fractions(joint.name, requirements).items()
    }


def find_requirements(links: Sequence[Link], joints: Sequence[PackageJoint]) -> tuple[Requirement, ...]:
    """Which joints need which others open (`require_openings`), by how deep links get into each other."""
    sets = [HullSet(hulls=link.hulls) for link in links]
    size = float(box_sides(links).max())
    driven = driven_joints(joints)
    moved = {joint.name: moved_links(links, joints, joint) for joint in driven}
    blocked = []
    for joint in driven:
        poses = sweep_coordinates(joint, POSES)
        for other in driven:
            apart = [slot for slot in moved[other.name] if slot not in moved[joint.name]]
            if other is joint or not apart or set(moved[joint.name]) <= set(moved[other.name]):
                continue
            depth = _depth(links, joints, sets, {joint.name: poses}, (moved[joint.name], apart))
            if depth > MIN_DEPTH * size:
                blocked.append((depth, joint, other))

    def is_free(joint: PackageJoint, other: PackageJoint, opening: float) -> bool:
        opened = {joint.name: sweep_coordinates(joint, POSES), other.name: opening}
        apart = [slot for slot in moved[other.name] if slot not in moved[joint.name]]
        return _depth(links, joints, sets, opened, (moved[joint.name], apart)) <= FREE_DEPTH * size

    return require_openings(blocked, joints, is_free)


def require_openings(
    blocked: Sequence[tuple[float, PackageJoint, PackageJoint]],
    joints: Sequence[PackageJoint],
    is_free: Callable[[PackageJoint, PackageJoint, float], bool],
    known: Sequence[Requirement] = (),
) -> tuple[Requirement, ...]:
    """Requirements for blocked joints, with the least of `FRACTIONS` that frees each, and the known ones.

    Args:
        blocked: How much a joint is blocked, the joint, and the joint that blocks it. Of two joints that
            block each other the one that is blocked more gets the requirement and the other none, so that
            following requirements always ends.
        joints: All joints, in the order of the result.
        is_free: Whether the first joint moves freely while the second one is at a coordinate.
        known: Requirements found before.
    """
    found = list(known)
    for _, joint, other in sorted(blocked, key=lambda row: (-row[0], row[1].name, row[2].name)):
        if joint.name in needed_fractions(other.name, found):
            continue
        for fraction in FRACTIONS:
            if is_free(joint, other, other.lower + fraction * (other.upper - other.lower)):
                found.append(Requirement(joint=joint.name, needs=other.name, fraction=fraction))
                break
    order = {joint.name: index for index, joint in enumerate(joints)}
    return tuple(sorted(found, key=lambda requirement: (order[requirement.joint], order[requirement.needs])))


def _depth(
    links: Sequence[Link],
    joints: Sequence[PackageJoint],
    sets: Sequence[HullSet],
    qpos: Mapping[str, object],
    pair: tuple[Sequence[int], Sequence[int]],
) -> float:
    """Deepest penetration of two groups of links along a sweep, less what it is at rest."""
    T = link_displacements(links, joints, qpos)
    deepest = 0.0
    for first in pair[0]:
        for second in pair[1]:
            if sets[first].hulls and sets[second].hulls:
                depths = penetration_depths(sets[first], sets[second], T[:, first], T[:, second])
                at_rest = penetration_depths(sets[first], sets[second], np.eye(4), np.eye(4))[0]
                deepest = max(deepest, float(depths.max() - at_rest))
    return deepest


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep:
    """One joint's sweep: displacements of all links, and the indices of those it moves."""

    T: Float[np.ndarray, "P L 4 4"]
    moved: frozenset[int]


def sample_sweep(
    links: Sequence[Link], joints: Sequence[PackageJoint], joint: PackageJoint
) -> Float[np.ndarray, "P"]:
    """Coordinates of a joint from closed to fully open, close enough for all hulls that it moves."""
    moved = [hull.vertices for slot in moved_links(links, joints, joint) for hull in links[slot].hulls]
    return sample_range(joint, moved, STEP, SWEEP_POSES)


def sample_range(
    joint: PackageJoint, moved: Sequence[Float[np.ndarray, "N 3"]], step: float, poses: tuple[int, int]
) -> Float[np.ndarray, "P"]:
    """Coordinates of a joint from closed to fully open between which no point that it moves goes farther than
    ``step`` (m); ``poses`` are the fewest and the most."""
    steps = int(np.ceil(farthest_travel(joint, moved) / step))
    return sweep_coordinates(joint, int(np.clip(steps + 1, *poses)))


def read_sweeps(
    links: Sequence[Link],
    joints: Sequence[PackageJoint],
    requirements: Sequence[Requirement],
) -> tuple[Sweep, ...]:
    """Every driven joint's sweep, with what it requires open."""
    sweeps = []
    for joint in driven_joints(joints):
        q = sample_sweep(links, joints, joint)
        T = link_displacements(
            links, joints, {**required_openings(joint, joints, requirements), joint.name: q}
        )
        sweeps.append(Sweep(T=T, moved=frozenset(moved_links(links, joints, joint))))
    return tuple(sweeps)


def held_length(own: Float[np.ndarray, "N"], carrier: Float[np.ndarray, "M"], travel: float) -> float:
    """Length over which a body, moved by ``travel`` along a line, overlaps its carrier.

    ``own`` and ``carrier`` are coordinates of points along that line, at rest. Negative: a gap.
    """
    return float(min(own.max() + travel, carrier.max()) - max(own.min() + travel, carrier.min()))


def keep_drawers_held(
    links: Sequence[Link],
    joints: Sequence[PackageJoint],
    panels: Mapping[str, Float[np.ndarray, "N 3"]],
) -> tuple[tuple[PackageJoint, ...], tuple[str, ...]]:
    """Lowers the limits of drawers that would leave their carrier; one sentence per change.

    Args:
        links: Links with hulls, object frame at rest.
        joints: Their joints.
        panels: Points of each drawer without its handles, by link.
    """
    by_name = {link.name: link for link in links}
    parent = {joint.child: joint.parent for joint in joints}
    out, records = [], []
    for joint in joints:
        slides = joint.type == "prismatic" and joint.mimic is None and joint.child in panels
        if not slides or by_name[joint.child].label not in HELD_LABELS:
            out.append(joint)
            continue
        above, at = [], joint.parent
        while at in by_name:
            above += [hull.vertices for hull in by_name[at].hulls]
            at = parent.get(at, "")
        own = panels[joint.child] @ joint.axis
        carrier = np.concatenate(above) @ joint.axis if above else np.zeros(0)
        wanted = HELD_SHARE * float(np.ptp(own))
        if not len(carrier) or held_length(own, carrier, joint.upper) >= wanted:
            out.append(joint)
            continue
        upper = float(carrier.max() - own.min()) - wanted
        if upper < joint.lower + MIN_HELD_RANGE * (joint.upper - joint.lower):
            out.append(joint)
            records.append(
                f"{joint.name}: {held_length(own, carrier, joint.upper) / np.ptp(own):.0%} of the drawer "
                f"stays inside at {joint.upper:.4g} m, and too little range would be left to hold it"
            )
            continue
        out.append(replace(joint, upper=upper))
        records.append(
            f"{joint.name}: upper limit {joint.upper:.4g} lowered to {upper:.4g} m, so that "
            f"{HELD_SHARE:.0%} of the drawer's depth stay inside"
        )
    return tuple(out), tuple(records)
