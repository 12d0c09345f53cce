"""Candidate places of furniture clusters in a room, and the choice of the best one."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from .footprints import bounds_of
from .pieces import (
    GAP,
    TOUCH,
    Boxes,
    Cluster,
    Piece,
    conflict,
    join_boxes,
    move_boxes,
    overlap,
    shift_boxes,
    widened,
)
from .room import SIDES, YAWS, Opening, Side, along_wall, turn_matrix, wall_axis, wall_length

STEP = 0.04
"""Step (m) of candidate places along a wall."""
GRID = 0.15
"""Step (m) of candidate places in the middle of a room."""
DOORWAY = 0.9
"""Depth (m) of the space in front of the entrance that stays empty."""

PORTAL = 0.15
"""Depth (m) that the frame and the levers of a neighbour's door may reach into a room."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Place:
    """A placed cluster: ``T`` maps its frame to the room's, ``boxes`` are in the room."""

    cluster: Cluster
    T: Float[np.ndarray, "4 4"]
    boxes: Boxes
    side: Side | None
    support: Piece | None = None
    """Support of the cluster if it does not stand on the floor."""

    @property
    def center(self) -> Float[np.ndarray, "2"]:
        """Centre of the bodies on the floor."""
        return bounds_of(self.boxes.bodies)[:, :2].sum(axis=0) / 2.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Plan:
    """A partially furnished room. ``doorway`` is kept free of bodies.

    ``doorways`` are those of neighbours, whose doors open away from this room; windows fit into ``outer``
    walls only.
    """

    size: tuple[float, float, float]
    entrance: Opening
    places: tuple[Place, ...] = ()
    doorways: tuple[Opening, ...] = ()
    outer: tuple[Side, ...] = SIDES

    @property
    def boxes(self) -> Boxes:
        """All boxes so far."""
        return join_boxes([place.boxes for place in self.places])

    @property
    def doorway(self) -> Float[np.ndarray, "D 2 3"]:
        """Space that the entrance, and then every other doorway, needs."""
        rows = []
        for hole in (self.entrance, *self.doorways):
            low, high = (hole.start - 0.05, -0.2, 0.0), (hole.stop + 0.05, DOORWAY, 2.0)
            rows.append(along_wall(hole.side, self.size, low, high))
        return np.array(rows)

    @property
    def portals(self) -> Float[np.ndarray, "D 2 3"]:
        """Space of the neighbours' doors, shut, on this side of their walls."""
        rows = [
            along_wall(hole.side, self.size, (hole.start, 0.0, 0.0), (hole.stop, PORTAL, hole.top))
            for hole in self.doorways
        ]
        return np.array(rows).reshape(-1, 2, 3)

    def with_place(self, place: Place) -> "Plan":
        """The plan with one more cluster."""
        return replace(self, places=(*self.places, place))


@dataclass(frozen=True, kw_only=True)
class Taste:
    """Placement preferences of a cluster: costs per metre."""

    corner: float = 0.0
    """Cost of distance from the nearest corner of the wall."""
    middle: float = 0.0
    """Cost of distance from the middle of the wall, or of the room."""
    near: tuple[float, float] | None = None
    """Point from which distance is a cost."""
    entrance: float = 0.25
    """Gain per metre of distance from the entrance, up to 3 m."""
    noise: float = 0.6
    """Scale of random costs."""


def fits(plan: Plan, boxes: Boxes, against: Boxes, *, aisle: float = 0.0) -> bool:
    """Whether boxes lie in the room, leave the doorway free, and conflict with nothing there."""
    everything = boxes.all
    if (everything[:, 0] < -TOUCH).any() or (everything[:, 1] > np.array(plan.size) + TOUCH).any():
        return False
    if overlap(boxes.bodies, plan.doorway) or overlap(boxes.sweeps, plan.portals) or conflict(boxes, against):
        return False
    return aisle == 0.0 or not overlap(widened(boxes.bodies, aisle), against.bodies)


def wall_places(
    plan: Plan,
    cluster: Cluster,
    side: Side,
    starts: Float[np.ndarray, "S"] | None = None,
    sunk: float = 0.0,
) -> Iterator[Place]:
    """Places along a wall: at ``starts`` (metres along it), or at regular steps and flush with both corners.

    What is ``sunk`` reaches that far (m) into the wall; boxes are those of the rest of it.
    """
    gap, back = GAP + sunk, GAP - sunk  # what is sunk into two walls would meet in their corner
    if starts is None:
        last = wall_length(side, plan.size) - cluster.length - gap
        starts = np.append(np.arange(gap, last, STEP), last) if last >= gap else np.zeros(0)
    turn = turn_matrix(YAWS[side])
    boxes = move_boxes(cluster.boxes, turn)
    frame = np.array([[[-cluster.depth, 0.0, 0.0], [0.0, cluster.length, 1.0]]])
    turned = frame @ turn[:3, :3].T
    low = np.minimum(turned[0, 0], turned[0, 1])
    for start in starts:
        high = (start + cluster.length, back + cluster.depth, 1.0)
        target = along_wall(side, plan.size, (start, back, 0.0), high)
        T = turn.copy()
        T[:2, 3] = (target[0] - low)[:2]
        placed = shift_boxes(boxes, T[:3, 3])
        if sunk > 0.0:
            placed = _in_room(side, plan.size, placed)
        yield Place(cluster=cluster, T=T, boxes=placed, side=side)


def _in_room(side: Side, size: tuple[float, float, float], boxes: Boxes) -> Boxes:
    """Boxes without what lies in a wall."""
    axis = 1 - wall_axis(side)

    def cut(whole: Float[np.ndarray, "N 2 3"]) -> Float[np.ndarray, "N 2 3"]:
        out = whole.copy()
        out[..., axis] = np.clip(out[..., axis], 0.0, size[axis])
        return out

    return boxes.change(cut)


def middle_places(plan: Plan, cluster: Cluster) -> Iterator[Place]:
    """Places on a grid over the room, in all four directions."""
    for yaw in YAWS.values():
        turn = turn_matrix(yaw)
        boxes = move_boxes(cluster.boxes, turn)
        center = turn[:2, :2] @ np.array([-cluster.depth / 2.0, cluster.length / 2.0])
        for x in np.arange(0.9, plan.size[0] - 0.8, GRID):
            for y in np.arange(0.9, plan.size[1] - 0.8, GRID):
                T = turn.copy()
                T[:2, 3] = np.array([x, y]) - center
                yield Place(cluster=cluster, T=T, boxes=shift_boxes(boxes, T[:3, 3]), side=None)


def best_place(
    plan: Plan, candidates: Iterable[Place], taste: Taste, rng: np.random.Generator, *, aisle: float = 0.0
) -> Place | None:
    """The fitting candidate of least cost, or None."""
    against = plan.boxes
    door = plan.doorway[0, :, :2].mean(axis=0)
    rated = [
        (place_cost(plan, place, taste, door) + taste.noise * rng.random(), place) for place in candidates
    ]
    for _, place in sorted(rated, key=lambda pair: pair[0]):
        if fits(plan, place.boxes, against, aisle=aisle):
            return place
    return None


def place_cost(plan: Plan, place: Place, taste: Taste, door: Float[np.ndarray, "2"]) -> float:
    """Cost of a place; ``door`` is the middle of the space before the entrance."""
    bodies = place.boxes.bodies
    low, high = bodies[:, 0, :2].min(axis=0).tolist(), bodies[:, 1, :2].max(axis=0).tolist()
    center = (low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0
    cost = 0.0
    if place.side is None:
        cost += taste.middle * math.dist(center, (plan.size[0] / 2.0, plan.size[1] / 2.0))
    else:
        axis = wall_axis(place.side)
        length = wall_length(place.side, plan.size)
        cost += taste.corner * min(low[axis], length - high[axis])
        cost += taste.middle * abs(center[axis] - length / 2.0)
    if taste.near is not None:
        cost += 1.5 * math.dist(center, taste.near)
    return cost - taste.entrance * min(math.dist(center, door), 3.0)
