"""Random states of an object in which nothing is pushed through what must be open for it."""

import numpy as np

from sim_export.motion.kinematics import driven_joints, needed_fractions
from sim_export.package import SimPackage

CLOSED = 0.4
"""Share of the joints that stay closed."""


def sample_state(package: SimPackage, rng: np.random.Generator) -> dict[str, float]:
    """Coordinates (m, rad) of all driven joints by name; about `CLOSED` of them are at rest.

    A joint moves only if those that it requires are as far open as it needs them: a rack stays in while its
    door is shut.
    """
    shares = {
        joint.name: 0.0 if rng.random() < CLOSED else float(rng.random())
        for joint in driven_joints(package.joints)
    }
    for name in shares:
        needs = needed_fractions(name, package.requires_open)
        if any(shares.get(other, 0.0) < fraction for other, fraction in needs.items()):
            shares[name] = 0.0
    return {
        joint.name: joint.lower + shares[joint.name] * (joint.upper - joint.lower)
        if shares[joint.name] > 0.0
        else min(max(0.0, joint.lower), joint.upper)
        for joint in driven_joints(package.joints)
    }
