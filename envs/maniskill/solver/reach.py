"""Arm angles for many tool poses at once, and for whole paths of poses."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float, Int

from ..robots import RobotSpec
from .chain import Chain, solve, tool_pose

BACK = 0.10
"""Distance in front of the handle at which the open gripper stops before grasping, metres."""
NEAR = 0.012
TURN = 0.12
"""Largest error of a pose, metres and radians."""
JUMP = 0.5
"""Largest change of a joint between two waypoints, rad."""
STARTS = 6
ENOUGH = 60
KEPT = 24
"""Number of poses whose whole path is solved; the others are dropped by their error at the start."""


def starts_of(chain: Chain, robot: RobotSpec, q: Float[np.ndarray, "J"]) -> Float[np.ndarray, "S J"]:
    """Initial postures of a search: the current one, the ready one, and some spread ones."""
    rng = np.random.default_rng(0)
    low, high = np.clip(chain.lower, -2.5, 2.5), np.clip(chain.upper, -2.5, 2.5)
    return np.concatenate([q[None], robot.ready[None], rng.uniform(low, high, (STARTS, len(q)))])


def reach(
    chain: Chain,
    targets: Float[np.ndarray, "G 4 4"],
    cost: Float[np.ndarray, "G"],
    starts: Float[np.ndarray, "S J"],
    free: Callable[[Float[np.ndarray, "B J"]], Bool[np.ndarray, "B"]] | None = None,
) -> tuple[Float[np.ndarray, "K J"], Int[np.ndarray, "K"]]:
    """Arm angles for solvable targets, the cheapest first, and the indices of these targets.

    Starts are tried in order until there are enough solutions, of which ``free`` must be true, if given; the
    first one is the arm's current posture.
    """
    found, order, score = [], [], []
    for start in starts:
        q, miss, turn = solve(chain, targets, np.repeat(start[None], len(targets), axis=0), iterations=40)
        good = np.flatnonzero((miss < NEAR) & (turn < TURN))
        good = good if free is None else good[free(q[good])]
        found.append(q[good])
        order.append(good)
        score.append(cost[good] + 0.05 * np.abs(q[good] - starts[0]).sum(axis=1))
        if sum(map(len, order)) >= ENOUGH:
            break
    best = np.argsort(np.concatenate(score), kind="stable")[:KEPT]
    return np.concatenate(found)[best], np.concatenate(order)[best]


def follow(
    chain: Chain,
    targets: Float[np.ndarray, "N K 4 4"],
    hold: Float[np.ndarray, "K J"],
    turn_weight: float = 0.1,
) -> tuple[Float[np.ndarray, "N K J"], Float[np.ndarray, "K"], Float[np.ndarray, "K"]]:
    """Follows K paths of N tool poses each.

    Args:
        targets: The poses; ``hold`` solves the first of every path.
        hold: Arm angles at the first poses.
        turn_weight: Cost in metres of a radian of orientation error; a small value lets the gripper rotate.

    Returns:
        Arm angles, the largest position error of each path (m), where a jump counts as 0.1 m, and its largest
        orientation error (rad).
    """
    q, way = hold, [hold]
    worst, turned = np.zeros(len(hold)), np.zeros(len(hold))
    for goals in targets[1:]:
        q, miss, turn = solve(chain, goals, q, turn_weight=turn_weight, iterations=15)
        jump = np.abs(q - way[-1]).max(axis=1)
        worst = np.maximum.reduce([worst, miss, 0.1 * (jump > JUMP)])
        turned = np.maximum(turned, turn)
        way.append(q)
    return np.array(way), worst, turned


def drawn_back(chain: Chain, robot: RobotSpec, q: Float[np.ndarray, "J"]) -> Float[np.ndarray, "J"]:
    """Arm angles with the gripper retracted along its pointing direction."""
    T = tool_pose(chain, q[None])
    T[:, :3, 3] -= BACK * (T[:, :3, :3] @ robot.tool_axes[:, 0])
    return solve(chain, T, q[None], iterations=30)[0][0]
