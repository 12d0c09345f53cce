"""Expressions that refer to one object, one part or one loose thing of a room or a flat.

Objects of one role are told apart by their room, then by where they are as seen from the entrance; parts as
`sim_export.physics.phrases` does, seen from the front of their object.
"""

from collections import Counter, defaultdict
from collections.abc import Mapping

import numpy as np

from envs.rooms.footprints import cached_package, read_footprint
from envs.rooms.recipes import DOOR
from envs.rooms.room import Item, Room
from envs.rooms.solids import place_solid
from sim_export.physics.phrases import name_parts, tell_apart

COLORS: dict[str, tuple[float, float, float]] = {
    "white": (0.92, 0.91, 0.88), "grey": (0.6, 0.6, 0.62), "black": (0.15, 0.15, 0.16),
    "red": (0.78, 0.30, 0.22), "blue": (0.26, 0.43, 0.60), "green": (0.35, 0.52, 0.36),
    "yellow": (0.88, 0.75, 0.40), "brown": (0.50, 0.31, 0.20),
}  # fmt: skip
"""Words for the colours of things."""
EDGE = 0.01
"""Distance (m) below the top of its holder from which a thing lies in it, not on it."""
LOW = 0.3
"""Height (m) below which what no object holds stands on the floor."""
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth")


def zone_of(room: Room, name: str) -> str:
    """The room of a flat that an object or thing is in, from its id; "" in a single room."""
    return next((zone.name for zone in room.zones if name.startswith(f"{zone.name}_")), "")


def name_objects(room: Room) -> dict[str, str]:
    """A phrase for every object, without an article; all differ."""
    phrases: dict[str, str] = {}
    by_role: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for placement in room.placements:
        by_role[placement.role][zone_of(room, placement.id)].append(placement.id)
    for role, zones in by_role.items():
        for zone, names in zones.items():
            where = "" if len(zones) == 1 and role != DOOR.name else _where(role, zone)
            boxes = np.array([_seen_from_entrance(room, name) for name in names])
            for name, phrase in zip(names, tell_apart(role, boxes), strict=True):
                phrases[name] = phrase + where
    return phrases


def _where(role: str, zone: str) -> str:
    if not zone:
        return ""
    return f" {'of' if role == DOOR.name else 'in'} the {spell_zone(zone)}"


def spell_zone(zone: str) -> str:
    """The name of a room in words; of several of a kind, "first bedroom"."""
    kind, _, number = zone.rpartition("_")
    if number.isdecimal():
        return f"{ORDINALS[int(number) - 1]} {kind}".replace("_", " ")
    return zone.replace("_", " ")


def _seen_from_entrance(room: Room, name: str) -> np.ndarray:
    """The box (2 3) of an object in a frame like an object's: what is farther from the front wall is farther
    along x, what is left is farther along y."""
    boxes = place_solid(room.placement(name)).boxes
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    return np.array([[low[1], -high[0], low[2]], [high[1], -low[0], high[2]]])


def name_part(room: Room, objects: Mapping[str, str], name: str, link: str) -> str:
    """A phrase for a part of an object with its article: the object itself where nothing else of it opens."""
    package = cached_package(room.placement(name).package)
    parts = [part for part in name_parts(package) if part.noun in ("door", "drawer", "lid", "flap")]
    (part,) = (each for each in parts if each.link == link)
    owner = f"the {objects[name]}"
    return owner if len(parts) == 1 and part.noun != "drawer" else f"the {part.phrases[0]} of {owner}"


def name_items(room: Room, objects: Mapping[str, str]) -> dict[str, str]:
    """A phrase with its article for every loose thing that can be told from all others: by its name, its
    colour, or where it is."""
    roles = {placement.role for placement in room.placements}
    ways: list[dict[str, str]] = [{}, {}, {}, {}]
    for item in room.contents:
        noun, color = item.thing.replace("_", " "), _color_of(item)
        where = _where_is(room, objects, item)
        placed = f"{noun} {where}", f"{color} {noun} {where}"
        # What is called as an object of the room is told by where it is.
        phrases = placed if noun in roles else (noun, f"{color} {noun}", *placed)
        for way, phrase in zip(ways, phrases, strict=False):
            way[item.id] = phrase
    found: dict[str, str] = {}
    for way in ways:
        counts = Counter(way.values())
        for name, phrase in way.items():
            if counts[phrase] == 1:
                found.setdefault(name, f"the {phrase}")
    return found


def _where_is(room: Room, objects: Mapping[str, str], item: Item) -> str:
    """Where a thing is: on or in its holder, or on the floor or a worktop of its room."""
    if item.holder is None:
        zone = zone_of(room, item.id)
        below = "floor" if item.position[2] < LOW else "worktop"
        return f"on the {below}" + (f" of the {spell_zone(zone)}" if zone else "")
    return f"{'in' if is_inside(room, item) else 'on'} the {objects[item.holder]}"


def is_inside(room: Room, item: Item) -> bool:
    """Whether a thing lies in an object: below its top."""
    if item.holder is None:
        return False
    return item.position[2] <= float(read_footprint(room.placement(item.holder).package).body[1, 2]) - EDGE


def _color_of(item: Item) -> str:
    color = np.array(item.colors[0])
    return min(COLORS, key=lambda name: float(np.linalg.norm(color - COLORS[name])))
