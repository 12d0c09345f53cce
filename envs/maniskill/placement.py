"""Places a robot within reach of a handle's whole path and clear of the space that the part sweeps.

Searches positions in front of the part. A candidate's cost depends on the distances and heights of the handle
along its path, and on the clearance of the base from the moving part and the object.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, screw_motion, transform_points

from .objects import TaskObject, TaskPart
from .robots import Reach, RobotSpec

PATH_SAMPLES = 9
AHEAD = np.arange(0.40, 1.31, 0.1)
ASIDE = np.arange(-0.8, 0.81, 0.1)
SIDES = np.array([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
BLOCKED = 50.0
"""Cost per metre of missing clearance around the base; poor reach costs about 1 per metre."""


@dataclass(frozen=True, kw_only=True)
class Stand:
    """A robot's base in the world: metres and radians; ``lift`` is the extension of its torso."""

    x: float
    y: float
    z: float
    yaw: float
    lift: float


def part_motion(part: TaskPart, fractions: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N 4 4"]:
    """Displacement of the part from rest at fractions of its range, in the object frame."""
    q = part.joint.lower + np.asarray(fractions, dtype=np.float64) * part.span
    still = np.zeros_like(q)
    sliding = part.joint.type == "prismatic"
    turn, travel = (still, q) if sliding else (q, still)
    return screw_motion(part.joint.axis, part.joint.origin, turn, travel)


def grip_path(
    entry: TaskObject, part: TaskPart, fractions: Float[np.ndarray, "N"]
) -> Float[np.ndarray, "N 3"]:
    """The grip in the world at fractions of the range, for an object at the origin."""
    points = transform_points(part_motion(part, fractions), part.grip[None, None, :])[:, 0]
    return points - [0.0, 0.0, entry.floor]


def outward(entry: TaskObject, part: TaskPart) -> Float[np.ndarray, "3"]:
    """Horizontal direction in front of the part. A part that slides up or down is reached from the nearest
    side of the object, the front if several are equally near; one that turns up or down, from the front."""
    if part.handle is not None:
        normal = part.handle.normal
    elif part.joint.type == "prismatic":
        normal = part.joint.axis
    else:
        normal = np.cross(part.joint.axis, part.grip - part.joint.origin)
    flat = np.array([normal[0], normal[1], 0.0])
    length = float(np.linalg.norm(flat))
    if length > 0.5:
        return flat / length
    away = np.concatenate([part.grip[:2] - entry.bounds[0, :2], entry.bounds[1, :2] - part.grip[:2]])
    nearest = int(np.round(away, 3).argmin()) if part.joint.type == "prismatic" else 0
    return SIDES[nearest]


def find_stand(
    entry: TaskObject,
    part: TaskPart,
    robot: RobotSpec,
    fractions: Float[np.ndarray, "N"],
    path: Float[np.ndarray, "N 3"],
    reach: Reach,
) -> Stand:
    """The best of a grid of base positions for reaching every point of ``path`` with the gripper.

    The search always returns a position; if none is both near and clear, it prefers clearance.

    Args:
        entry: An object at the origin.
        fractions: Open fractions of the part along the way, for clearance.
        path: Points in the world.
    """
    out = outward(entry, part)
    side = np.array([-out[1], out[0], 0.0])
    ahead, aside, height = (
        values.ravel() for values in np.meshgrid(AHEAD, ASIDE, np.array(robot.heights), indexing="ij")
    )
    base = path[0] * [1.0, 1.0, 0.0] + ahead[:, None] * out + aside[:, None] * side
    base[:, 2] = height
    lift = float(np.clip(path[:, 2].mean() - reach.bands[-1][1] + 0.2, 0.0, robot.lift))
    towards = path.mean(axis=0) - base
    towards[:, 2] = 0.0
    towards /= np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    away = path[None] - base[:, None]
    distance = np.linalg.norm(away[..., :2], axis=2)
    cost = np.square(_outside(distance, reach.near, reach.far)).mean(axis=1)
    bands = [np.square(_outside(away[..., 2] - lift, *band)).mean(axis=1) for band in reach.bands]
    cost += np.min(bands, axis=0)
    cost += 0.002 * np.abs(aside) + 0.001 * height + 0.002 * np.abs(ahead - 0.6)
    gap = free_radius(entry, part, base, robot.column, fractions)
    best = int(np.argmin(cost + BLOCKED * np.clip(robot.clearance - gap, 0.0, None)))
    x, y, z = base[best]
    return Stand(x=x, y=y, z=z, yaw=float(np.arctan2(towards[best, 1], towards[best, 0])), lift=lift)


def free_radius(
    entry: TaskObject,
    part: TaskPart,
    base: Float[np.ndarray, "C 3"],
    column: float,
    fractions: Float[np.ndarray, "N"],
) -> Float[np.ndarray, "C"]:
    """Distance of vertical columns from the boxes of the object and of the moving part, at every fraction.

    Args:
        base: Feet of the columns in the world, on the floor.
        column: Height of the columns above ``base``, metres.
    """
    heights = np.linspace(0.0, 1.0, 4)
    columns = np.repeat(base[:, None, :], len(heights), axis=1)
    columns[:, :, 2] = heights * (base[:, 2:] + column) + entry.floor
    whole = np.stack([[*entry.bounds[0, :2], entry.floor], entry.bounds[1]])  # with its plinth
    gap = _distance(columns, whole).min(axis=1)
    box = np.stack([part.moved.min(axis=0), part.moved.max(axis=0)])
    for T in inverse(part_motion(part, fractions)):
        moved = transform_points(T, columns.reshape(-1, 3)).reshape(columns.shape)
        gap = np.minimum(gap, _distance(moved, box).min(axis=1))
    return gap


def _outside(values: np.ndarray, low: float | np.ndarray, high: float | np.ndarray) -> np.ndarray:
    """Distance of values outside of an interval."""
    return np.maximum(np.maximum(low - values, values - high), 0.0)


def _distance(points: np.ndarray, box: np.ndarray) -> np.ndarray:
    return np.linalg.norm(_outside(points, *box), axis=-1)
