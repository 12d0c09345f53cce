"""Which joints need which others open before they move, measured on hulls.

A joint *requires* another, such as that of a door before a drawer, when its sweep runs deep into the other's
closed link and is free of it once the other is open (`find_requirements`). Depth does not tell that a seat
passes through its closed lid, because two boards that cross are nowhere deeper in one another than they are
thick; the share of the moving link that gets into the other one does (`find_crossings`). Requirements never
form a cycle. Slight contact is a matter of clearance.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from jaxtyping import Float

from artigen.types import Joint
from sim_export.geometry.contacts import HullSet, penetration_depths, signed_distances
from sim_export.geometry.overlap import swept_overlap
from sim_export.motion.kinematics import (
    box_sides,
    driven_joints,
    link_displacements,
    moved_links,
    needed_fractions,
    sweep_coordinates,
)
from sim_export.package import Link, Requirement

POSES = 21
"""Samples of each joint's range."""
MIN_DEPTH = 0.025
"""Depth beyond the depth at rest, over the object's longest side, from which a link counts as blocked."""
FREE_DEPTH = 0.01
"""Depth beyond the depth at rest, over the object's longest side, up to which the way counts as free."""
FRACTIONS = (0.25, 0.5, 0.75, 1.0)
"""Openings of the other joint that are tried, least first."""
MIN_CROSSED = 0.15
"""Share of a link's volume that passes through another link, from which it counts as blocked."""
MAX_LEFT = 0.02
"""Share up to which the way counts as free."""


class _Ways:
    """Hulls and moving joints of an object, and the pairs of hulls that may meet while one joint moves."""

    def __init__(self, links: Sequence[Link], joints: Sequence[Joint]) -> None:
        self.links, self.joints, self.driven = links, joints, driven_joints(joints)
        self.sets = [HullSet(hulls=link.hulls) for link in links]
        self.moved = {joint.name: set(moved_links(links, joints, joint)) for joint in self.driven}

    def meet(
        self, joint: Joint, other: Joint, opening: float
    ) -> Iterator[tuple[HullSet, HullSet, Float[np.ndarray, "B 4 4"], Float[np.ndarray, "B 4 4"]]]:
        """Hulls of each link that ``joint`` moves, and of each that only ``other`` moves, with the places of
        both over the range of ``joint`` while ``other`` is at ``opening``."""
        coordinates = {joint.name: sweep_coordinates(joint, POSES), other.name: opening}
        T = link_displacements(self.links, self.joints, coordinates)
        for first in self.moved[joint.name]:
            for second in self.moved[other.name] - self.moved[joint.name]:
                if self.sets[first].hulls and self.sets[second].hulls:
                    yield self.sets[first], self.sets[second], T[:, first], T[:, second]


def find_requirements(links: Sequence[Link], joints: Sequence[Joint]) -> tuple[Requirement, ...]:
    """Which joints need which others open (`require_openings`), by how deep links get into each other."""
    ways, size = _Ways(links, joints), float(box_sides(links).max())

    def depth(joint: Joint, other: Joint, opening: float) -> float:
        """Deepest penetration of links moved by ``joint`` and those that only ``other`` moves, less that at
        rest."""
        deepest = 0.0
        for first, second, T_first, T_second in ways.meet(joint, other, opening):
            depths = penetration_depths(first, second, T_first, T_second)
            at_rest = penetration_depths(first, second, np.eye(4), np.eye(4))[0]
            deepest = max(deepest, float(depths.max() - at_rest))
        return deepest

    blocked = []
    for joint in ways.driven:
        for other in ways.driven:
            if not ways.moved[joint.name] <= ways.moved[other.name]:
                found = depth(joint, other, 0.0)
                if found > MIN_DEPTH * size:
                    blocked.append((found, joint, other))
    return require_openings(blocked, joints, lambda *at: depth(*at) <= FREE_DEPTH * size)


def require_openings(
    blocked: Sequence[tuple[float, Joint, Joint]],
    joints: Sequence[Joint],
    is_free: Callable[[Joint, Joint, float], bool],
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


def find_crossings(
    links: Sequence[Link], joints: Sequence[Joint], known: Sequence[Requirement]
) -> tuple[Requirement, ...]:
    """The known requirements and those of joints whose links pass through links of other closed joints."""
    ways = _Ways(links, joints)

    def crossed(joint: Joint, other: Joint, opening: float) -> float:
        """Largest share of a link moved by ``joint`` that gets into a link that only ``other`` moves."""
        most = 0.0
        for first, second, T_first, T_second in ways.meet(joint, other, opening):
            near = signed_distances(first, second, T_first, T_second)
            if len(near.pose):
                most = max(most, swept_overlap(first, second, T_first, T_second, near))
        return most

    blocked = []
    for joint in ways.driven:
        for other in ways.driven:
            apart = not ways.moved[joint.name] & ways.moved[other.name]
            if apart and other.name not in needed_fractions(joint.name, known):
                share = crossed(joint, other, other.lower)
                if share >= MIN_CROSSED:
                    blocked.append((share, joint, other))
    return require_openings(blocked, joints, lambda *at: crossed(*at) <= MAX_LEFT, known)
