"""`find_crossings`: joints that need others open because one thin link passes through another.

Depth does not tell that a seat passes through its closed lid, because two boards that cross are nowhere
deeper in one another than they are thick. The share of the moving link that gets into the other one does.
"""

from collections.abc import Sequence

from sim_export.checks.sweep import swept_overlap
from sim_export.collision.contacts import HullSet, signed_distances
from sim_export.collision.motion import (
    POSES,
    driven_joints,
    link_displacements,
    moved_links,
    require_openings,
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
    """The known requirements and those of joints whose links pass through links of other closed joints."""
    sets = [HullSet(hulls=link.hulls) for link in links]
    driven = driven_joints(joints)
    moved = {joint.name: moved_links(links, joints, joint) for joint in driven}

    def crossed(joint: PackageJoint, other: PackageJoint, opening: float) -> float:
        """Largest share of a link moved by ``joint`` that gets into a link that only ``other`` moves."""
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
                share = crossed(joint, other, other.lower)
                if share >= MIN_CROSSED:
                    blocked.append((share, joint, other))
    return require_openings(blocked, joints, lambda *at: crossed(*at) <= MAX_LEFT, known)
