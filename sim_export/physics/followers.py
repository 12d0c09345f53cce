"""Parts that another part moves along, as a pedal does a lid: their joints mimic that part's joint."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from sim_export.package import Link, PackageJoint


def couple_followers(
    links: Sequence[Link], joints: Sequence[PackageJoint], follows: Mapping[str, str]
) -> tuple[tuple[PackageJoint, ...], tuple[str, ...]]:
    """Joints of which some follow others, and one sentence for each of these.

    Both are closed and both are open at the same time. A follower resists nothing: what moves it does.

    Args:
        links: The links, each led by its first part.
        joints: Their joints.
        follows: For each part that follows another one, that part. Pairs of which a part leads no link any
            more, being merged into another one, are left as they are.
    """
    leading = {link.name: link.parts[0] for link in links if link.parts}
    by_part = {leading[joint.child]: joint for joint in joints if joint.child in leading}
    out, records = [], []
    for joint in joints:
        leader = by_part.get(follows.get(leading.get(joint.child, ""), ""))
        if leader is not None:
            ratio = joint.upper / leader.upper
            joint = replace(
                joint, mimic=leader.name, mimic_multiplier=ratio, friction=0.0, damping=0.0, spring=0.0
            )
            records.append(
                f"{joint.name} follows {leader.name} times {ratio:.6g}; engines without <mimic> let it go"
            )
        out.append(joint)
    return tuple(out), tuple(records)
