"""Finds which joint must be open before another can move, such as a door before a drawer.

A joint *requires* another when its sweep runs deep into that other's closed link and is free of it
once the other is open. Requirements never form a cycle; shallow contact is none of them, but
clearance's business.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from sim_export.collision.contacts import HullSet, penetration_depths
from sim_export.collision.motion import driven_joints, link_displacements, longest_side, moved_links
from sim_export.package import Link, PackageJoint, Requirement
from sim_export.tree import needed_fractions

POSES = 21
"""Samples of each joint's range."""
MIN_DEPTH = 0.025
"""Depth beyond the depth at rest, over the object's longest side, from which a link counts as blocked."""
FREE_DEPTH = 0.01
"""Depth beyond the depth at rest, over the object's longest side, up to which the way counts as free."""
FRACTIONS = (0.25, 0.5, 0.75, 1.0)
"""Openings of the other joint that are tried, least first."""


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
    """Which joints need which others open, with the least opening that frees them.

    Where two joints block each other, the one that is blocked deeper gets the requirement and the
    other none, so that following requirements always ends.
    """
    sets = [HullSet(hulls=link.hulls) for link in links]
    size = longest_side(links)
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
                blocked.append((depth, joint, other, apart))
    found: list[Requirement] = []
    for _, joint, other, apart in sorted(blocked, key=lambda row: (-row[0], row[1].name, row[2].name)):
        poses = sweep_coordinates(joint, POSES)
        if other.name == joint.name or joint.name in needed_fractions(other.name, found):
            continue
        for fraction in FRACTIONS:
            opened = {joint.name: poses, other.name: other.lower + fraction * (other.upper - other.lower)}
            if _depth(links, joints, sets, opened, (moved[joint.name], apart)) <= FREE_DEPTH * size:
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
