"""Checks the guarantees of a room on collision hulls, independently of the planner.

A sweep is checked step by step: between two poses every hull stays within the convex hull of both, grown by
the sagitta of the arc. The check is therefore conservative: it also reports obstacles closer to a sweep than
that (a fraction of a millimetre).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.transforms import transform_points
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import convex_hull
from sim_export.package import SimPackage

from ..hulls import move_hull
from .footprints import cached_package
from .map import CELL, reachable_map, way_to
from .room import ROBOT_HEIGHT, THICKNESS, Item, Placement, Room, along_wall, pose_matrix_of
from .solids import Solid, fixture_solids, item_hulls, item_motion, item_solid, make_solid, place_solid
from .sweeps import Sweep, opening_joints, sweep_boxes, sweep_joint

ProblemKind = Literal["overlap", "outside", "sweep", "standing", "unreachable", "unsupported"]
DEPTH = 1e-6
"""Penetration (m) that is attributed to rounding."""
PORCH = 0.4
"""Depth (m) of the space behind the entrance that a door may take."""
RESTS = 0.002
"""Largest distance (m) of an item from what it lies on."""
CORNERS = 24
"""Corners of the prism inscribed in the robot's disc."""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A violated guarantee: the object, its cause; ``depth`` in metres."""

    kind: ProblemKind
    id: str
    other: str
    depth: float
    message: str


def check_room(room: Room) -> tuple[Problem, ...]:
    """All problems of a room: overlaps at rest, objects outside, blocked sweeps and standing places,
    standing places that a robot cannot reach from the entrance, and contents that do not lie on anything.

    Raises:
        PackageError: If a package cannot be read.
    """
    objects = [place_solid(placement) for placement in room.placements]
    fixtures = fixture_solids(room)
    problems = [*_overlaps(objects, fixtures), *_outside(room, objects)]
    problems += _check_contents(room, objects, fixtures)
    for placement in room.placements:
        others = [solid for solid in (*objects, *fixtures) if solid.id != placement.id]
        problems += _blocked_sweeps(placement, others)
        problems += _blocked_standing(room, placement, [*objects, *fixtures])
    if room.standing_radius > 0.0:
        problems += _unreachable(room, [*objects, *fixtures])
    return tuple(problems)


def check_contents(room: Room) -> tuple[Problem, ...]:
    """The problems of a room that its contents cause."""
    return tuple(
        _check_contents(room, [place_solid(entry) for entry in room.placements], fixture_solids(room))
    )


def _check_contents(room: Room, objects: Sequence[Solid], fixtures: Sequence[Solid]) -> list[Problem]:
    items = [item_solid(item, item_motion(room, item)) for item in room.contents]
    problems = [*_overlaps(items, [*objects, *fixtures]), *_outside(room, items)]
    for placement in room.placements:
        inside = [item for item in room.contents if item.holder == placement.id]
        names = {item.id for item in inside}
        around = [solid for solid in (*objects, *fixtures, *items) if solid.id not in (placement.id, *names)]
        if inside:
            problems += _unsupported(placement, inside)
            problems += _blocked_contents(placement, inside, around)
    return problems


def _unsupported(placement: Placement, items: Sequence[Item]) -> list[Problem]:
    """Items above which nothing of their link is near: an item lowered by `RESTS` must meet it."""
    links = {link.name: HullSet(hulls=link.hulls) for link in cached_package(placement.package).links}
    lowered = np.eye(4)
    lowered[2, 3] = -RESTS
    problems = []
    for item in items:
        hulls = HullSet(hulls=item_hulls(item))
        if not len(signed_distances(hulls, links[item.link], lowered, np.eye(4)).distance):
            message = f"{item.id} does not lie on {item.link} of {placement.id}"
            problems.append(
                Problem(kind="unsupported", id=item.id, other=placement.id, depth=RESTS, message=message)
            )
    return problems


def _blocked_contents(placement: Placement, items: Sequence[Item], around: Sequence[Solid]) -> list[Problem]:
    """Items in the way of a door or drawer of their holder, and obstacles to those that move with it."""
    package = cached_package(placement.package)
    T = pose_matrix_of(placement)
    slots = {link.name: index for index, link in enumerate(package.links)}
    problems = []
    for joint in opening_joints(package):
        sweep = sweep_joint(package, joint)
        rides = [item for item in items if slots[item.link] in sweep.links]
        stays = [item_solid(item, T @ sweep.T[0, slots[item.link]]) for item in items if item not in rides]
        found = [(placement.id, *pair) for pair in _obstacles(package, sweep, T, stays).items()]
        still = [
            move_hull(hull, T @ sweep.T[0, index])
            for index, link in enumerate(package.links)
            if index not in sweep.links
            for hull in link.hulls
        ]
        for item in rides:
            alone = replace(
                package,
                links=tuple(
                    replace(link, hulls=item_hulls(item) if link.name == item.link else ())
                    for link in package.links
                ),
            )
            solids = [make_solid(placement.id, still), *stays, *around]
            found += [(item.id, *pair) for pair in _obstacles(alone, sweep, T, solids).items()]
        for name, other, depth in found:
            message = (
                f"{other} is {1e3 * depth:.1f} mm in the way of {name} on {joint.name} of {placement.id}"
            )
            problems.append(Problem(kind="sweep", id=name, other=other, depth=depth, message=message))
    return problems


def overlapping(room: Room, placement: Placement) -> bool:
    """Whether an object overlaps anything else in the room at its current joint positions, or leaves the
    room."""
    one = place_solid(placement)
    others = [place_solid(other) for other in room.placements if other.id != placement.id]
    found = _overlaps([one], [*others, *fixture_solids(room)])
    return bool(found or _outside(room, [one]))


def _meet(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Mask (A B) of boxes (A 2 3) and (B 2 3) that touch or overlap."""
    low = np.maximum(first[:, None, 0], second[None, :, 0])
    high = np.minimum(first[:, None, 1], second[None, :, 1])
    return np.all(low <= high, axis=2)


def _depth(first: HullSet, second: HullSet, reach: float) -> float:
    """Depth by which two sets are closer than ``reach``; 0 if they are not."""
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
    """Objects with a hull that is neither in the room nor in its entrance or another opening."""
    size = room.size
    spaces = [np.array([(0.0, 0.0, 0.0), size])]
    for hole in (room.entrance, *room.openings):
        inner, beyond = (
            size[1 if hole.side in ("front", "back") else 0],
            PORCH if hole is room.entrance else THICKNESS,
        )
        low, high = (hole.start, -beyond, hole.bottom), (hole.stop, inner, hole.top)
        spaces.append(along_wall(hole.side, size, low, high))
    problems = []
    for solid in objects:
        low, high = solid.boxes[:, 0], solid.boxes[:, 1]
        past = [np.maximum(space[0] - low, high - space[1]).max(axis=1) for space in spaces]
        beyond = float(np.min(past, axis=0).max())
        if beyond > DEPTH:
            message = f"{solid.id} reaches {1e3 * beyond:.2f} mm out of the room"
            problems.append(Problem(kind="outside", id=solid.id, other="room", depth=beyond, message=message))
    return problems


def _blocked_sweeps(placement: Placement, others: Sequence[Solid]) -> list[Problem]:
    """The first obstacle of each door and drawer."""
    package = cached_package(placement.package)
    problems = []
    for joint in opening_joints(package):
        found = _obstacles(package, sweep_joint(package, joint), pose_matrix_of(placement), others)
        problems += [
            Problem(
                kind="sweep", id=placement.id, other=other, depth=depth,
                message=f"{other} is {1e3 * depth:.1f} mm in the way of {joint.name} of {placement.id}",
            )
            for other, depth in found.items()
        ]  # fmt: skip
    return problems


def _obstacles(
    package: SimPackage, sweep: Sweep, T: Float[np.ndarray, "4 4"], others: Sequence[Solid]
) -> dict[str, float]:
    """Solids that a sweep meets, with the depth (m)."""
    near = np.concatenate([np.zeros((0, 2, 3)), *(solid.boxes for solid in others)])
    owner = [(solid, index) for solid in others for index in range(len(solid.boxes))]
    boxes, columns = sweep_boxes(package, sweep, T)
    found: dict[str, float] = {}
    around = np.array([[boxes[..., 0, :].min(axis=(0, 1)), boxes[..., 1, :].max(axis=(0, 1))]])
    candidates = np.flatnonzero(_meet(around, near)[0])
    if not len(candidates):
        return found
    for step, column in zip(*np.nonzero(_meet_grid(boxes, near[candidates])), strict=True):
        index, place = columns[column]
        points = package.links[index].hulls[place].vertices
        ends = np.concatenate([transform_points(T @ sweep.T[at, index], points) for at in (step, step + 1)])
        moved = HullSet(hulls=(convex_hull(ends),))
        for candidate in candidates[_meet(boxes[step, column][None], near[candidates])[0]]:
            solid, hull = owner[candidate]
            depth = _depth(moved, HullSet(hulls=(solid.hulls.hulls[hull],)), sweep.slack)
            if depth > DEPTH:
                found[solid.id] = max(found.get(solid.id, 0.0), depth)
    return found


def _meet_grid(boxes: Float[np.ndarray, "S H 2 3"], near: Float[np.ndarray, "M 2 3"]) -> np.ndarray:
    """Mask (S H) of steps and hulls that come near anything."""
    steps, hulls = boxes.shape[:2]
    return _meet(boxes.reshape(-1, 2, 3), near).any(axis=1).reshape(steps, hulls)


def _blocked_standing(room: Room, placement: Placement, solids: Sequence[Solid]) -> list[Problem]:
    """Obstacles at the robot's standing places, the object itself included."""
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
    """A prism around the robot's disc, slightly above the floor."""
    angles = 2.0 * np.pi * (np.arange(CORNERS) + 0.5) / CORNERS
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1) * radius / np.cos(np.pi / CORNERS)
    points = np.concatenate(
        [np.column_stack([ring + np.array([x, y]), np.full(CORNERS, z)]) for z in (0.01, ROBOT_HEIGHT)]
    )
    return make_solid("robot", [convex_hull(points)])


def _unreachable(room: Room, solids: Sequence[Solid]) -> list[Problem]:
    """Standing places that are not connected with the entrance, to within two and a half cells."""
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
