"""Arm angles for many poses at once, and for whole ways of poses."""

import numpy as np
from jaxtyping import Float, Int

from ..robots import RobotSpec
from .chain import Chain, solve

NEAR = 0.012
TURN = 0.12
"""What a pose may be missed by, metres and radians."""
JUMP = 0.5
"""Largest change of a joint from one waypoint to the next, rad."""
STARTS = 6
ENOUGH = 60
KEPT = 24
"""Poses whose whole way is solved; the others are dropped by what they miss at its beginning."""


def starts_of(chain: Chain, robot: RobotSpec, q: Float[np.ndarray, "J"]) -> Float[np.ndarray, "S J"]:
    """Postures from which a search begins: the present one, the ready one, and some spread ones."""
    rng = np.random.default_rng(0)
    low, high = np.clip(chain.lower, -2.5, 2.5), np.clip(chain.upper, -2.5, 2.5)
    return np.concatenate([q[None], robot.ready[None], rng.uniform(low, high, (STARTS, len(q)))])


def reach(
    chain: Chain,
    targets: Float[np.ndarray, "G 4 4"],
    cost: Float[np.ndarray, "G"],
    starts: Float[np.ndarray, "S J"],
) -> tuple[Float[np.ndarray, "K J"], Int[np.ndarray, "K"]]:
    """Arm angles for targets that can be solved, the cheapest first, and which targets they are.

    Starts are tried one after the other until there are enough solutions; the first is where the arm is.
    """
    found, order, score = [], [], []
    for start in starts:
        q, miss, turn = solve(
            chain, targets, np.repeat(start[None], len(targets), axis=0), posture_weight=0.0, iterations=40
        )
        good = np.flatnonzero((miss < NEAR) & (turn < TURN))
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
    """Goes along K ways of N tool poses each.

    Args:
        chain: the arm.
        targets: the poses; ``hold`` solves the first of every way.
        hold: arm angles there.
        turn_weight: metres that a radian of wrong orientation counts; little lets the gripper turn in hand.

    Returns:
        Arm angles, each way's largest miss (m), a jump counting as one, and its largest wrong turn (rad).
    """
    q, way = hold, [hold]
    worst, turned = np.zeros(len(hold)), np.zeros(len(hold))
    for goals in targets[1:]:
        q, miss, turn = solve(chain, goals, q, turn_weight=turn_weight, posture_weight=0.0, iterations=15)
        jump = np.abs(q - way[-1]).max(axis=1)
        worst = np.maximum.reduce([worst, miss, 0.1 * (jump > JUMP)])
        turned = np.maximum(turned, turn)
        way.append(q)
    return np.array(way), worst, turned
