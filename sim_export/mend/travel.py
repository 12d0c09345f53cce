"""Shortens the range of a joint whose part collides with its carrier."""

import numpy as np

from sim_export.checks.config import CheckConfig
from sim_export.mend.source import Source, leading_part, set_joint, source_package
from sim_export.motion.kinematics import driven_joints, sweep_coordinates
from sim_export.motion.requirements import POSES
from sim_export.source_faults import overlap_along

LEAST = 0.5
"""Smallest share of its range to which a joint is shortened."""


def cut_travel(source: Source, cfg: CheckConfig) -> Source:
    """Lowers upper limits to where a link enters one of its carriers by more than V201 allows."""
    package = source_package(source)
    shown = source.shown
    parents = {joint.child: joint.parent for joint in package.joints}
    for joint in driven_joints(package.joints):
        if joint.type == "continuous" or joint.child not in shown:
            continue
        depth, above = np.zeros(POSES), parents.get(joint.child)
        while above is not None:
            if above in shown:
                found = overlap_along(package, shown, joint, (above, joint.child), {})
                depth = np.maximum(depth, found - found[0])
            above = parents.get(above)
        blocked = np.flatnonzero(depth > cfg.max_penetration)
        last = int(blocked[0]) - 1 if len(blocked) else POSES
        q = sweep_coordinates(joint, POSES)
        if last >= POSES or q[last] - q[0] < LEAST * (q[-1] - q[0]):
            continue
        part = leading_part(source, joint.child)
        share = float(q[last] / q[-1])
        source = set_joint(
            source,
            part,
            f"{source.asset.parts[part].name}: its range was cut to {share:.0%}, beyond which it enters its "
            f"carrier by {1e3 * depth.max():.1f} mm",
            upper=source.asset.parts[part].joint.upper * share,
        )
    return source
