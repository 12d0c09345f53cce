"""Checks the guarantees of a room on collision hulls, independently of the planner.

A sweep is checked piece by piece: between two poses every hull stays within the convex hull of both, grown
by the arc's height above its chord. So what is called free is free, and something closer to a sweep than
that height (a fraction of a millimetre) counts as in its way.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.transforms import transform_points
from sim_export.collision.contacts import HullSet, signed_distances
from sim_export.collision.hulls import convex_hull

from .footprints import cached_package
from .map import CELL, ROBOT_HEIGHT, reachable_map, way_to
from .room import Placement, Room, pose_matrix_of
from .solids import Solid, fixture_solids, make_solid, place_solid
from .sweeps import opening_joints, sweep_boxes, sweep_joint

ProblemKind = Literal["overlap", "outside", "sweep", "standing", "unreachable"]
DEPTH = 1e-6
"""Metres of penetration that count as rounding."""
CORNERS = 24
"""Of the prism that stands for the robot's disc, which lies inside."""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A promise that is not kept: by which object, and because of what; ``depth`` in metres."""

    kind: ProblemKind
    id: str
    other: str
    depth: float
    message: str


def check_room(room: Room) -> tuple[Problem, ...]:
    """Everything that is wrong with a room: overlaps at rest, objects outside, blocked sweeps and standing
    places, and standing places that a robot cannot reach from the entrance.

    Raises:
        PackageError: If a package cannot be read.
    """
    objects = [place_solid(placement) for placement in room.placements]
    fixtures = fixture_solids(room)
    problems = [*_overlaps(objects, fixtures), *_outside(room, objects)]
    for placement in room.placements:
        others = [solid for solid in (*objects, *fixtures) if solid.id != placement.id]
        problems += _blocked_sweeps(placement, others)
        problems += _blocked_standing(room, placement, [*objects, *fixtures])
    if room.standing_radius > 0.0:
        problems += _unreachable(room, [*objects, *fixtures])
    return tuple(problems)


def overlapping(room: Room, placement: Placement) -> bool:
    """Whether one object of a room overlaps anything else in it, joints as they are, or leaves the room."""
    one = place_solid(placement)
    others = [place_solid(other) for other in room.placements if other.id != placement.id]
    found = _overlaps([one], [*others, *fixture_solids(room)])
    return bool(found or _outside(room, [one]))


def _meet(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Which boxes (A 2 3) and (B 2 3) touch or overlap: A B."""
    low = np.maximum(first[:, None, 0], second[None, :, 0])
    high = np.minimum(first[:, None, 1], second[None, :, 1])
    return np.all(low <= high, axis=2)


def _depth(first: HullSet, second: HullSet, reach: float) -> float:
    """How far two sets come closer than ``reach``; 0 where they do not."""
    found = signed_distances(first, second, np.eye(4), np.eye(4), reach).distance
    return float(reach - found.min()) if len(found) else 0.0


def _overlaps(objects: Sequence[Solid], fixtures: Sequence[Solid]) -> list[Problem]:
    problems = []
    for index, one in enumerate(objects):
        for other in (*objects[index + 1 :], *fixtures):
            if not _meet(one.boxes, other.boxes).any():
                continue
            depth = _depth(one.hulls, other.hulls, 0.0)
            if depth > DEPTH:
                message = f"{one.id} and {other.id} overlap by {1e3 * depth:.2f} mm at rest"
                problems.append(
                    Problem(kind="overlap", id=one.id, other=other.id, depth=depth, message=message)
                )
    return problems


def _outside(room: Room, objects: Sequence[Solid]) -> list[Problem]:
    problems = []
    for solid in objects:
        low, high = solid.boxes[:, 0].min(axis=0), solid.boxes[:, 1].max(axis=0)
        beyond = float(np.maximum(-low, high - np.array(room.size)).max())
        if beyond > DEPTH:
            message = f"{solid.id} reaches {1e3 * beyond:.2f} mm out of the room"
            problems.append(Problem(kind="outside", id=solid.id, other="room", depth=beyond, message=message))
    return problems


def _blocked_sweeps(placement: Placement, others: Sequence[Solid]) -> list[Problem]:
    """The first thing in the way of each door and drawer."""
    package = cached_package(placement.package)
    T = pose_matrix_of(placement)
    near = np.concatenate([np.zeros((0, 2, 3)), *(solid.boxes for solid in others)])
    owner = [(solid, index) for solid in others for index in range(len(solid.boxes))]
    problems = []
    for joint in opening_joints(package):
        sweep = sweep_joint(package, joint)
        boxes, columns = sweep_boxes(package, sweep, T)
        found: dict[str, float] = {}
        around = np.array([[boxes[..., 0, :].min(axis=(0, 1)), boxes[..., 1, :].max(axis=(0, 1))]])
        candidates = np.flatnonzero(_meet(around, near)[0])
        if not len(candidates):
            continue
        for step, column in zip(*np.nonzero(_meet_grid(boxes, near[candidates])), strict=True):
            index, place = columns[column]
            points = package.links[index].hulls[place].vertices
            ends = np.concatenate(
                [transform_points(T @ sweep.T[at, index], points) for at in (step, step + 1)]
            )
            moved = HullSet(hulls=(convex_hull(ends),))
            for candidate in candidates[_meet(boxes[step, column][None], near[candidates])[0]]:
                solid, hull = owner[candidate]
                depth = _depth(moved, HullSet(hulls=(solid.hulls.hulls[hull],)), sweep.slack)
                if depth > DEPTH:
                    found[solid.id] = max(found.get(solid.id, 0.0), depth)
        problems += [
            Problem(
                kind="sweep", id=placement.id, other=other, depth=depth,
                message=f"{other} is {1e3 * depth:.1f} mm in the way of {joint.name} of {placement.id}",
            )
            for other, depth in found.items()
        ]  # fmt: skip
    return problems


def _meet_grid(boxes: Float[np.ndarray, "S H 2 3"], near: Float[np.ndarray, "M 2 3"]) -> np.ndarray:
    """Which step and hull come near anything: S H."""
    steps, hulls = boxes.shape[:2]
    return _meet(boxes.reshape(-1, 2, 3), near).any(axis=1).reshape(steps, hulls)


def _blocked_standing(room: Room, placement: Placement, solids: Sequence[Solid]) -> list[Problem]:
    """Obstacles where the robot should stand, the object itself included."""
    problems = []
    radius = room.standing_radius
    for x, y in placement.standing:
        beyond = max(radius - x, radius - y, x + radius - room.size[0], y + radius - room.size[1])
        if beyond > DEPTH:
            message = f"the place to open {placement.id} from reaches {1e3 * beyond:.1f} mm out of the room"
            problems.append(
                Problem(kind="standing", id=placement.id, other="room", depth=beyond, message=message)
            )
        column = robot_column(x, y, radius)
        for solid in solids:
            if not _meet(column.boxes, solid.boxes).any():
                continue
            depth = _depth(column.hulls, solid.hulls, 0.0)
            if depth > DEPTH:
                message = f"{solid.id} takes {1e3 * depth:.1f} mm of the place to open {placement.id} from"
                problems.append(
                    Problem(kind="standing", id=placement.id, other=solid.id, depth=depth, message=message)
                )
    return problems


def robot_column(x: float, y: float, radius: float) -> Solid:
    """A prism around the robot's disc, a hair above the floor."""
    angles = 2.0 * np.pi * (np.arange(CORNERS) + 0.5) / CORNERS
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1) * radius / np.cos(np.pi / CORNERS)
    points = np.concatenate(
        [np.column_stack([ring + np.array([x, y]), np.full(CORNERS, z)]) for z in (0.01, ROBOT_HEIGHT)]
    )
    return make_solid("robot", [convex_hull(points)])


def _unreachable(room: Room, solids: Sequence[Solid]) -> list[Problem]:
    """Standing places that do not hang together with the entrance, to within two cells and a half."""
    reach = reachable_map(room, solids)
    if not reach.any():
        message = "nothing in the room can be reached from the entrance"
        return [Problem(kind="unreachable", id="room", other="entrance", depth=0.0, message=message)]
    problems = []
    for placement in room.placements:
        for point in placement.standing:
            far = way_to(reach, point)
            if far > 2.5 * CELL:
                message = f"a robot comes no nearer than {far:.2f} m to the place to open {placement.id} from"
                problems.append(
                    Problem(kind="unreachable", id=placement.id, other="entrance", depth=far, message=message)
                )
    return problems
