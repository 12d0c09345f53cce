"""Followers: parts driven by another part, such as a lid by its pedal; their joints mimic that part's."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from artigen.types import Joint
from sim_export.package import Link, Requirement, SimPackage


def couple_followers(
    links: Sequence[Link], joints: Sequence[Joint], follows: Mapping[str, str]
) -> tuple[tuple[Joint, ...], tuple[str, ...]]:
    """Makes some joints follow others; returns the joints and one record per follower.

    Follower and leader close and open together. A follower has no resistance; its leader has.

    Args:
        links: The links, each led by its first part.
        follows: Leader of each follower. Pairs with a part that was merged into another one are ignored.
    """
    leading = {link.name: link.parts[0] for link in links if link.parts}
    by_part = {leading[joint.child]: joint for joint in joints if joint.child in leading}
    out, records = [], []
    for joint in joints:
        leader = by_part.get(follows.get(leading.get(joint.child, ""), ""))
        if leader is not None:
            ratio = joint.upper / leader.upper
            joint = replace(joint, follows=leader.name, ratio=ratio, friction=0.0, damping=0.0, spring=0.0)
            records.append(
                f"{joint.name} follows {leader.name} times {ratio:.6g}; engines without <mimic> leave it free"
            )
        out.append(joint)
    return tuple(out), tuple(records)


def follow_parts(package: SimPackage, follows: Mapping[str, str]) -> SimPackage:
    """Adds followers to a package of independent joints.

    Requirements of a follower become requirements of its leader; a joint that requires a follower requires
    its leader instead.
    """
    joints, records = couple_followers(package.links, package.joints, follows)
    leaders = {
        joint.name: joint.follows for joint in joints if joint.follows is not None and not joint.is_travel
    }
    needs: dict[tuple[str, str], float] = {}
    for need in package.requires_open:
        key = leaders.get(need.joint, need.joint), leaders.get(need.needs, need.needs)
        if key[0] != key[1]:
            needs[key] = max(need.fraction, needs.get(key, 0.0))
    return replace(
        package,
        joints=joints,
        requires_open=tuple(
            Requirement(joint=joint, needs=other, fraction=fraction)
            for (joint, other), fraction in needs.items()
        ),
        records=(*package.records, *records),
    )
