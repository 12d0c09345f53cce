"""An arm among obstacles, the common state of all collision-aware plans."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from ..robots import RobotSpec
from .body import Body, Obstacle, is_free
from .chain import Chain, solve
from .detour import find_detour
from .reach import follow, starts_of

EXACT = 0.004
"""Largest pose error among obstacles, metres."""
TURN = 0.1
PROMISING = 0.25
"""Remaining error, metres or rad, below which iterations continue."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Work:
    """A robot's arm in the frame of its root, its surface, and the solids around it."""

    chain: Chain
    robot: RobotSpec
    body: Body
    obstacles: tuple[Obstacle, ...]

    def free(self, q: Float[np.ndarray, "B J"]) -> Bool[np.ndarray, "B"]:
        """Whether each arm pose is collision-free."""
        return is_free(self.chain, self.body, self.obstacles, q)


def free_poses(
    work: Work, targets: Float[np.ndarray, "G 4 4"], q: Float[np.ndarray, "J"], most: int
) -> tuple[Float[np.ndarray, "K J"], np.ndarray]:
    """Collision-free arm angles that reach targets, and the indices of these targets.

    Args:
        targets: Tool poses in the root's frame.
        q: Current arm angles; nearby solutions come first.
        most: Largest number of solutions.
    """
    found, which = [], []
    for start in starts_of(work.chain, work.robot, q):
        solved, good = _solved(work.chain, targets, start)
        free = work.free(solved[good])
        found.append(solved[good[free]])
        which.append(good[free])
        if sum(map(len, which)) >= 2 * most:
            break
    solutions, order = np.concatenate(found), np.concatenate(which)
    _, first = np.unique(np.c_[order, np.round(solutions, 1)], axis=0, return_index=True)
    near = first[np.argsort(np.abs(solutions[first] - q).max(axis=1), kind="stable")][:most]
    return solutions[near], order[near]


def _solved(
    chain: Chain, targets: Float[np.ndarray, "G 4 4"], start: Float[np.ndarray, "J"]
) -> tuple[Float[np.ndarray, "G J"], Int[np.ndarray, "S"]]:
    """Arm angles found from one start, and the indices of the exact ones; hopeless targets are abandoned
    early."""
    q, miss, turn = solve(chain, targets, np.repeat(start[None], len(targets), axis=0), iterations=15)
    near = np.flatnonzero((miss < PROMISING) & (turn < PROMISING))
    q[near], miss, turn = solve(chain, targets[near], q[near], iterations=20)
    return q, near[(miss < EXACT) & (turn < TURN)]


def free_ways(
    work: Work, targets: Float[np.ndarray, "N K 4 4"], hold: Float[np.ndarray, "K J"]
) -> tuple[Float[np.ndarray, "N K J"], Bool[np.ndarray, "K"]]:
    """Follows K paths of tool poses; ``hold`` solves the first of each.

    Returns:
        Arm angles, and which paths are exact, continuous and collision-free.
    """
    ways, missed, turned = follow(work.chain, targets, hold, turn_weight=0.3)
    good = (missed < EXACT) & (turned < TURN)
    for q in ways[1:]:
        good[good] = work.free(q[good])
    return ways, good


def detour(
    work: Work, begin: Float[np.ndarray, "J"], end: Float[np.ndarray, "J"]
) -> Float[np.ndarray, "N J"] | None:
    """Waypoints from one arm pose to another around obstacles, the first excluded; ``None`` if none was
    found."""
    way = find_detour(work.chain, work.free, begin, end)
    return None if way is None else way[1:]
