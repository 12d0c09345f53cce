"""An arm in front of a part that it is to move: what stands still, and what moves along."""

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


@dataclass(frozen=True, kw_only=True, eq=False)
class Opening:
    """An arm, the part, and the solids: ``others`` in the object frame, ``carried`` (the part and what it
    carries) in the object frame with the part closed."""

    chain: Chain
    robot: RobotSpec
    body: Body
    part: TaskPart
    T_root_object: Float[np.ndarray, "4 4"]
    others: Field
    carried: Field

    def motions(self, fractions: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N 4 4"]:
        """Poses of the closed part's frame in the root's, at fractions of its range."""
        return self.T_root_object @ part_motion(self.part, fractions)


def pressure(
    opening: Opening, ways: Float[np.ndarray, "N K J"], motions: Float[np.ndarray, "N 4 4"]
) -> Float[np.ndarray, "K"]:
    """How far (m) the arm would press into something on each of K ways along the part's motion, at worst and
    on average together. The hand may touch the part."""
    body, still = opening.body, inverse(opening.T_root_object)
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
