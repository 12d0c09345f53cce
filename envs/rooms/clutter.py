"""Puts loose things onto the furniture of a room, selected by its seed: jars by the wall, a lamp, a book."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.shapes.polygons import polygon_areas
from artigen.transforms import transform_points
from artigen.types import Clutter
from sim_export.geometry.triangles import bounds_of

from .compartments import cached_compartments
from .contents import LIFT, SKEW, SPACING, add_items, draw_thing, fill_compartment
from .footprints import cached_package, carries, read_footprint
from .furnish import BARE_ROLES
from .room import (
    SIDES,
    YAWS,
    Fixture,
    Item,
    Placement,
    Room,
    corner,
    from_wall,
    pose_matrix_of,
    rounded_quat,
    turn_matrix,
)
from .solids import place_solid, standing_solids
from .things import THINGS
from .worktops import WORKTOP

PER_AREA: dict[Clutter, float] = {"none": 0.0, "tidy": 3.0, "lived": 9.0, "messy": 18.0}
"""Things per square metre of tops."""
SHELVES: dict[Clutter, float] = {"none": 0.0, "tidy": 0.5, "lived": 0.9, "messy": 1.0}
"""Share of the open shelves that hold things."""
HEIGHTS = (0.35, 1.15)
"""Range of heights (m) of tops that carry things."""
CARRYING = frozenset({"nightstand", "cart"})
"""Roles that carry things but no other objects."""
ONCE = 0.2
"""Length (m) of the smallest of a kind of things from which on a top has one."""
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
    taken = np.concatenate([taken, *(solid.boxes for solid in standing_solids(room))])
    items: list[Item] = []
    for index, placement in enumerate(room.placements):
        rng = np.random.default_rng([room.seed, room.attempt, 3, index])
        on_top = {other.role for other in room.placements if other.support == placement.id}
        dark = frozenset({"lamp"} if placement.role == "low table" or "lamp" in on_top else ())
        items += _clutter(room, _top_of(placement), clutter, taken, rng, dark)
        for compartment in cached_compartments(placement.package):
            if compartment.open and rng.random() < SHELVES[clutter]:
                items += fill_compartment(compartment, room.kind, placement, rng)
    for index, fixture in enumerate(room.fixtures):
        if fixture.name.startswith(WORKTOP):
            rng = np.random.default_rng([room.seed, room.attempt, 5, index])
            items += _clutter(room, _slab_of(room, fixture), clutter, taken, rng)
    return add_items(room, items)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Top:
    """Level polygons at a height (m) in a frame whose front is -x, which ``T_room`` maps to the room, and
    what things on it are held by."""

    tops: tuple[Float[np.ndarray, "V 2"], ...]
    height: float
    T_room: Float[np.ndarray, "4 4"]
    holder: str | None = None
    link: str = ""


def _top_of(placement: Placement) -> _Top:
    """The top of an object; without polygons if it carries nothing."""
    footprint, package = read_footprint(placement.package), cached_package(placement.package)
    top = float(footprint.body[1, 2])
    bare = (
        placement.role in BARE_ROLES - CARRYING or not HEIGHTS[0] <= top + placement.position[2] <= HEIGHTS[1]
    )
    children = {joint.child for joint in package.joints}
    (root,) = (link.name for link in package.links if link.name not in children)
    return _Top(
        tops=() if bare else footprint.tops, height=top, T_room=pose_matrix_of(placement),
        holder=placement.id, link=root,
    )  # fmt: skip


def _slab_of(room: Room, fixture: Fixture) -> _Top:
    """The top of a worktop, whose back is at the nearest wall."""
    box = np.array([[fixture.low, fixture.high]])
    side = min(SIDES, key=lambda side: float(from_wall(side, room.size, box)[0, 0, 1]))
    T = turn_matrix(YAWS[side])
    ends = transform_points(T.T, box[0])
    low, high = ends.min(axis=0), ends.max(axis=0)
    outline = np.array([low[:2], [high[0], low[1]], high[:2], [low[0], high[1]]])
    return _Top(tops=(outline,), height=fixture.high[2], T_room=T)


def _clutter(
    room: Room,
    top: _Top,
    clutter: Clutter,
    taken: Float[np.ndarray, "B 2 3"],
    rng: np.random.Generator,
    without: Collection[str] = (),
) -> list[Item]:
    """Things on a level top, but those ``without`` names."""
    fitting = [thing for thing in THINGS if f"{room.kind} top" in thing.where and thing.name not in without]
    tops, T_room = top.tops, top.T_room
    if not tops or not fitting:
        return []
    outline = np.concatenate(tops)
    low, high = outline.min(axis=0), outline.max(axis=0)
    count = int(PER_AREA[clutter] * sum(map(_area, tops)) + rng.random())
    items: list[Item] = []
    boxes = taken
    for _ in range(count):
        for _ in range(TRIES):
            there = {item.thing for item in items}
            fresh = [thing for thing in fitting if thing.name not in there]
            fresh = fresh or [thing for thing in fitting if max(thing.low) < ONCE]
            if not fresh:
                break
            thing = fresh[int(rng.integers(len(fresh)))]
            drawn = draw_thing(thing, rng, np.pi / 4 if clutter == "messy" else SKEW)
            points = drawn.points
            u = rng.random(2)
            at = np.array([*low + (high - low) * [1.0 - u[0] ** BACK, u[1]], top.height + LIFT])
            box = bounds_of(transform_points(T_room, points + at))
            if carries(tops, _outer_corners(points) + at[:2]).all() and _is_apart(box, boxes):
                boxes = np.concatenate([boxes, box[None]])
                items.append(_hold(drawn.item(len(items), top.holder, top.link, at), T_room))
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


def _hold(item: Item, T_room: Float[np.ndarray, "4 4"]) -> Item:
    """An item in its holder's frame, or in the room's if it has none."""
    if item.holder is not None:
        return item
    T = T_room @ pose_matrix_of(item)
    return replace(item, position=corner(T[:3, 3]), quat=rounded_quat(T[:3, :3]))


def _area(outline: Float[np.ndarray, "V 2"]) -> float:
    """Area (m^2) of a polygon."""
    return float(np.linalg.norm(polygon_areas(np.pad(outline, ((0, 0), (0, 1)))[None])))
