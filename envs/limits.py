"""Ends of a joint's range, and how near to one it has reached it; moving as little, it is at rest."""

import numpy as np

from artigen.types import Joint

LIMIT_FRACTION = 0.01
"""Distance from a limit, as a share of the range, within which it counts as reached, and as kept at rest
(V302, V305, V504, V505) ..."""
LIMIT_DEGREES = 0.5
"""... or, for turning joints, this angle if it is larger ..."""
LIMIT_METRES = 1e-4
"""... or, for sliding joints, this distance, which a key of 1 mm travel creeps in PhysX."""


def joint_ends(joint: Joint) -> tuple[float, float]:
    """Limits of a joint (m or rad); 0 and one turn without limits."""
    return (0.0, 2.0 * np.pi) if joint.type == "continuous" else (joint.lower, joint.upper)


def rest_coordinate(joint: Joint) -> float:
    """0, or the nearest value within the joint's limits (m or rad)."""
    return float(np.clip(0.0, *joint_ends(joint)))


def limit_tolerance(joint: Joint) -> float:
    """Distance from a limit within which it counts as reached: 1 % of the range, or 0.1 mm or 0.5 degrees if
    that is more."""
    lower, upper = joint_ends(joint)
    least = LIMIT_METRES if joint.type == "prismatic" else float(np.radians(LIMIT_DEGREES))
    return max(LIMIT_FRACTION * (upper - lower), least)
