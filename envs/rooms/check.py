"""Checks the guarantees of a room on collision hulls, independently of the planner.

A sweep is checked step by step: between two poses every hull stays within the convex hull of both, grown by
the sagitta of the arc. The check is therefore conservative: it also reports obstacles closer to a sweep than
that (a fraction of a millimetre).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.transforms import shift, transform_points
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import convex_hull, move_hull
from sim_export.package import SimPackage

from .footprints import bounds_of, cached_package
from .map import CELL, reachable_map, way_to
from .recipes import DOOR
from .room import ROBOT_HEIGHT, THICKNESS, Item, Placement, Room, along_wall, pose_matrix_of, wall_axis
from .solids import (
    Solid,
    fixture_solids,
    item_hulls,
    item_solid,
    item_solids,
    make_solid,
    object_solids,
    place_solid,
    standing_solids,
)
from .sweeps import Sweep, find_sweeps, sweep_boxes

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


def check_room(room: Room, *, open_doors: bool = False) -> tuple[Problem, ...]:
    """All problems of a room: overlaps at rest, objects outside, blocked sweeps and standing places,
    standing places that a robot cannot reach from the entrance, and contents that do not lie on anything.

    Args:
        open_doors: Whether the robot comes by doors that stand open, whose leaves are in its way, too.

    Raises:
        PackageError: If a package cannot be read.
    """
    objects, fixtures = object_solids(room), fixture_solids(room)
    solids = objects + fixtures
    problems = [*_overlaps(objects, fixtures), *_outside(room, objects), *_check_contents(room, solids)]
    for placement in room.placements:
        problems += _blocked_sweeps(placement, [solid for solid in solids if solid.id != placement.id])
        problems += _blocked_standing(room, placement, solids)
    if room.standing_radius > 0.0:
        passable = _with_open_doors(room, objects) + fixtures if open_doors else solids
        problems += _unreachable(room, passable + standing_solids(room))
    return tuple(problems)


def check_contents(room: Room) -> tuple[Problem, ...]:
    """The problems of a room that its contents cause."""
    return tuple(_check_contents(room, object_solids(room) + fixture_solids(room)))


def _check_contents(room: Room, solids: Sequence[Solid]) -> Iterator[Problem]:
    items = item_solids(room)
    yield from _overlaps(items, solids)
    yield from _outside(room, items)
    standing = standing_solids(room)
    yield from _floating(standing, solids)
    for placement in room.placements:
        yield from _blocked_standing(room, placement, standing)
        inside = [item for item in room.contents if item.holder == placement.id]
        own = {item.id for item in inside}
        strangers = [item for item in items if item.id not in own]
        around = [solid for solid in solids if solid.id != placement.id]
        yield from _unsupported(placement, inside)
        yield from _blocked_contents(placement, inside, strangers, around)


def _unsupported(placement: Placement, items: Sequence[Item]) -> Iterator[Problem]:
    """Items above which nothing of their link is near: an item lowered by `RESTS` must meet it."""
    links = {link.name: HullSet(hulls=link.hulls) for link in cached_package(placement.package).links}
    lowered = shift(np.array([0.0, 0.0, -RESTS]))
    for item in items:
        hulls = HullSet(hulls=item_hulls(item))
        if not len(signed_distances(hulls, links[item.link], lowered, np.eye(4)).distance):
            message = f"{item.id} does not lie on {item.link} of {placement.id}"
            yield Problem(kind="unsupported", id=item.id, other=placement.id, depth=RESTS, message=message)


def _floating(standing: Sequence[Solid], solids: Sequence[Solid]) -> Iterator[Problem]:
    """Things without a holder below which nothing is near: lowered by `RESTS`, they must meet something."""
    lowered = shift(np.array([0.0, 0.0, -RESTS]))
    for one in standing:
        moved = make_solid(one.id, [move_hull(hull, lowered) for hull in one.hulls.hulls])
        if next(_penetrations(moved, solids), None) is None:
            message = f"{one.id} stands on nothing"
            yield Problem(kind="unsupported", id=one.id, other="room", depth=RESTS, message=message)


def _blocked_contents(
    placement: Placement, items: Sequence[Item], strangers: Sequence[Solid], around: Sequence[Solid]
) -> Iterator[Problem]:
    """Items in the way of a door or drawer, and obstacles to those that move with it.

    Args:
        items: What the object holds.
        strangers: What others hold.
        around: All other objects and fixtures.
    """
    package = cached_package(placement.package)
    T = pose_matrix_of(placement)
    slots = {link.name: index for index, link in enumerate(package.links)}
    for sweep in find_sweeps(package):
        rides = [item for item in items if slots[item.link] in sweep.links]
        stays = [item_solid(item, T @ sweep.T[0, slots[item.link]]) for item in items if item not in rides]
        loose = [*stays, *strangers]
        found = [(placement.id, *pair) for pair in _obstacles(package, sweep, T, loose).items()]
        still = [
            move_hull(hull, T @ sweep.T[0, index])
            for index, link in enumerate(package.links)
            if index not in sweep.links
            for hull in link.hulls
        ]
        for item in rides:
            links = (
                replace(link, hulls=item_hulls(item) if link.name == item.link else ())
                for link in package.links
            )
            alone = replace(package, links=tuple(links))
            solids = [make_solid(placement.id, still), *loose, *around]
            found += [(item.id, *pair) for pair in _obstacles(alone, sweep, T, solids).items()]
        for name, other, depth in found:
            way = f"{name} on {sweep.joint.name} of {placement.id}"
            message = f"{other} is {1e3 * depth:.1f} mm in the way of {way}"
            yield Problem(kind="sweep", id=name, other=other, depth=depth, message=message)


def overlapping(room: Room, placement: Placement) -> bool:
    """Whether an object overlaps anything else in the room at its current joint positions, or leaves the
    room."""
    one = place_solid(placement)
    others = [place_solid(other) for other in room.placements if other.id != placement.id]
    return any(chain(_overlaps([one], [*others, *fixture_solids(room)]), _outside(room, [one])))


def _meet(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Mask (A B) of boxes (A 2 3) and (B 2 3) that touch or overlap."""
    low = np.maximum(first[:, None, 0], second[None, :, 0])
    high = np.minimum(first[:, None, 1], second[None, :, 1])
    return np.all(low <= high, axis=2)


def _depth(first: HullSet, second: HullSet, reach: float) -> float:
    """Depth by which two sets are closer than ``reach``; 0 if they are not."""
    found = signed_distances(first, second, np.eye(4), np.eye(4), reach).distance
    return float(reach - found.min()) if len(found) else 0.0


def _penetrations(one: Solid, others: Iterable[Solid]) -> Iterator[tuple[str, float]]:
    """Ids of solids that overlap one, with the depth (m)."""
    for other in others:
        if _meet(one.boxes, other.boxes).any():
            depth = _depth(one.hulls, other.hulls, 0.0)
            if depth > DEPTH:
                yield other.id, depth


def _overlaps(objects: Sequence[Solid], fixtures: Sequence[Solid]) -> Iterator[Problem]:
    for index, one in enumerate(objects):
        for other, depth in _penetrations(one, (*objects[index + 1 :], *fixtures)):
            message = f"{one.id} and {other} overlap by {1e3 * depth:.2f} mm at rest"
            yield Problem(kind="overlap", id=one.id, other=other, depth=depth, message=message)


def _outside(room: Room, objects: Sequence[Solid]) -> Iterator[Problem]:
    """Objects with a hull that is neither in the room nor in its entrance or another opening."""
    size = room.size
    spaces = [np.array([(0.0, 0.0, 0.0), size])]
    for hole in (room.entrance, *room.openings):
        inner = size[1 - wall_axis(hole.side)]
        beyond = PORCH if hole is room.entrance else THICKNESS
        low, high = (hole.start, -beyond, hole.bottom), (hole.stop, inner, hole.top)
        spaces.append(along_wall(hole.side, size, low, high))
    for solid in objects:
        low, high = solid.boxes[:, 0], solid.boxes[:, 1]
        past = [np.maximum(space[0] - low, high - space[1]).max(axis=1) for space in spaces]
        beyond = float(np.min(past, axis=0).max())
        if beyond > DEPTH:
            message = f"{solid.id} reaches {1e3 * beyond:.2f} mm out of the room"
            yield Problem(kind="outside", id=solid.id, other="room", depth=beyond, message=message)


def _blocked_sweeps(placement: Placement, others: Sequence[Solid]) -> Iterator[Problem]:
    """The obstacles of each door and drawer."""
    package = cached_package(placement.package)
    for sweep in find_sweeps(package):
        found = _obstacles(package, sweep, pose_matrix_of(placement), others)
        for other, depth in found.items():
            message = f"{other} is {1e3 * depth:.1f} mm in the way of {sweep.joint.name} of {placement.id}"
            yield Problem(kind="sweep", id=placement.id, other=other, depth=depth, message=message)


def _obstacles(
    package: SimPackage, sweep: Sweep, T: Float[np.ndarray, "4 4"], others: Sequence[Solid]
) -> dict[str, float]:
    """Solids that a sweep meets, with the depth (m)."""
    near = np.concatenate([np.zeros((0, 2, 3)), *(solid.boxes for solid in others)])
    owner = [(solid, index) for solid in others for index in range(len(solid.boxes))]
    boxes, columns = sweep_boxes(package, sweep, T)
    found: dict[str, float] = {}
    around = bounds_of(boxes.reshape(-1, 2, 3))
    candidates = np.flatnonzero(_meet(around[None], near)[0])
    if not len(candidates):
        return found
    meets = _meet(boxes.reshape(-1, 2, 3), near[candidates]).any(axis=1).reshape(boxes.shape[:2])
    for step, column in np.argwhere(meets):
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


def _blocked_standing(room: Room, placement: Placement, solids: Sequence[Solid]) -> Iterator[Problem]:
    """Obstacles at the robot's standing places, the object itself included."""
    radius = room.standing_radius
    for x, y in placement.standing:
        beyond = max(radius - x, radius - y, x + radius - room.size[0], y + radius - room.size[1])
        if beyond > DEPTH:
            message = f"the place to open {placement.id} from reaches {1e3 * beyond:.1f} mm out of the room"
            yield Problem(kind="standing", id=placement.id, other="room", depth=beyond, message=message)
        for other, depth in _penetrations(robot_column(x, y, radius), solids):
            message = f"{other} takes {1e3 * depth:.1f} mm of the place to open {placement.id} from"
            yield Problem(kind="standing", id=placement.id, other=other, depth=depth, message=message)


def robot_column(x: float, y: float, radius: float) -> Solid:
    """A prism around the robot's disc, slightly above the floor."""
    angles = 2.0 * np.pi * (np.arange(CORNERS) + 0.5) / CORNERS
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1) * radius / np.cos(np.pi / CORNERS)
    points = np.concatenate(
        [np.column_stack([ring + np.array([x, y]), np.full(CORNERS, z)]) for z in (0.01, ROBOT_HEIGHT)]
    )
    return make_solid("robot", [convex_hull(points)])


def _with_open_doors(room: Room, objects: Sequence[Solid]) -> list[Solid]:
    """The objects of a room with all room doors open."""
    return [
        place_solid(_opened(placement)) if placement.role == DOOR.name else solid
        for placement, solid in zip(room.placements, objects, strict=True)
    ]


def _opened(placement: Placement) -> Placement:
    """An object with all its leaves as far open as they go."""
    package = cached_package(placement.package)
    leaves = {link.name for link in package.links if link.label == "door"}
    joints = tuple((joint.name, joint.upper) for joint in package.joints if joint.child in leaves)
    return replace(placement, joints=joints)


def _unreachable(room: Room, solids: Sequence[Solid]) -> Iterator[Problem]:
    """Standing places that are not connected with the entrance, to within two and a half cells."""
    reach = reachable_map(room, solids)
    if not reach.any():
        message = "nothing in the room can be reached from the entrance"
        yield Problem(kind="unreachable", id="room", other="entrance", depth=0.0, message=message)
        return
    for placement in room.placements:
        for point in placement.standing:
            far = way_to(reach, point)
            if far > 2.5 * CELL:
                message = f"a robot comes no nearer than {far:.2f} m to the place to open {placement.id} from"
                yield Problem(
                    kind="unreachable", id=placement.id, other="entrance", depth=far, message=message
                )
