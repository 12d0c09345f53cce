"""Descendants of links, and the transitive closure of opening requirements."""

from collections.abc import Sequence

from sim_export.package import PackageJoint, Requirement


def hanging_links(joints: Sequence[PackageJoint], link: str) -> frozenset[str]:
    """Names of a link and all its descendants."""
    found: set[str] = set()
    front = {link}
    while front:
        found |= front
        front = {joint.child for joint in joints if joint.parent in front} - found
    return frozenset(found)


def needed_fractions(joint: str, requirements: Sequence[Requirement]) -> dict[str, float]:
    """Share of its range to which every joint must be open before ``joint`` moves, by name in their order.

    Requirements are followed recursively; the largest share of a joint counts. ``joint`` itself is never
    included, even if a foreign file makes it require itself.
    """
    fractions: dict[str, float] = {}
    waiting = [joint]
    while waiting:
        name = waiting.pop()
        for need in requirements:
            if need.joint == name and need.needs != joint and need.fraction > fractions.get(need.needs, -1.0):
                fractions[need.needs] = need.fraction
                waiting.append(need.needs)
    return dict(sorted(fractions.items()))
