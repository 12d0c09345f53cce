"""Finds the base from which a robot can best put something down, from many arm postures.

Every sampled posture fixes a base once its hand is to be at a given place and to point in a given
direction. Those in which the arm touches nothing, with the base clear of everything, are compared by how much
room they have.
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
"""How far below the horizontal the hand may point into a compartment and into a drawer, rad."""
DISTANCES = (0.40, 0.80)
"""Of the hand from the base, metres: not so near that the arm is folded, not so far that it is straight."""
HEIGHTS = (-0.45, 0.85)
"""Of the hand above the base, metres."""
MIDDLE = 0.92
"""Part of each joint's range that is used: the base stands a little off its place, and the hand moves on."""
IN_TURNS = np.radians([0.0, 20.0, -20.0, 40.0, -40.0])
DOWN_TURNS = np.radians(np.arange(-75.0, 76.0, 15.0))
"""Turns of the hand about the vertical, from where the room faces."""
COLUMN = (0.12, 0.45)
"""Radius and height of the robot's own base, which its forearm and hand keep off, metres."""
ENOUGH = 0.06
"""More room than this is not better, metres."""
TURNED = 8
"""How often each posture is tried, with a turn and a place drawn at random."""
ASKEW = 0.01
"""Metres of room that a radian is worth by which the hand works askew, or the robot faces away from it."""
MOST = 4000
"""Bases that are compared by the room around the arm."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Postures:
    """Arm postures with the first joint at 0 and fingers that close horizontally, by what matters of them.

    ``tool`` is the hand's place in the root's frame, ``heading`` and ``slope`` where it points (rad),
    ``points`` the arm's surface and ``gap`` what each point keeps away from everything.
    """

    tool: Float[np.ndarray, "N 3"]
    heading: Float[np.ndarray, "N"]
    slope: Float[np.ndarray, "N"]
    points: Float[np.ndarray, "N P 3"]
    gap: Float[np.ndarray, "P"]


def sample_postures(chain: Chain, body: Body, robot: RobotSpec) -> Postures:
    """Random postures within the limits, those with the hand at a useful place and slope."""
    rng = np.random.default_rng(SEED)
    low, high = np.maximum(chain.lower, -np.pi), np.minimum(chain.upper, np.pi)
    middle, half = (low + high) / 2.0, MIDDLE * (high - low) / 2.0
    q = middle + rng.uniform(-half, half, (SAMPLES, len(low)))
    q[:, 0], q[:, -1] = 0.0, 0.0
    T = tool_pose(chain, q)
    point, close = (T[:, :3, :3] @ robot.tool_axes[:, k] for k in (0, 1))
    third = np.cross(point, close)
    # The last joint turns about the direction in which the hand points: level the fingers.
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
    """Where a hand is to be (world, metres), one of several places, and the horizontal direction in which it
    works; ``down`` if it comes from above, into a drawer."""

    places: Float[np.ndarray, "A 3"]
    inwards: Float[np.ndarray, "3"]
    down: bool


def find_putting_stand(
    entry: TaskObject, part: TaskPart, robot: RobotSpec, *, postures: Postures, field: Field,
    opened: float, goal: Goal,
) -> Stand | None:  # fmt: skip
    """The base from which a hand comes to its place with the most room around the arm.

    Args:
        entry: an object that stands at the origin.
        part: its open part.
        robot: what is to stand.
        postures: of its arm.
        field: everything solid, in the object frame.
        opened: how far the part is open.
        goal: of the hand.

    Returns:
        ``None`` if no sampled posture is free of everything.
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
    points = _turned(postures.points[which[keep]], yaw[keep]) + (base[keep] + _up(lift[keep]))[:, None]
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
    """Points after a turn about the vertical, each row by its own."""
    extra = (1,) * (points.ndim - 2)
    cosine, sine = np.cos(yaw).reshape(-1, *extra), np.sin(yaw).reshape(-1, *extra)
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=-1)


def _up(heights: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N 3"]:
    return np.stack([np.zeros_like(heights), np.zeros_like(heights), heights], axis=1)
