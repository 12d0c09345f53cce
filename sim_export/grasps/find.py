"""Finds grasps: antipodal pairs, all directions of approach, room for the gripper along the whole motion.

The gripper opens to a little more than the width, comes along its direction of approach, closes, and then
moves rigidly with the link; it neither slides nor turns about what it holds. Where it finds no room along the
whole range of a joint, it opens it in strokes, each as long as it can: after each it lets go and grasps anew.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from jaxtyping import Float, Int

from sim_export.package import PROVEN, WHOLE, Grasp, SimPackage

from .carry import Way
from .gripper import Gripper
from .poses import Hands, close_on, nearby
from .score import score_hands, spread_poses
from .targets import Target, find_targets

ENOUGH = 3
"""Grasps of a stroke that shall be proven."""
CHOICES = (6, 3, 2, 1)
"""Different grasps from which each stroke may choose; the first number that all strokes have."""
FINE = 2
"""Times as many pairs of contacts in a finer search."""
SEEDS = 24
"""Hands near which more are tried."""
ROUNDS = 3
"""Times that poses nearby are tried."""
SHORTEST = 0.08
"""Least share of a joint's range that a stroke must open beyond the one before."""
BACK = (0.0, 0.03, 0.06)
"""Shares of the range by which a stroke may begin before the place to which the one before is proven to come,
where there is too little room."""
KEPT = 12


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """Grasps of one target for one stroke, the best first; without any, ``reason`` says why. ``stroke`` are
    the shares of the joint's range at which the gripper takes hold and lets go."""

    target: Target
    grasps: tuple[Grasp, ...]
    reason: str = ""
    stroke: tuple[float, float] = WHOLE


def find_grasps(package: SimPackage, gripper: Gripper) -> tuple[Found, ...]:
    """Grasps of every handle, of moving parts without one, or of an object in which nothing moves.

    One entry for each stroke of each of them; most take a single stroke.
    """
    return tuple(found for target in find_targets(package) for found in find_on(package, target, gripper))


def find_on(package: SimPackage, target: Target, gripper: Gripper) -> tuple[Found, ...]:
    """Grasps of one target, for each of the strokes in which the gripper opens its joint.

    A handle without `ENOUGH` for its whole range is searched more finely, for strokes, each of which has as
    many of `CHOICES` as every one can have. What is no handle is opened in one stroke.
    """
    way = Way(package=package, target=target, gripper=gripper)
    reason, thorough = "", (FINE, ROUNDS, CHOICES, SHORTEST)
    searches = ((1, 0, (ENOUGH,), 1.0), thorough) if target.region is not None else ((1, 0, CHOICES, 1.0),)
    for fine, rounds, choices, shortest in searches:
        hands = close_on(package, target, gripper, fine)
        if hands.reason:
            return (Found(target=target, grasps=(), reason=hands.reason),)
        room = cache(partial(_find_room, way, hands, rounds))
        for least in choices:
            found = _open(way, room, least, shortest)
            if found:
                return found
        count = len(room(0.0)[0])
        reason = f"the gripper meets something as it opens, in all of {count} poses"
        if not count:
            reason = f"the gripper has no room in any of {len(hands)} poses"
    return (Found(target=target, grasps=(), reason=reason),)


def _open(
    way: Way, room: Callable[[float], tuple[Hands, Float[np.ndarray, "G"]]], least: int, shortest: float
) -> tuple[Found, ...]:
    """Grasps of every stroke, with ``least`` or more to choose from; none if a stroke has fewer, or does not
    open the ``shortest`` share of the range beyond the one before."""
    found, begin, end = [], 0.0, 0.0
    while end < 1.0:
        for back in BACK if found else BACK[:1]:
            hands, ends = room(begin - back)
            kept, farthest = _take_farthest(hands, ends, least)
            if farthest >= min(1.0, end + shortest):
                break
        else:
            return ()
        begin, end = begin - back, farthest
        found.append(_grasps(way, hands.some(kept), (begin, end)))
        begin += PROVEN * (end - begin)
    return tuple(found)


def _find_room(way: Way, hands: Hands, rounds: int, begin: float) -> tuple[Hands, Float[np.ndarray, "G"]]:
    """Hands that can take hold of a target as a stroke begins, and to which share of the range they can open
    its joint. Where too few of them come to the end, poses nearby are tried in some ``rounds``."""
    here = way.arrive(hands, begin)
    ends = way.reach(here, begin)
    for _ in range(rounds):
        if _take_farthest(here, ends, CHOICES[0])[1] == 1.0:
            break
        near = here.some(np.argsort(-ends, kind="stable")) if len(here) else hands
        seeds = near.some(spread_poses(near.T, SEEDS))
        more = way.arrive(nearby(seeds, way.target, way.gripper, way.own), begin)
        here, ends = here.join(more), np.concatenate([ends, way.reach(more, begin)])
    return here, ends


def _take_farthest(
    hands: Hands, ends: Float[np.ndarray, "G"], least: int
) -> tuple[Int[np.ndarray, "K"], float]:
    """Indices of the hands that come farthest, as far as ``least`` different ones do, and how far."""
    for end in np.unique(ends)[::-1]:
        rows = np.flatnonzero(ends >= end)
        if len(spread_poses(hands.T[rows], least, least)) == least:
            return rows, float(end)
    return np.zeros(0, dtype=np.int64), -1.0


def _grasps(way: Way, hands: Hands, stroke: tuple[float, float]) -> Found:
    """The best of some hands."""
    target = way.target
    score = score_hands(way, hands, stroke[0])
    order = np.argsort(-score, kind="stable")
    kept = order[spread_poses(hands.T[order], KEPT, CHOICES[0])]
    joint = "" if target.joint is None else target.joint.name
    grasps = tuple(
        Grasp(
            link=target.link, part=target.part, joint=joint, gripper=way.gripper.name, stroke=stroke,
            pose=hands.T[row], width=float(hands.width[row]), score=float(score[row]),
        )
        for row in kept
    )  # fmt: skip
    return Found(target=target, grasps=grasps, stroke=stroke)
