"""Puts loose things onto the furniture of a room, selected by its seed: jars by the wall, a lamp, a book."""

from collections import Counter
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import transform_points
from artigen.types import Clutter
from sim_export.geometry.triangles import bounds_of

from .check import check_contents
from .compartments import cached_compartments
from .contents import LIFT, SKEW, SPACING, draw_thing, fill_compartment
from .footprints import cached_package, carries, read_footprint
from .furnish import BARE_ROLES
from .room import Item, Placement, Room, pose_matrix_of
from .solids import place_solid
from .things import THINGS

PER_AREA: dict[Clutter, float] = {"none": 0.0, "tidy": 3.0, "lived": 9.0, "messy": 18.0}
"""Things per square metre of tops."""
SHELVES: dict[Clutter, float] = {"none": 0.0, "tidy": 0.5, "lived": 0.9, "messy": 1.0}
"""Share of the open shelves that hold things."""
HEIGHTS = (0.35, 1.15)
"""Range of heights (m) of tops that carry things."""
CARRYING = frozenset({"nightstand", "cart"})
"""Roles that carry things but no other objects."""
EDGE = 0.01
"""Distance (m) of things from the edge of a top."""
BACK = 2.0
"""Power that draws places to the back of a top; 1 is uniform."""
TRIES = 12
"""Number of places tried for a thing."""


def clutter_room(room: Room, clutter: Clutter) -> Room:
    """The room with things on its furniture and its open shelves, besides what it holds already.

    Things stand near the back and square to it, in a messy room anyhow. Those that fail the check of the room
    are left out: nothing overlaps, hangs over or is in the way of a door or drawer.
    """
    taken = np.concatenate([place_solid(placement).boxes for placement in room.placements])
    items: list[Item] = []
    for index, placement in enumerate(room.placements):
        rng = np.random.default_rng([room.seed, room.attempt, 3, index])
        items += _clutter_top(room, placement, clutter, taken, rng)
        for compartment in cached_compartments(placement.package):
            if compartment.open and rng.random() < SHELVES[clutter]:
                items += fill_compartment(compartment, room.kind, placement, rng)
    numbers = Counter(item.thing for item in room.contents)
    for index, item in enumerate(items):
        numbers[item.thing] += 1
        items[index] = replace(item, id=f"{item.thing}_{numbers[item.thing]}")
    full = replace(room, contents=(*room.contents, *items))
    new = {item.id for item in items}
    failed = {name for problem in check_contents(full) for name in (problem.id, problem.other)} & new
    return replace(full, contents=tuple(item for item in full.contents if item.id not in failed))


def _clutter_top(
    room: Room,
    placement: Placement,
    clutter: Clutter,
    taken: Float[np.ndarray, "B 2 3"],
    rng: np.random.Generator,
) -> list[Item]:
    """Things on one object's level tops."""
    tops = read_footprint(placement.package).tops
    top = float(read_footprint(placement.package).body[1, 2])
    height = top + placement.position[2]
    fitting = [thing for thing in THINGS if f"{room.kind} top" in thing.where]
    bare = placement.role in BARE_ROLES - CARRYING or not HEIGHTS[0] <= height <= HEIGHTS[1]
    if bare or not tops or not fitting:
        return []
    package = cached_package(placement.package)
    children = {joint.child for joint in package.joints}
    (root,) = (link.name for link in package.links if link.name not in children)
    outline = np.concatenate(tops)
    low, high = outline.min(axis=0), outline.max(axis=0)
    count = int(PER_AREA[clutter] * sum(map(_area, tops)) + rng.random())
    T_room = pose_matrix_of(placement)
    items: list[Item] = []
    boxes = taken
    for _ in range(count):
        for _ in range(TRIES):
            fresh = [
                thing for thing in fitting if thing.name not in {item.thing for item in items}
            ] or fitting
            thing = fresh[int(rng.integers(len(fresh)))]
            drawn = draw_thing(thing, rng, np.pi / 4 if clutter == "messy" else SKEW)
            points = drawn.points
            u = rng.random(2)
            at = np.array([*low + (high - low) * [1.0 - u[0] ** BACK, u[1]], top + LIFT])
            box = bounds_of(transform_points(T_room, points + at))
            if carries(tops, _outer_corners(points) + at[:2]).all() and _is_apart(box, boxes):
                boxes = np.concatenate([boxes, box[None]])
                items.append(drawn.item(len(items), placement.id, root, at))
                break
    return items


def _outer_corners(points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "4 2"]:
    """Corners of the rectangle around points from above, and the least distance to an edge around it."""
    low, high = points[:, :2].min(axis=0) - EDGE, points[:, :2].max(axis=0) + EDGE
    return np.array([low, [low[0], high[1]], high, [high[0], low[1]]])


def _is_apart(box: Float[np.ndarray, "2 3"], boxes: Float[np.ndarray, "B 2 3"]) -> bool:
    """Whether a box keeps its distance from all others, or lies on them."""
    gap = np.maximum(box[0] - boxes[:, 1], boxes[:, 0] - box[1])
    return bool((gap >= [SPACING, SPACING, 0.0]).any(axis=1).all())


def _area(outline: Float[np.ndarray, "V 2"]) -> float:
    """Area (m^2) of a polygon."""
    x, y = outline.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0)
