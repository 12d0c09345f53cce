"""Plans to push open a door that stands ajar, with closed fingers behind its free edge.

Where an arm cannot turn along with a handle, it can still follow the inner face of the leaf.
"""

import numpy as np
from jaxtyping import Float

from artigen.transforms import rotation_about

from ..objects import TaskPart
from ..robots import RobotSpec
from .grasp import gripper_pose
from .opening import Opening, least_pressing, path_fractions, way_around
from .plan_open import NoPlan, OpenPlan
from .reach import NEAR, follow, reach, starts_of

AJAR = 0.22
"""Smallest angle at which fingers fit behind the edge, rad."""
FINGER = 0.012
"""Half the thickness of the closed fingers, metres."""
INSERT = (0.05, 0.09, 0.14)
"""Distances behind the free edge at which the finger tips push, metres."""
HEIGHTS = (0.0, 0.12, -0.12, 0.25, -0.25)
"""Offsets along the hinge's direction from the handle's height, metres."""
SLANTS = np.radians([90.0, 65.0, 115.0, 45.0])
"""Angles of the fingers from the direction of the push: at 90 degrees they point at the hinge."""
SPREAD = 0.10
"""Distance outside of the edge, and behind the face, at which the fingers start, metres."""
MOST_TURN = 1.3


def plan_push(opening: Opening, q: Float[np.ndarray, "J"], begin: float, end: float) -> OpenPlan:
    """A plan that pushes a turning part from fraction ``begin`` of its range to ``end``, from behind.

    Arguments as for `plan_open`.

    Raises:
        NoPlan: If the part slides, is less than 0.22 rad open, or its path is out of reach.
    """
    chain, robot, part = opening.chain, opening.robot, opening.part
    name = part.joint.name
    if part.joint.type == "prismatic" or end < begin:
        raise NoPlan(f"joint {name!r}: only turning parts are pushed, and only open")
    angle = begin * part.span
    if angle < AJAR:
        raise NoPlan(f"joint {name!r}: {angle:.2f} rad open, fingers need {AJAR} rad to get behind the edge")
    contacts, cost, outside = _contacts(part, robot)
    motions = opening.motions(path_fractions(part, begin, end))
    hold, order = reach(chain, motions[0] @ contacts, cost, starts_of(chain, robot, q))
    if not len(order):
        raise NoPlan(f"joint {name!r}: the inside of its edge is out of reach")
    path, missed, turned = follow(chain, motions[:, None] @ contacts[order][None], hold, turn_weight=0.02)
    # From the leaf back to the start of the fingers: behind the face, then beyond the edge.
    shifts = np.zeros((3, len(order), 3))
    shifts[1:] = outside[order].transpose(1, 0, 2)
    back = np.repeat((motions[0] @ contacts[order])[None], 3, axis=0)
    back[:, :, :3, 3] += shifts @ motions[0, :3, :3].T
    entry, lost, _ = follow(chain, back, hold, turn_weight=0.05)
    total = cost[order] + 20.0 * missed + 5.0 * lost + 0.5 * turned
    good = np.flatnonzero((missed < NEAR) & (turned < MOST_TURN) & (lost < 3.0 * NEAR))
    if not len(good):
        raise NoPlan(
            f"joint {name!r}: no way along the inside of its edge, the best misses by "
            f"{1e3 * missed.min():.0f} mm"
        )
    best, pressed = least_pressing(opening, path, motions, total, good)
    return OpenPlan(
        before=way_around(opening, begin, q, entry[-1, best]),
        approach=entry[-2::-1, best],
        path=path[1:, best],
        leave=path[-1:, best],
        width=0.0,
        pressed=pressed,
    )


def _contacts(part: TaskPart, robot: RobotSpec) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tool poses ``[C, 4, 4]`` at the leaf in the object frame at rest, their costs, and for each the two
    offsets ``[C, 2, 3]`` of the approach: off the face, and from there beyond the edge."""
    axis, origin = part.joint.axis, part.joint.origin
    arm = part.grip - origin
    radial = arm - (arm @ axis) * axis
    radial /= np.linalg.norm(radial)
    push = np.cross(axis, radial)  # motion of the edge as the door opens
    local = part.moved - origin
    edge = float((local @ radial).max())
    outer = local[local @ radial > 0.7 * edge]
    inner = float((outer @ push).min())
    middle = float(arm @ axis)
    low, high = float((local @ axis).min()) + 0.03, float((local @ axis).max()) - 0.03
    poses, cost, outside = [], [], []
    for insert in INSERT:
        for height in HEIGHTS:
            at = float(np.clip(middle + height, low, high))
            for slant in SLANTS:
                for sign in (1.0, -1.0):
                    point = rotation_about(axis, slant) @ push
                    if point @ radial > 0.0:
                        point = rotation_about(axis, -slant) @ push
                    place = origin + at * axis + (edge - insert) * radial + (inner - FINGER) * push
                    poses.append(gripper_pose(point, sign * axis, place, robot))
                    cost.append(0.5 * abs(height) + 2.0 * insert + 0.2 * abs(slant - np.pi / 2.0))
                    off = -0.04 * push
                    outside.append([off, off + (insert + SPREAD) * radial])
    return np.array(poses), np.array(cost), np.array(outside)
