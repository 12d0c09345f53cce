"""A plan for carrying a cube from its stand to a place on a floor: pick, lift, bring, let go, draw back.

The gripper keeps its slope from the pick to the place, so that the cube stays level.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.errors import ArtigenError

from ..robots import RobotSpec
from .chain import Chain, solve
from .reach import NEAR, TURN, starts_of

SLOPES_DOWN = np.radians([90.0, 75.0, 60.0, 45.0])
SLOPES_IN = np.radians([0.0, 25.0, 45.0, 65.0, 90.0])
"""How steeply the gripper points down, the favourite first: a hand that points into a compartment keeps off
its floor and its roof."""
SIDEWAYS = np.radians([0.0, 30.0, -30.0, 60.0, -60.0, 90.0, -90.0])
"""Turns about the vertical, from where the robot (at the pick) or the room (at the place) faces."""
PICK = ((0.18, 0.02), (0.08, 0.005), (0.0, 0.005), (0.0, 0.06), (0.0, 0.12))
"""Stages of the pick: distance behind the cube, along the gripper, and height above its middle, metres."""
PICKED = 3
DRAW_BACK = 0.12
DROP = 0.008
"""How far above the floor the cube is let go, metres."""
INTO = 0.30
"""How far in front of its place in a compartment the cube begins to be pushed in, metres."""
STEP = 0.03


class NoPutPlan(ArtigenError):
    """The cube cannot be reached, or not be brought to its place."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PutPlan:
    """Arm angles (rad) of the waypoints of each stage, in order."""

    pick: Float[np.ndarray, "N J"]
    lift: Float[np.ndarray, "N J"]
    place: Float[np.ndarray, "N J"]
    leave: Float[np.ndarray, "N J"]


def plan_put(
    chain: Chain,
    robot: RobotSpec,
    T_root_cube: Float[np.ndarray, "4 4"],
    aim: Float[np.ndarray, "3"],
    entry: Float[np.ndarray, "3"],
    q: Float[np.ndarray, "J"],
    clear: float,
) -> PutPlan:
    """A plan for one cube.

    Args:
        chain: the arm, in the frame of the robot's root.
        robot: its gripper.
        T_root_cube: the cube, upright.
        aim: where its middle is to come, root frame.
        entry: the direction from which a hand comes there.
        q: arm angles now.
        clear: height above the aim that is above every rim, metres.

    Raises:
        NoPutPlan: if no slope of the gripper works at both places.
    """
    down = entry[2] < -0.5
    best: PutPlan | None = None
    least = np.inf
    for rank, slope in enumerate(SLOPES_DOWN if down else SLOPES_IN):
        pick = _pick_ways(T_root_cube, slope, robot)
        place = _place_ways(aim, entry, slope, robot, clear, down=down)
        first, bad_first = _solve_ways(chain, pick, starts_of(chain, robot, q))
        second, bad_second = _solve_ways(
            chain, place, np.concatenate([first[-1, :4], starts_of(chain, robot, q)])
        )
        if not len(first[0]) or not len(second[0]):
            continue
        far = np.abs(first[-1][:, None] - second[0][None]).max(axis=2)
        cost = bad_first[:, None] + bad_second[None] + 0.2 * far + 0.3 * rank
        i, j = np.unravel_index(int(cost.argmin()), cost.shape)
        if cost[i, j] < least:
            least = float(cost[i, j])
            count = len(place) - 3
            best = PutPlan(
                pick=first[:PICKED, i],
                lift=first[PICKED:, i],
                place=second[:count, j],
                leave=second[count:, j],
            )
    if best is None:
        raise NoPutPlan("no slope of the gripper reaches both the cube and its place within 12 mm")
    return best


def _pick_ways(T_root_cube: np.ndarray, slope: float, robot: RobotSpec) -> np.ndarray:
    """Tool poses ``[stage, way, 4, 4]``: behind the cube, near it, at it, lifted."""
    ways = []
    facing = np.arctan2(T_root_cube[1, 3], T_root_cube[0, 3])
    yaw = np.arctan2(T_root_cube[1, 0], T_root_cube[0, 0])
    for turn in (0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi):
        heading = yaw + turn
        if slope < 1.5 and np.cos(heading - facing) < 0.2:
            continue
        R, point = _gripper(heading, slope, robot)
        middle = T_root_cube[:3, 3]
        ways.append(_poses(R, [middle - d * point + np.array([0.0, 0.0, z]) for d, z in PICK]))
    return np.stack(ways, axis=1)


def _place_ways(
    aim: np.ndarray, entry: np.ndarray, slope: float, robot: RobotSpec, clear: float, *, down: bool
) -> np.ndarray:
    """Tool poses ``[stage, way, 4, 4]``: the way in, at the place, and out again in three."""
    ways = []
    facing = np.arctan2(aim[1], aim[0]) if down else np.arctan2(entry[1], entry[0])
    middle = aim + np.array([0.0, 0.0, DROP])
    for turn in SIDEWAYS if down else SIDEWAYS[:3]:
        R, point = _gripper(facing + turn, slope, robot)
        if down:
            heights = np.linspace(clear, 0.0, max(3, int(np.ceil(clear / STEP))))
            way = [middle + np.array([0.0, 0.0, z]) for z in heights]
            out = [middle - d * point for d in (0.04, 0.08)] + [middle - 0.08 * point + [0.0, 0.0, clear]]
        else:
            lengths = np.linspace(INTO, 0.0, int(np.ceil(INTO / STEP)) + 1)
            way = [middle - s * entry + [0.0, 0.0, 0.03 * min(1.0, s / 0.05)] for s in lengths]
            out = [middle - d * entry + [0.0, 0.0, 0.3 * d] for d in (0.05, DRAW_BACK, INTO)]
        ways.append(_poses(R, way + out))
    return np.stack(ways, axis=1)


def _gripper(heading: float, slope: float, robot: RobotSpec) -> tuple[np.ndarray, np.ndarray]:
    """Tool rotation and pointing direction for a heading and a slope; fingers close horizontally."""
    point = np.array([np.cos(slope) * np.cos(heading), np.cos(slope) * np.sin(heading), -np.sin(slope)])
    close = np.array([-np.sin(heading), np.cos(heading), 0.0])
    axes = np.stack([point, close, np.cross(point, close)], axis=1)
    return axes @ robot.tool_axes.T, point


def _poses(R: np.ndarray, points: list[np.ndarray]) -> np.ndarray:
    T = np.tile(np.eye(4), (len(points), 1, 1))
    T[:, :3, :3], T[:, :3, 3] = R, points
    return T


def _solve_ways(chain: Chain, ways: np.ndarray, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Arm angles ``[stage, K, J]`` of the ways that can be gone to their end, and their costs."""
    count = ways.shape[1]
    q = np.repeat(starts, count, axis=0)
    goals = np.tile(ways, (1, len(starts), 1, 1))
    out, ok, change = [], np.ones(len(q), dtype=bool), np.zeros(len(q))
    for stage, targets in enumerate(goals):
        solved, miss, turn = solve(chain, targets, q, posture_weight=0.0, iterations=50 if stage == 0 else 15)
        if stage:
            ok &= np.abs(solved - q).max(axis=1) < 0.7
            change += np.abs(solved - q).max(axis=1)
        ok &= (miss < NEAR) & (turn < TURN)
        q = solved
        out.append(q)
    cost = change + 0.1 * np.abs(out[0] - starts[0]).max(axis=1)
    return np.array(out)[:, ok], cost[ok]
