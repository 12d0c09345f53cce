"""Finds the base position from which a robot can best place an object, from many sampled arm postures.

Every sampled posture determines a base position for a given place and direction of the hand. Collision-free
postures with a clear base are compared by clearance.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from .objects import TaskObject, TaskPart
from .placement import Stand, free_radius
from .robots import RobotSpec
from .solver.body import Body, body_points
from .solver.chain import Chain, tool_pose
from .solver.field import Field, distances

SAMPLES = 40_000
SEED = 0
IN_SLOPES = (-0.1, 0.85)
DOWN_SLOPES = (0.9, 1.58)
"""Range of the hand's slope below the horizontal, into a compartment and into a drawer, rad."""
DISTANCES = (0.40, 0.80)
"""Range of the hand's distance from the base, metres: neither folded nor fully stretched."""
HEIGHTS = (-0.45, 0.85)
"""Range of the hand's height above the base, metres."""
MIDDLE = 0.92
"""Share of each joint's range that is used, because the base position is noisy and the hand moves on."""
IN_TURNS = np.radians([0.0, 20.0, -20.0, 40.0, -40.0])
DOWN_TURNS = np.radians(np.arange(-75.0, 76.0, 15.0))
"""Rotations of the hand about the vertical, relative to the direction into the space."""
COLUMN = (0.12, 0.45)
"""Radius and height of the robot's base, which its forearm and hand must avoid, metres."""
ENOUGH = 0.06
"""Clearance above which more is no better, metres."""
TURNED = 8
"""Random rotations and places per posture."""
ASKEW = 0.01
"""Clearance (m) that a radian of misalignment of the hand, or of the robot, costs."""
MOST = 4000
"""Largest number of bases whose clearance around the arm is compared."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Postures:
    """Arm postures with the first joint at 0 and fingers that close horizontally.

    ``tool`` is the hand's position in the root's frame, ``heading`` and ``slope`` its direction (rad),
    ``points`` the arm's surface and ``gap`` the clearance that each point needs.
    """

    tool: Float[np.ndarray, "N 3"]
    heading: Float[np.ndarray, "N"]
    slope: Float[np.ndarray, "N"]
    points: Float[np.ndarray, "N P 3"]
    gap: Float[np.ndarray, "P"]


def sample_postures(chain: Chain, body: Body, robot: RobotSpec) -> Postures:
    """Random postures within the limits with the hand at a useful position and slope."""
    rng = np.random.default_rng(SEED)
    low, high = np.maximum(chain.lower, -np.pi), np.minimum(chain.upper, np.pi)
    middle, half = (low + high) / 2.0, MIDDLE * (high - low) / 2.0
    q = middle + rng.uniform(-half, half, (SAMPLES, len(low)))
    q[:, 0], q[:, -1] = 0.0, 0.0
    T = tool_pose(chain, q)
    point, close = (T[:, :3, :3] @ robot.tool_axes[:, k] for k in (0, 1))
    third = np.cross(point, close)
    # The last joint turns about the direction of the hand and levels the fingers.
    roll = np.arctan2(-close[:, 2], third[:, 2])
    q[:, -1] = (roll + np.pi / 2.0) % np.pi - np.pi / 2.0
    T = tool_pose(chain, q)
    point, close = (T[:, :3, :3] @ robot.tool_axes[:, k] for k in (0, 1))
    slope = -np.arcsin(np.clip(point[:, 2], -1.0, 1.0))
    away, height = np.linalg.norm(T[:, :2, 3], axis=1), T[:, 2, 3]
    good = (np.abs(close[:, 2]) < 0.02) & (slope > IN_SLOPES[0]) & (away > DISTANCES[0])
    good &= (away < DISTANCES[1]) & (height > HEIGHTS[0]) & (height < HEIGHTS[1])
    good &= (q[:, -1] > chain.lower[-1]) & (q[:, -1] < chain.upper[-1])
    points = body_points(chain, body, q[good])
    outer = points[:, body.carrier >= 3]
    own = (np.linalg.norm(outer[..., :2], axis=-1) < COLUMN[0]) & (outer[..., 2] < COLUMN[1])
    kept = np.flatnonzero(good)[~own.any(axis=1)]
    return Postures(
        tool=T[kept, :3, 3],
        heading=np.arctan2(point[kept, 1], point[kept, 0]),
        slope=slope[kept],
        points=points[~own.any(axis=1)],
        gap=body.gap,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Goal:
    """Goal of a hand: alternative positions (world, metres), and the horizontal working direction; ``down``
    if it enters from above, into a drawer."""

    places: Float[np.ndarray, "A 3"]
    inwards: Float[np.ndarray, "3"]
    down: bool


def find_putting_stand(
    entry: TaskObject, part: TaskPart, robot: RobotSpec, *, postures: Postures, field: Field,
    opened: float, goal: Goal,
) -> Stand | None:  # fmt: skip
    """The base from which a hand reaches its goal with the most clearance around the arm.

    Args:
        field: Distances to all solids, in the object frame.

    Returns:
        ``None`` if every sampled posture collides.
    """
    low, high = DOWN_SLOPES if goal.down else IN_SLOPES
    mine = np.flatnonzero((postures.slope >= low) & (postures.slope <= high))
    turns = DOWN_TURNS if goal.down else IN_TURNS
    rng = np.random.default_rng(SEED)
    which = np.repeat(mine, TURNED)
    turn = rng.choice(turns, len(which))
    place = goal.places[rng.integers(len(goal.places), size=len(which))]
    yaw = np.arctan2(goal.inwards[1], goal.inwards[0]) + turn - postures.heading[which]
    yaw = (yaw + np.pi) % (2.0 * np.pi) - np.pi
    base = place - _turned(postures.tool[which], yaw)
    lift = base[:, 2].copy() if robot.lift > 0.0 else np.zeros(len(base))
    base[:, 2] -= lift
    tallest = max(robot.heights)
    allowed = (lift >= 0.0) & (lift <= robot.lift) & (base[:, 2] >= 0.0) & (base[:, 2] <= tallest + 1e-9)
    ahead = (base - place) @ goal.inwards < 0.0
    keep = np.flatnonzero(allowed & ahead)
    keep = keep[free_radius(entry, part, base[keep], robot.column, np.array([opened])) > robot.clearance]
    if len(keep) > MOST:
        keep = rng.choice(keep, MOST, replace=False)
    if not len(keep):
        return None
    raised = base[keep]
    raised[:, 2] += lift[keep]
    points = _turned(postures.points[which[keep]], yaw[keep]) + raised[:, None]
    up = np.array([0.0, 0.0, entry.floor])
    solid = np.minimum(distances(field, points + up), points[..., 2])
    room = (solid - postures.gap).min(axis=1)
    bearing = np.arctan2(postures.tool[which[keep], 1], postures.tool[which[keep], 0])
    score = np.minimum(room, ENOUGH) - ASKEW * (np.abs(turn[keep]) + np.abs(bearing))
    best = int(score.argmax())
    if room[best] < 0.0:
        return None
    x, y, z = base[keep[best]]
    return Stand(x=float(x), y=float(y), z=float(z), yaw=float(yaw[keep[best]]), lift=float(lift[keep[best]]))


def _turned(points: Float[np.ndarray, "N *P 3"], yaw: Float[np.ndarray, "N"]) -> np.ndarray:
    """Rotates points about the vertical, each row by its own angle."""
    extra = (1,) * (points.ndim - 2)
    cosine, sine = np.cos(yaw).reshape(-1, *extra), np.sin(yaw).reshape(-1, *extra)
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=-1)
