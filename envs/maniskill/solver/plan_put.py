"""Plans to carry a cube from its stand to a place on a floor: pick, lift, bring, release, retreat.

Purely geometric. Poses and the straight segments at both ends are found by inverse kinematics and checked for
collisions; between them the arm moves around obstacles.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.errors import ArtigenError
from artigen.transforms import inverse
from sim_export.geometry.hulls import box_hull

from ..robots import RobotSpec
from .body import Obstacle, holding
from .field import build_field
from .work import Work, detour, free_poses, free_ways

SLOPES = np.radians([0.0, 15.0, 30.0, 45.0, 65.0, 90.0])
"""Downward slopes of the gripper."""
FLAT, STEEP = 0, len(SLOPES) - 1
HEADINGS = np.radians([0.0, 20.0, -20.0, 45.0, -45.0, 90.0, -90.0])
"""Rotations of the hand about the vertical, relative to the direction into the space."""
UP = np.array([0.0, 0.0, 1.0])
BEHIND = (0.03, 0.08, 0.14)
"""Approach distances behind the cube, along the gripper, metres."""
LIFT = (0.04, 0.09)
"""Heights by which the cube is lifted straight up, metres."""
INTO = (0.03, 0.06, 0.10, 0.14, 0.18)
"""Lengths of the straight approach of the cube to its place, metres."""
RISE = 0.1
"""Slope of the approach into a compartment: it descends slightly."""
HIGHER = 0.006
"""Height above the cube's centre at which the fingers close, metres."""
DROPS = (0.02, 0.06, 0.12)
"""Heights above the floor at which the cube is released, metres; more than the first only into drawers that
are too deep for the hand."""
LEAST_DOWN = 0.5
"""Smallest slope of a hand that reaches into a drawer, rad."""
GAP_SHARES = (1.0, 0.4)
"""Shares of the clearances to keep: all, or, if that leaves no path, just enough to avoid contact."""
KEPT = 48
PAIRS = 8
"""Pairs of a pick and a place for which a path is searched."""
CUBE_GAP = 0.003
"""Clearance of the cube, metres: it is released just above a floor."""


class NoPutPlan(ArtigenError):
    """The cube is out of reach, or cannot be brought to its place."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PutPlan:
    """Arm angles (rad) of the waypoints of each stage, in order."""

    pick: Float[np.ndarray, "N J"]
    lift: Float[np.ndarray, "N J"]
    place: Float[np.ndarray, "N J"]
    leave: Float[np.ndarray, "N J"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Ways:
    """Paths of one kind ``[N, K, J]``, the first pose at the cube's place; slope and cost of each."""

    q: np.ndarray
    slope: np.ndarray
    cost: np.ndarray


@dataclass(frozen=True, kw_only=True, eq=False)
class _Wanted:
    """Paths of tool poses; each of the groups ``[W, N, 4, 4]`` starts from the same W first poses."""

    ways: tuple[np.ndarray, ...]
    slope: np.ndarray
    cost: np.ndarray


def plan_put(
    work: Work,
    q: Float[np.ndarray, "J"],
    T_root_cube: Float[np.ndarray, "4 4"],
    *,
    size: float,
    aims: Float[np.ndarray, "A 3"],
    inwards: Float[np.ndarray, "3"],
    down: bool,
) -> PutPlan:
    """A plan for one cube.

    Args:
        work: The arm and its obstacles, without the cube itself.
        q: Current arm angles.
        T_root_cube: The cube, upright, in the frame of the robot's root.
        size: Its edge, metres.
        aims: Positions where its centre may come to rest, root frame, the preferred one first.
        inwards: Horizontal direction into the space.
        down: Whether the cube enters from above, into a drawer, or straight inwards.

    Raises:
        NoPutPlan: If the cube cannot be reached or put down, or no path connects the two.
    """
    reason = ""
    for share in GAP_SHARES:
        closer = replace(work, body=replace(work.body, gap=share * work.body.gap))
        places = _place_ways(work.robot, aims, inwards, down=down)
        plan, reason = _plan(closer, q, T_root_cube, size, places)
        if plan is not None:
            return plan
    raise NoPutPlan(reason)


def _plan(
    work: Work, q: np.ndarray, T_root_cube: np.ndarray, size: float, wanted: _Wanted
) -> tuple[PutPlan | None, str]:
    """A plan that keeps the clearances of ``work``, or the reason why there is none."""
    hull = box_hull(np.full(3, -size / 2.0), np.full(3, size / 2.0))
    cube = Obstacle(field=build_field((hull,)), T_field_root=inverse(T_root_cube))
    careful = replace(work, obstacles=(*work.obstacles, cube))
    loaded = replace(work, body=holding(work.body, work.chain, hull.vertices, CUBE_GAP))
    picks = _solved(work, q, _pick_ways(work.robot, T_root_cube))
    if not len(picks.cost):
        return None, "no free pose of the arm reaches the cube on its stand"
    places = _solved(loaded, picks.q[-1, 0], wanted)
    if not len(places.cost):
        return None, "no free pose of the arm reaches the cube's goal"
    for i, j in _pairs(picks, places)[:PAIRS]:
        lift, place = picks.q[-len(LIFT) :, i], places.q[:, j]
        approach = picks.q[len(BEHIND) :: -1, i]
        there = detour(careful, q, approach[0])
        carried = None if there is None else detour(loaded, lift[-1], place[-1])
        if there is not None and carried is not None:
            plan = PutPlan(
                pick=np.concatenate([there, approach[1:]]),
                lift=lift,
                place=np.concatenate([carried, place[-2::-1]]),
                leave=place[1:],
            )
            return plan, ""
    return None, (
        f"no way of the arm from the cube to its place past the object, from {len(picks.cost)} picks to "
        f"{len(places.cost)} places"
    )


def _pick_ways(robot: RobotSpec, T_root_cube: np.ndarray) -> _Wanted:
    """Paths from the cube backwards, and up."""
    yaw = np.arctan2(T_root_cube[1, 0], T_root_cube[0, 0])
    middle = T_root_cube[:3, 3] + HIGHER * UP
    behind, lifted, slopes = [], [], []
    for index, slope in enumerate(SLOPES):
        for turn in (0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi):
            R, point = _gripper(yaw + turn, slope, robot)
            behind.append(_poses(R, [middle - d * point for d in (0.0, *BEHIND)]))
            lifted.append(_poses(R, [middle + d * UP for d in (0.0, *LIFT)]))
            slopes.append(index)
    return _Wanted(
        ways=(np.array(behind), np.array(lifted)), slope=np.array(slopes), cost=np.zeros(len(slopes))
    )


def _place_ways(robot: RobotSpec, aims: np.ndarray, inwards: np.ndarray, *, down: bool) -> _Wanted:
    """Paths from just above a place straight out of the space."""
    facing = np.arctan2(inwards[1], inwards[0])
    back = UP if down else RISE * UP - inwards
    slopes = [k for k in range(len(SLOPES)) if not down or SLOPES[k] > LEAST_DOWN]
    ways, which, cost = [], [], []
    for rank, aim in enumerate(aims):
        for drop in DROPS if down else DROPS[:1]:
            for index in slopes:
                for turn in HEADINGS:
                    R, _ = _gripper(facing + turn, SLOPES[index], robot)
                    ways.append(_poses(R, [aim + drop * UP + d * back for d in (0.0, *INTO)]))
                    which.append(index)
                    cost.append(0.1 * rank + 0.3 * abs(turn) + 4.0 * drop)
    return _Wanted(ways=(np.array(ways),), slope=np.array(which), cost=np.array(cost))


def _solved(work: Work, q: np.ndarray, wanted: _Wanted) -> _Ways:
    """The paths that the arm can follow to their ends without collision."""
    hold, order = free_poses(work, wanted.ways[0][:, 0], q, KEPT)
    found, good = [hold[None]], np.ones(len(hold), dtype=bool)
    for ways in wanted.ways:
        way, free = free_ways(work, ways[order].swapaxes(0, 1), hold)
        good &= free
        found.append(way[1:])
    everything = np.concatenate(found)
    travel = np.abs(np.diff(everything, axis=0)).max(axis=2).sum(axis=0)
    total = wanted.cost[order] + 0.3 * travel
    return _Ways(q=everything[:, good], slope=wanted.slope[order][good], cost=total[good])


def _pairs(picks: _Ways, places: _Ways) -> list[tuple[int, int]]:
    """Picks and places that keep the cube level, best matches first."""
    apart = np.abs(picks.slope[:, None] - places.slope[None])
    level = (apart == 0) | (apart == STEEP - FLAT)
    far = np.abs(picks.q[-1][:, None] - places.q[-1][None]).max(axis=2)
    total = np.where(level, picks.cost[:, None] + places.cost[None] + 0.3 * far, np.inf)
    order = np.argsort(total, axis=None, kind="stable")[: int(level.sum())]
    return [(int(k // len(places.cost)), int(k % len(places.cost))) for k in order]


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
