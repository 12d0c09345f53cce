"""What stands loose on the floor: chairs at tables and desks, stools at islands, and things along walls."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import shift, transform_points
from artigen.types import SceneKind
from sim_export.geometry.contacts import HullSet

from .arrange import DOORWAY
from .contents import LIFT, Drawn, draw_thing
from .footprints import read_footprint
from .room import (
    YAWS,
    Item,
    Placement,
    Room,
    Side,
    along_wall,
    corner,
    rounded_quat,
    turn_matrix,
    wall_length,
)
from .taken import Taken, find_taken, stand_boxes
from .things import THINGS, Thing, thing_hulls

APART = 0.02
"""Distance (m) of things on the floor from what else there is."""
TUCKS = (0.3, 0.22, 0.14, 0.05, -0.03, -0.12)
"""Lengths (m) of a seat below its table that are tried."""
ALONG = 0.06
"""Step (m) of places along a table or wall."""
PAIR = 0.62
"""Distance (m) between seats side by side."""
ASIDE = tuple(sorted(np.linspace(-0.5, 0.5, 11).round(1).tolist(), key=abs))
"""Distances (m) along the front of an object by which a robot's standing place moves for a seat."""


@dataclass(frozen=True, kw_only=True)
class Seat:
    """A thing to sit on at a role: its largest number at one object, and whether at its front only."""

    thing: str
    most: int
    front: bool = False


SEATS: dict[str, Seat] = {
    "table": Seat(thing="chair", most=4),
    "desk": Seat(thing="office_chair", most=1, front=True),
    "island": Seat(thing="stool", most=3),
}
"""Seats by the role of what they stand at."""
ALONG_WALLS: dict[SceneKind, tuple[str, ...]] = {
    "kitchen": ("floor_plant",),
    "office": ("floor_plant", "floor_lamp"),
    "bedroom": ("floor_lamp", "basket"),
    "bathroom": ("basket",),
    "workshop": ("stool",),
    "living_room": ("floor_lamp", "floor_plant", "basket"),
    "hall": ("shoes", "shoes", "shoes", "floor_plant"),
    "laundry": ("basket", "basket"),
}
"""Things that stand along the walls of a kind of room."""
_THINGS = {thing.name: thing for thing in THINGS}


def stand_on_floor(room: Room) -> Room:
    """The room with chairs, stools and things along its walls, where nothing opens and no robot stands; it
    stands beside a seat if the seat is where it would."""
    rng = np.random.default_rng([room.seed, room.attempt, 6])
    taken, items = find_taken(room), []
    start, stop = room.entrance.start - 0.1, room.entrance.stop + 0.1
    way = along_wall(room.entrance.side, room.size, (start, 0.0, 0.0), (stop, DOORWAY, 2.0))
    placements = {placement.id: placement for placement in room.placements}
    palettes: dict[str, int] = {}
    for name in placements:
        seat = SEATS.get(placements[name].role)
        if seat is None or placements[name].support is not None:
            continue
        thing = _THINGS[seat.thing]
        palette = palettes.setdefault(thing.name, int(rng.integers(len(thing.colors))))
        drawn = replace(draw_thing(thing, rng, 0.0), colors=thing.colors[palette])
        local, places = _boxes(drawn), []
        others = replace(taken, stands=_stands(room, way, placements.values(), name))
        for T in _around(placements[name], seat, drawn.size):
            if len(places) >= seat.most:
                break
            if all(np.linalg.norm(T[:2, 3] - at) >= PAIR for at in places):
                boxes = _free_boxes(room, others, local, T)
                moved = None if boxes is None else _make_way(room, placements[name], others, boxes)
                if boxes is not None and moved is not None:
                    placements[name], others, taken = moved, others.add(boxes), taken.add(boxes)
                    items.append(_item(drawn, T))
                    places.append(T[:2, 3])
    room = replace(room, placements=tuple(placements.values()))
    taken = replace(taken, stands=_stands(room, way, room.placements))
    for name in ALONG_WALLS[room.kind]:
        drawn = draw_thing(_THINGS[name], rng, 0.0)
        local = _boxes(drawn)
        for T in _along_walls(room, drawn.thing, rng):
            boxes = _free_boxes(room, taken, local, T)
            if boxes is not None:
                taken = taken.add(boxes)
                items.append(_item(drawn, T))
                break
    counts: dict[str, int] = {}
    for index, item in enumerate(items):
        counts[item.thing] = counts.get(item.thing, 0) + 1
        items[index] = replace(item, id=f"{item.thing}_{counts[item.thing]}")
    return replace(room, contents=(*room.contents, *items))


def _stands(
    room: Room, way: Float[np.ndarray, "2 3"], placements: Iterable[Placement], without: str = ""
) -> Float[np.ndarray, "S 2 3"]:
    """Boxes around the way into the room and around standing places at objects but one."""
    kept = (stand_boxes(each, room.standing_radius) for each in placements if each.id != without)
    return np.concatenate([way[None], *kept])


def _make_way(
    room: Room, placement: Placement, taken: Taken, boxes: Float[np.ndarray, "B 2 3"]
) -> Placement | None:
    """The object with its standing places beside boxes, as far along its front as they must be; None if
    there is no room for them."""
    here, standing = taken.add(boxes), []
    along = turn_matrix(2.0 * np.arctan2(placement.quat[3], placement.quat[0]))[:2, 1]
    for place in placement.standing:
        for step in ASIDE:
            x, y = (np.array(place) + step * along).round(4).tolist()
            (box,) = stand_boxes(replace(placement, standing=((x, y),)), room.standing_radius)
            inside = (box[0, :2] > 0.0).all() and (box[1, :2] < np.array(room.size[:2])).all()
            if inside and here.admits(box[None], 0.0, stands=False):
                standing.append((x, y))
                break
        else:
            return None
    return replace(placement, standing=tuple(standing))


def _item(drawn: Drawn, T: Float[np.ndarray, "4 4"]) -> Item:
    """The thing at a pose in the room."""
    item = drawn.item(0, None, "", np.zeros(3))
    return replace(item, position=corner(T[:3, 3]), quat=rounded_quat(T[:3, :3]))


def _boxes(drawn: Drawn) -> Float[np.ndarray, "H 2 3"]:
    """Boxes around the hulls of a thing in its own frame."""
    return HullSet(hulls=thing_hulls(drawn.thing.name, drawn.size)).rest_bounds


def _free_boxes(
    room: Room, taken: Taken, local: Float[np.ndarray, "H 2 3"], T: Float[np.ndarray, "4 4"]
) -> Float[np.ndarray, "H 2 3"] | None:
    """Boxes after quarter turns and a translation, if they are in the room and free; else None."""
    ends = transform_points(T, local)
    boxes = np.stack([ends.min(axis=1), ends.max(axis=1)], axis=1)
    inside = (boxes[:, 0, :2] > 0.0).all() and (boxes[:, 1, :2] < np.array(room.size[:2])).all()
    return boxes if inside and taken.admits(boxes, APART) else None


def _around(
    placement: Placement, seat: Seat, size: tuple[float, float, float]
) -> Iterator[Float[np.ndarray, "4 4"]]:
    """Poses of a seat at an object's sides, its front towards the object, tucked in as far as possible."""
    body = read_footprint(placement.package).body
    yaw = 2.0 * np.arctan2(placement.quat[3], placement.quat[0])
    T_room = shift(np.array([*placement.position[:2], LIFT])) @ turn_matrix(yaw)
    half = size[0] / 2.0
    turns = (np.pi,) if seat.front else (np.pi, 0.0, np.pi / 2, -np.pi / 2)
    for tuck in TUCKS:
        for turn in turns:
            # A seat that faces -x stands beyond the object's end in +x.
            axis = 0 if turn in (0.0, np.pi) else 1
            out = 1 if turn in (0.0, np.pi / 2) else 0
            edge = body[out, axis] + (half - tuck) * (1.0 if out else -1.0)
            low, high = body[0, 1 - axis] + size[1] / 2, body[1, 1 - axis] - size[1] / 2
            middle = (low + high) / 2.0
            for along in sorted(
                np.arange(low, high, ALONG).tolist(), key=lambda at: abs(abs(at - middle) - PAIR / 2)
            ):
                T = turn_matrix(turn)
                T[axis, 3], T[1 - axis, 3] = edge, along
                yield T_room @ T


def _along_walls(room: Room, thing: Thing, rng: np.random.Generator) -> Iterator[Float[np.ndarray, "4 4"]]:
    """Poses with the back at a wall, those near corners first."""
    reach, side = thing.high[0] / 2.0 + APART, thing.high[1] / 2.0 + APART
    found: list[tuple[float, np.ndarray]] = []
    sides: tuple[Side, ...] = ("back", "left", "right", "front")
    for wall in sides:
        length = wall_length(wall, room.size)
        for at in np.arange(side, length - side, ALONG):
            point = along_wall(wall, room.size, (at, reach, LIFT), (at, reach, LIFT))[0]
            T = turn_matrix(YAWS[wall])
            T[:3, 3] = point
            found.append((min(at, length - at) + float(rng.random()), T))
    yield from (T for _, T in sorted(found, key=lambda pair: pair[0]))
