"""How near to a limit a joint has reached it; moving as little, it is at rest."""

import numpy as np

LIMIT_FRACTION = 0.01
"""Distance from a limit, as a share of the range, within which it counts as reached, and as kept at rest
(V302, V305, V504, V505) ..."""
LIMIT_DEGREES = 0.5
"""... or, for turning joints, this angle if it is larger ..."""
LIMIT_METRES = 1e-4
"""... or, for sliding joints, this distance, which a key of 1 mm travel creeps in PhysX."""


def limit_tolerance(joint_type: str, span: float) -> float:
    """Distance from a limit within which it counts as reached: 1 % of the range, or 0.1 mm or 0.5 degrees if
    that is more."""
    least = LIMIT_METRES if joint_type == "prismatic" else float(np.radians(LIMIT_DEGREES))
    return max(LIMIT_FRACTION * span, least)
