"""Descendants of links, and the transitive closure of what must be open first."""

from collections.abc import Sequence

from sim_export.package import PackageJoint, Requirement


def hanging_links(joints: Sequence[PackageJoint], link: str) -> frozenset[str]:
    """A link and everything that hangs from it, by name."""
    found: set[str] = set()
    front = {link}
    while front:
        found |= front
        front = {joint.child for joint in joints if joint.parent in front} - found
    return frozenset(found)


def needed_fractions(joint: str, requirements: Sequence[Requirement]) -> dict[str, float]:
    """How far (share of its range) every joint must be open before ``joint`` moves, by name in their order.

    Needs of needs are included, and where several name a joint the largest share counts. ``joint`` itself
    is never among them, even where a foreign file has it need itself.
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
