"""Plans to push a part: closed fingers touch it and follow its path, slightly farther at the end.

For buttons, switches, pedals, lids without handles, and leaves that stand ajar, which are pushed from inside
where an arm cannot turn along with their handle.
"""

from dataclasses import replace
from functools import partial

import numpy as np
from jaxtyping import Bool, Float

from ..objects import TaskPart
from .body import HAND_GAP, is_free
from .contacts import Contacts, push_contacts
from .opening import Opening, least_pressing, way_around
from .plan_open import NoPlan, OpenPlan
from .reach import NEAR, drawn_back, follow, reach, starts_of

OFF = 0.02
"""Distance from the surface at which the approach ends, metres."""
FAR = 0.07
"""Distance by which the fingers are retracted before the approach, metres."""
SAMPLES = 3
ENTERED = 0.002
"""Clearance of the arm on that way, metres; the field is accurate to about a cell."""
THROUGH = 0.008
"""Distance by which the fingers aim beyond the part's own path, metres, because they have to press."""
YIELD = 8e-4
"""Compliance of the arm, metres per newton: about 10 mm at 19 N, with some margin."""
EXACT = 0.006
"""Largest error of the touched point, metres: a button is small."""
LOOSE = 0.02
MOST_TURN = 1.3


def _through(part: TaskPart, poses: Float[np.ndarray, "K 4 4"]) -> Float[np.ndarray, "K 1"]:
    """Distance by which the fingers aim beyond the part, metres: more against a spring."""
    lever = np.ones(len(poses))
    if part.joint.type != "prismatic":
        lever = np.linalg.norm(np.cross(part.joint.axis, poses[:, :3, 3] - part.joint.origin), axis=1)
    return (THROUGH + YIELD * 2.0 * max(0.0, part.joint.spring) / np.maximum(lever, 0.02))[:, None]


def _enters(
    opening: Opening, entry: Float[np.ndarray, "3 K J"], at: Float[np.ndarray, "4 4"]
) -> Bool[np.ndarray, "K"]:
    """Whether each approach to the surface is collision-free."""
    ways = np.linspace(entry[1:-1], entry[2:], SAMPLES).reshape(-1, entry.shape[2])
    body = replace(opening.closed, gap=np.full(len(opening.closed.gap), ENTERED))
    free = is_free(opening.chain, body, opening.obstacles(at), ways)
    return np.asarray(free.reshape(SAMPLES, -1).all(axis=0))


def _is_arm_free(
    opening: Opening, at: Float[np.ndarray, "4 4"], q: Float[np.ndarray, "B J"]
) -> Bool[np.ndarray, "B"]:
    """Whether all links but the hand are collision-free."""
    arm = opening.closed.some(opening.closed.gap > HAND_GAP, ENTERED)
    return is_free(opening.chain, arm, opening.obstacles(at), q)


def push_places(opening: Opening, begin: float, sign: float) -> Contacts:
    """Places at which to push a part at fraction ``begin`` of its range, open (``sign`` 1) or closed (-1).

    Raises:
        NoPlan: If a latch holds the part, or there is no such place.
    """
    name = opening.part.joint.name
    if opening.is_latched(begin):
        raise NoPlan(f"joint {name!r}: its latch holds it")
    found = push_contacts(opening, begin, sign)
    if not len(found.poses):
        raise NoPlan(f"joint {name!r}: nothing to push at has room for the fingers")
    return found


def plan_touch(
    opening: Opening, found: Contacts, q: Float[np.ndarray, "J"], begin: float, end: float, *, skip: int = 0
) -> OpenPlan:
    """A plan that pushes a part from fraction ``begin`` of its range to ``end``, at one of the places
    ``found`` by `push_places`; other arguments as `plan_open`.

    Raises:
        NoPlan: If there is no place that the arm can follow.
    """
    chain, robot, name = opening.chain, opening.robot, opening.part.joint.name
    motions = opening.way(begin, end).carried
    free = partial(_is_arm_free, opening, motions[0])
    hold, order = reach(chain, motions[0] @ found.poses, found.cost, starts_of(chain, robot, q), free)
    if not len(order):
        raise NoPlan(f"joint {name!r}: nothing to push at is in reach")
    poses, normals = found.poses[order], found.normals[order]
    targets = motions[:, None] @ poses[None]
    targets[-1, :, :3, 3] -= _through(opening.part, poses) * normals @ motions[-1, :3, :3].T
    path, missed, turned = follow(chain, targets, hold, turn_weight=LOOSE)
    # From the surface back to the start of the fingers: off it, then back along themselves.
    back = np.repeat(targets[:1], 3, axis=0)
    off = OFF * normals @ motions[0, :3, :3].T
    point = np.einsum("kij,j->ki", targets[0, :, :3, :3], robot.tool_axes[:, 0])
    back[1, :, :3, 3] += off
    back[2, :, :3, 3] += off - FAR * point
    entry, lost, _ = follow(chain, back, hold, turn_weight=LOOSE)
    total = found.cost[order] + 20.0 * missed + 5.0 * lost + 0.3 * turned
    good = np.flatnonzero((missed < EXACT) & (turned < MOST_TURN) & (lost < 3.0 * NEAR))
    good = good[_enters(opening, entry[:, good], motions[0])]
    if len(good) <= skip:
        raise NoPlan(
            f"joint {name!r}: {len(good)} ways to push it along its path, the best misses by "
            f"{1e3 * missed.min():.0f} mm"
        )
    best, pressed = least_pressing(opening, path, motions, total, good, skip=skip, body=opening.closed)
    return OpenPlan(
        before=way_around(opening, begin, q, entry[-1, best]),
        approach=entry[-2::-1, best],
        path=path[1:, best],
        leave=drawn_back(chain, robot, path[-1, best])[None],
        width=0.0,
        pressed=pressed,
    )
