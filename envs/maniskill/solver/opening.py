"""The scene of an arm and the part to move: static and moving geometry."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse

from ..objects import TaskPart
from ..placement import part_motion
from ..robots import RobotSpec
from .body import HAND_GAP, Body, Obstacle, spare_room
from .chain import Chain
from .field import Field
from .work import Work, detour

CLOSE = 0.5
"""Part of the gaps that is kept on the way to a handle."""
NEAREST, NEAREST_HAND = 0.012, 0.004
"""Distances from which on arm and hand count as pressing, metres."""
PRESSED = 20.0
"""Cost of a metre by which the arm would press into something along a path."""
STEP = 0.025
"""Travel of the handle between two waypoints, metres."""
BEYOND = 0.06
"""How much farther than asked a path goes, part of the range: a pulled joint lags behind."""
LEAST_STEPS = 4
TURNING = 0.15
"""Travel (m) that a radian counts at least, of a knob that turns in place."""
UNLATCHED = 0.1
"""Part of a leaf's range (at most; in any case 0.1 rad or 5 cm) from which on its latch holds it no more."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Way:
    """Displacements from rest, in the frame of the robot's root, along the motion of a part: of what is
    held, and of the part itself. They differ where the handle is a lever that turns first."""

    held: Float[np.ndarray, "N 4 4"]
    carried: Float[np.ndarray, "N 4 4"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Opening:
    """An arm, the part, and the solids.

    ``others`` are solids in the object frame, ``carried`` the part and what it carries, in the object frame
    with the part closed; ``near_others`` and ``near_carried`` are the same around the grip, on finer grids.
    ``closed`` is the arm with its fingers shut; ``turned`` is how far the latch is open, share of its range,
    where it is the part's handle.
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

    def way(self, begin: float, end: float) -> Way:
        """From ``begin`` to a little beyond ``end``; the lever of a latched leaf is turned before that."""
        carried = self.motions(path_fractions(self.part, begin, end))
        latch = self.part.grip_latch
        if latch is None:
            return Way(held=carried, carried=carried)
        if begin * self.part.span > min(0.1, UNLATCHED * self.part.span):
            return Way(held=carried @ part_motion(latch.part, np.array([self.turned])), carried=carried)
        turns = path_fractions(latch.part, self.turned, 1.0)
        first = np.repeat(carried[:1], len(turns), axis=0)
        held = np.concatenate(
            [first @ part_motion(latch.part, turns), carried[1:] @ part_motion(latch.part, turns[-1:])]
        )
        return Way(held=held, carried=np.concatenate([first, carried[1:]]))


def path_fractions(part: TaskPart, begin: float, end: float) -> Float[np.ndarray, "N"]:
    """From ``begin`` to a little beyond ``end``, in steps of about the same travel of the grip, and of
    the gripper's turn. It leads beyond the limit only where the limit itself is asked for."""
    most = 1.0 + BEYOND if end >= 1.0 else 1.0
    beyond = float(np.clip(end + np.sign(end - begin) * BEYOND, 0.0, most))
    lever = 1.0
    if part.joint.type != "prismatic":
        lever = max(TURNING, float(np.linalg.norm(np.cross(part.joint.axis, part.grip - part.joint.origin))))
    travel = abs(beyond - begin) * part.span * lever
    return np.linspace(begin, beyond, max(LEAST_STEPS, int(np.ceil(travel / STEP))) + 1)


def pressure(
    opening: Opening,
    ways: Float[np.ndarray, "N K J"],
    motions: Float[np.ndarray, "N 4 4"],
    body: Body | None = None,
) -> Float[np.ndarray, "K"]:
    """How far (m) the arm would press into something on each of K ways along the part's motion, at worst and
    on average together. The hand may touch the part. The arm is ``body``, with open fingers unless given."""
    body, still = body or opening.body, inverse(opening.T_root_object)
    others = Obstacle(field=opening.others, T_field_root=still)
    carried = Obstacle(field=opening.carried, T_field_root=np.repeat(inverse(motions), ways.shape[1], axis=0))
    q = ways.reshape(-1, ways.shape[2])
    pressed = np.zeros(len(q))
    hand = body.gap <= HAND_GAP
    for mine, near, obstacles in ((~hand, NEAREST, (others, carried)), (hand, NEAREST_HAND, (others,))):
        some = Body(points=body.points[mine], carrier=body.carrier[mine], gap=np.full(int(mine.sum()), near))
        pressed = np.maximum(pressed, -spare_room(opening.chain, some, obstacles, q))
    pressed = pressed.reshape(-1, ways.shape[1])
    return pressed.max(axis=0) + pressed.mean(axis=0)


def way_around(
    opening: Opening, begin: float, q: Float[np.ndarray, "J"], goal: Float[np.ndarray, "J"]
) -> Float[np.ndarray, "N J"]:
    """Waypoints to ``goal`` past everything as it stands, the part at fraction ``begin``; ``goal`` alone if
    there is no such way or the arm starts too near to something."""
    at = opening.motions(np.array([begin]))[0]
    work = Work(
        chain=opening.chain, robot=opening.robot,
        body=replace(opening.body, gap=CLOSE * opening.body.gap),
        obstacles=(
            Obstacle(field=opening.others, T_field_root=inverse(opening.T_root_object)),
            Obstacle(field=opening.carried, T_field_root=inverse(at)),
        ),
    )  # fmt: skip
    way = detour(work, q, goal, seed=0)
    return goal[None] if way is None else way
