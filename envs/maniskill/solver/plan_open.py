"""Plans the motion of a part by its handle or its own edge: grasp it and follow the joint's path.

Purely geometric. Grasps are tried by inverse kinematics along the whole path; the one with the smallest
errors and the most clearance is chosen.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.errors import ArtigenError

from .contacts import pinch_grasps
from .grasp import Grasps, find_grasps
from .opening import Opening, least_pressing, way_around
from .reach import NEAR, drawn_back, follow, reach, starts_of

LOOSE = 0.01
MOST_TURN = 0.9
"""Largest rotation of the gripper about the held geometry, rad, where the arm cannot turn along with a
door."""


class NoPlan(ArtigenError):
    """The part cannot be moved in this way; the message states what was tried and the remaining error."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OpenPlan:
    """Waypoints of the arm (rad): approach around solids; on to the part, the last one at it; along the
    joint's path; retreat.

    ``width`` is the opening of the fingers (m) before they close on a handle, 0 if they push and stay closed.
    ``pressed`` is the distance (m) by which the arm presses into solids along the path.
    """

    before: Float[np.ndarray, "B J"]
    approach: Float[np.ndarray, "A J"]
    path: Float[np.ndarray, "N J"]
    leave: Float[np.ndarray, "L J"]
    width: float
    pressed: float


def handle_grasps(opening: Opening) -> Grasps:
    """Grasps of a part's handle.

    Raises:
        NoPlan: If there are none, or the gripper does not open wide enough.
    """
    part, robot, name = opening.part, opening.robot, opening.part.joint.name
    if part.handle is None:
        raise NoPlan(f"joint {name!r}: no handle is annotated")
    grasps = find_grasps(part.handle, part.held, robot)
    if not len(grasps.poses):
        raise NoPlan(
            f"joint {name!r}: the handle is {1e3 * part.handle.width:.0f} mm thick, the gripper opens "
            f"{1e3 * robot.opening:.0f} mm"
        )
    return grasps


def edge_grasps(opening: Opening) -> Grasps:
    """Pinch grasps of the part itself.

    Raises:
        NoPlan: If there are none, or the part is latched, so that its handle must be held.
    """
    name = opening.part.joint.name
    if opening.part.grip_latch is not None:
        raise NoPlan(f"joint {name!r}: the latch is the handle, so nothing else is held")
    grasps = pinch_grasps(opening)
    if not len(grasps.poses):
        raise NoPlan(f"joint {name!r}: fingers cannot pinch the part itself")
    return grasps


def plan_open(
    opening: Opening, grasps: Grasps, q: Float[np.ndarray, "J"], begin: float, end: float, *, skip: int = 0
) -> OpenPlan:
    """A plan that moves a part from fraction ``begin`` of its range to ``end`` in the grip of the fingers.

    Args:
        q: Current arm angles, rad.
        begin: Current fraction.
        end: Goal fraction.
        skip: Number of best plans to skip, for another try.

    Raises:
        NoPlan: If no grasp is in reach along the path.
    """
    chain, robot, part = opening.chain, opening.robot, opening.part
    way = opening.way(begin, end)
    motions = way.held  # [N, 4, 4]
    tools = np.eye(4)
    tools[:3, :3] = robot.tool_axes.T
    poses = grasps.poses @ tools
    hold, order = reach(chain, motions[0] @ poses, grasps.cost, starts_of(chain, robot, q))
    if not len(order):
        raise NoPlan(f"joint {part.joint.name!r}: no grasp is in reach at its start")
    targets = motions[:, None] @ poses[order][None]
    ways = [follow(chain, targets, hold), follow(chain, targets, hold, turn_weight=LOOSE)]
    path, missed, turned = (
        np.concatenate([way[k] for way in ways], axis=-2 if k == 0 else 0) for k in range(3)
    )
    cost = np.tile(grasps.cost[order], 2) + 20.0 * missed + turned
    good = np.flatnonzero((missed < NEAR) & (turned < MOST_TURN))
    if len(good) <= skip:
        raise NoPlan(
            f"joint {part.joint.name!r}: {len(good)} grasps can be carried along the path within "
            f"{1e3 * NEAR:.0f} mm, the best misses it by {1e3 * missed.min():.0f} mm"
        )
    best, pressed = least_pressing(opening, path, way.carried, cost, good, skip=skip)
    return OpenPlan(
        before=way_around(opening, begin, q, drawn_back(chain, robot, path[0, best])),
        approach=path[:1, best],
        path=path[1:, best],
        leave=drawn_back(chain, robot, path[-1, best])[None],
        width=grasps.width,
        pressed=pressed,
    )
