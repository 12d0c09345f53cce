"""State of a motion problem: the arm, the part to move, and static and moving solids."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from artigen.transforms import inverse

from ..objects import TaskPart
from ..placement import part_motion
from ..robots import RobotSpec
from .body import HAND_GAP, Body, Obstacle, spare_room
from .chain import Chain
from .field import Field
from .work import Work, detour

CLOSE = 0.5
"""Share of the clearances that is kept on the way to a handle."""
NEAREST, NEAREST_HAND = 0.012, 0.004
"""Clearances of arm and hand below which they count as pressing, metres."""
PRESSED = 20.0
"""Cost per metre by which the arm would press into a solid along a path."""
COMPARED = 12
"""Number of ways along the path whose clearances are compared."""
STEP = 0.025
"""Travel of the handle between two waypoints, metres."""
BEYOND, LAG = 0.06, 0.006
"""Distance by which a path continues beyond the goal, as a share of the range and at least in metres, because
a pulled joint lags behind."""
LEAST_STEPS = 4
TURNING = 0.15
"""Smallest travel (m) that a radian counts as, for a knob that turns in place."""
UNLATCHED = 0.1
"""Share of a leaf's range (at most 0.1 rad or 10 cm) beyond which its latch no longer holds it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Way:
    """Displacements from rest along the motion of a part, in the frame of the robot's root: of the held
    geometry, and of the part itself. They differ if the handle is a lever that turns first."""

    held: Float[np.ndarray, "N 4 4"]
    carried: Float[np.ndarray, "N 4 4"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Opening:
    """An arm, the part, and the solids.

    ``others`` are solids in the object frame, ``carried`` the part and what it carries, in the object frame
    with the part closed; ``near_others`` and ``near_carried`` are the same around the grip, on finer grids.
    ``closed`` is the arm with its fingers shut; ``turned`` is the open fraction of the latch, if it is the
    part's handle.
    """

    chain: Chain
    robot: RobotSpec
    body: Body
    closed: Body
    part: TaskPart
    T_root_object: Float[np.ndarray, "4 4"]
    others: Field
    carried: Field
    near_others: Field
    near_carried: Field
    turned: float

    def motions(self, fractions: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N 4 4"]:
        """Poses of the closed part's frame in the root's, at fractions of its range."""
        return self.T_root_object @ part_motion(self.part, fractions)

    def obstacles(self, at: Float[np.ndarray, "*B 4 4"]) -> tuple[Obstacle, Obstacle]:
        """The other solids, and those of the part with the closed part's frame at ``at`` in the root's."""
        return (
            Obstacle(field=self.others, T_field_root=inverse(self.T_root_object)),
            Obstacle(field=self.carried, T_field_root=inverse(at)),
        )

    def is_latched(self, begin: float) -> bool:
        """Whether the handle must turn first to release a leaf at fraction ``begin`` of its range."""
        span = self.part.span
        return self.part.grip_latch is not None and begin * span <= min(0.1, UNLATCHED * span)

    def way(self, begin: float, end: float) -> Way:
        """Motion from ``begin`` to slightly beyond ``end``; the lever of a latched leaf is turned before."""
        carried = self.motions(path_fractions(self.part, begin, end))
        latch = self.part.grip_latch
        if latch is None:
            return Way(held=carried, carried=carried)
        if not self.is_latched(begin):
            return Way(held=carried @ part_motion(latch.part, np.array([self.turned])), carried=carried)
        turns = path_fractions(latch.part, self.turned, 1.0)
        first = np.repeat(carried[:1], len(turns), axis=0)
        held = np.concatenate(
            [first @ part_motion(latch.part, turns), carried[1:] @ part_motion(latch.part, turns[-1:])]
        )
        return Way(held=held, carried=np.concatenate([first, carried[1:]]))


def path_fractions(part: TaskPart, begin: float, end: float) -> Float[np.ndarray, "N"]:
    """Fractions from ``begin`` to slightly beyond ``end``, in steps of similar travel of the grip and
    rotation of the gripper. They exceed the limit only if the limit itself is the goal."""
    lever = 1.0
    if part.joint.type != "prismatic":
        lever = max(TURNING, float(np.linalg.norm(np.cross(part.joint.axis, part.grip - part.joint.origin))))
    lag = max(BEYOND, LAG / (part.span * lever))
    most = 1.0 + lag if end >= 1.0 else 1.0
    beyond = float(np.clip(end + np.sign(end - begin) * lag, 0.0, most))
    travel = abs(beyond - begin) * part.span * lever
    return np.linspace(begin, beyond, max(LEAST_STEPS, int(np.ceil(travel / STEP))) + 1)


def least_pressing(
    opening: Opening,
    path: Float[np.ndarray, "N K J"],
    motions: Float[np.ndarray, "N 4 4"],
    cost: Float[np.ndarray, "K"],
    good: Int[np.ndarray, "G"],
    *,
    skip: int = 0,
    body: Body | None = None,
) -> tuple[int, float]:
    """The best of K ways along the part's motion, and the distance (m) by which the arm would press into
    solids on it.

    Args:
        path: The ways.
        motions: Motion of the part, in the frame of the robot's root.
        cost: Costs of the ways, to which pressing adds.
        good: Indices of the ways to choose from.
        skip: Number of best ways to skip.
        body: The arm; default: with open fingers.
    """
    good = good[np.argsort(cost[good], kind="stable")][: skip + COMPARED]
    pressed = _pressure(opening, path[:, good], motions, body or opening.body)
    chosen = np.argsort(cost[good] + PRESSED * pressed, kind="stable")[skip]
    return int(good[chosen]), float(pressed[chosen])


def _pressure(
    opening: Opening, ways: Float[np.ndarray, "N K J"], motions: Float[np.ndarray, "N 4 4"], body: Body
) -> Float[np.ndarray, "K"]:
    """Distance (m) by which the arm would press into solids on each way: the sum of maximum and mean. The
    hand may touch the part."""
    others, carried = opening.obstacles(np.repeat(motions, ways.shape[1], axis=0))
    q = ways.reshape(-1, ways.shape[2])
    pressed = np.zeros(len(q))
    hand = body.gap <= HAND_GAP
    for mine, near, obstacles in ((~hand, NEAREST, (others, carried)), (hand, NEAREST_HAND, (others,))):
        pressed = np.maximum(pressed, -spare_room(opening.chain, body.some(mine, near), obstacles, q))
    pressed = pressed.reshape(-1, ways.shape[1])
    return pressed.max(axis=0) + pressed.mean(axis=0)


def way_around(
    opening: Opening, begin: float, q: Float[np.ndarray, "J"], goal: Float[np.ndarray, "J"]
) -> Float[np.ndarray, "N J"]:
    """Waypoints to ``goal`` around all solids, with the part at fraction ``begin``; only ``goal`` if no path
    was found or the arm starts too close to a solid."""
    at = opening.motions(np.array([begin]))[0]
    work = Work(
        chain=opening.chain, robot=opening.robot,
        body=replace(opening.body, gap=CLOSE * opening.body.gap),
        obstacles=opening.obstacles(at),
    )  # fmt: skip
    way = detour(work, q, goal)
    return goal[None] if way is None else way
