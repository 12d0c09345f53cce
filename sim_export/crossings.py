"""`find_crossings`: joints that need others open because one thin link passes through another.

Depth does not tell that a seat passes through its closed lid, because two boards that cross are nowhere
deeper in one another than they are thick. The share of the moving link that gets into the other one does.
"""

from collections.abc import Sequence

from sim_export.checks.sweep import swept_overlap
from sim_export.collision.contacts import HullSet, signed_distances
from sim_export.collision.motion import (
    FRACTIONS,
    POSES,
    driven_joints,
    link_displacements,
    moved_links,
    sweep_coordinates,
)
from sim_export.package import Link, PackageJoint, Requirement
from sim_export.tree import needed_fractions

MIN_CROSSED = 0.15
"""Share of a link's volume that passes through another link, from which it counts as blocked."""
MAX_LEFT = 0.02
"""Share up to which the way counts as free."""


def find_crossings(
    links: Sequence[Link], joints: Sequence[PackageJoint], known: Sequence[Requirement]
) -> tuple[Requirement, ...]:
    """The known requirements and those of joints whose links pass through links of other closed joints.

    Of two joints that block each other the one that is blocked more gets the requirement.
    """
    sets = [HullSet(hulls=link.hulls) for link in links]
    driven = driven_joints(joints)
    moved = {joint.name: moved_links(links, joints, joint) for joint in driven}

    def crossed(joint: PackageJoint, other: PackageJoint, fraction: float) -> float:
        """Largest share of a link moved by ``joint`` that gets into a link that only ``other`` moves."""
        opening = other.lower + fraction * (other.upper - other.lower)
        T = link_displacements(
            links, joints, {joint.name: sweep_coordinates(joint, POSES), other.name: opening}
        )
        most = 0.0
        for first in moved[joint.name]:
            for second in set(moved[other.name]) - set(moved[joint.name]):
                if sets[first].hulls and sets[second].hulls:
                    near = signed_distances(sets[first], sets[second], T[:, first], T[:, second])
                    if len(near.pose):
                        at = T[:, first], T[:, second], near
                        most = max(most, swept_overlap(sets[first], sets[second], *at))
        return most

    blocked = []
    for joint in driven:
        for other in driven:
            apart = not set(moved[joint.name]) & set(moved[other.name])
            if apart and other.name not in needed_fractions(joint.name, known):
                share = crossed(joint, other, 0.0)
                if share >= MIN_CROSSED:
                    blocked.append((share, joint, other))
    found = list(known)
    for _, joint, other in sorted(blocked, key=lambda row: (-row[0], row[1].name, row[2].name)):
        if joint.name in needed_fractions(other.name, found):
            continue
        for fraction in FRACTIONS:
            if crossed(joint, other, fraction) <= MAX_LEFT:
                found.append(Requirement(joint=joint.name, needs=other.name, fraction=fraction))
                break
    order = {joint.name: index for index, joint in enumerate(joints)}
    return tuple(sorted(found, key=lambda requirement: (order[requirement.joint], order[requirement.needs])))
