"""Plans of flats: a rectangle cut into rooms, and the tree of doors that connects them.

The rectangle is cut in two again and again, in proportion to the areas of the rooms (a slicing floorplan). A
random one is changed step by step while it gets better (Wong and Liu, "A new algorithm for floorplan design",
DAC 1986, without the annealing), from several starts: until every room has a size that people build and a
stretch of wall for its door, and then towards compact rooms with windows that are entered from the hub.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from artigen.errors import ArtigenError
from artigen.types import RoomKind
from envs.rooms.room import SIDES, THICKNESS, Side, Zone, wall_axis

Rectangle = tuple[float, float, float, float]
"""Corners (x0, y0, x1, y1), metres."""
ROOMS: dict[int, tuple[RoomKind, ...]] = {
    2: ("living_room", "kitchen"),
    3: ("living_room", "kitchen", "bathroom"),
    4: ("living_room", "kitchen", "bedroom", "bathroom"),
    5: ("hall", "living_room", "kitchen", "bedroom", "bathroom"),
    6: ("hall", "living_room", "kitchen", "bedroom", "bathroom", "bedroom"),
    7: ("hall", "living_room", "kitchen", "bedroom", "bathroom", "bedroom", "office"),
}
"""Rooms of a flat by their number."""
HUBS: tuple[RoomKind, ...] = ("hall", "living_room")
"""Rooms that lead to others; the first of them in a flat is the one with the entrance."""
DAYLIGHT: tuple[RoomKind, ...] = ("living_room", "kitchen", "bedroom", "office", "workshop")
"""Rooms with windows."""
STARTS, STEPS = 12, 700
"""Number of random plans, and of changes that are tried on each."""
LINTEL_SPAN = 0.3
"""Length (m) of wall beside a door, so that it need not stand in a corner."""
PRIVATE = 1.5
"""Cost of a room that is entered through another one than the hub, unless it is a kitchen."""
DARK = 1.0
"""Cost of a room without an outer wall that should have one."""
WRONG = 10.0
"""Cost of every metre that a room lacks, and of every room without a door."""
ASPECTS = (0.7, 1.5)
"""Range of the width of a flat by its depth."""


@dataclass(frozen=True)
class Extent:
    """Range of floor areas (m^2), shortest side (m) and largest ratio of the sides of a kind of room."""

    area: tuple[float, float]
    least: float
    slender: float


EXTENTS: dict[RoomKind, Extent] = {
    "hall": Extent((7.0, 15.0), 1.6, 5.0),
    "living_room": Extent((20.0, 30.0), 3.9, 1.7),
    "kitchen": Extent((12.0, 17.0), 3.0, 1.8),
    "bedroom": Extent((15.0, 21.0), 3.7, 1.6),
    "bathroom": Extent((7.0, 11.0), 2.4, 2.0),
    "office": Extent((13.0, 20.0), 3.3, 1.7),
    "laundry": Extent((7.0, 10.0), 2.4, 1.7),
    "workshop": Extent((15.0, 24.0), 3.6, 1.6),
}
"""Sizes of rooms in flats: living space as it is built, and large enough for the furniture of the recipes."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """A room of the plan. ``side`` is its wall with the door, ``parent`` the index of the cell from which one
    enters (None for the hub, which is entered from outside), and ``span`` the stretch (m) along x or y that
    both share."""

    zone: Zone
    side: Side
    parent: int | None
    span: tuple[float, float]
    outer: tuple[Side, ...]


@dataclass(frozen=True, kw_only=True)
class FlatPlan:
    """A plan: inner width and depth (m) of the flat, and its rooms; the hub has the entrance in front.

    ``wrong`` adds up the metres that rooms lack, and rooms without a door, which are not among the cells.
    """

    size: tuple[float, float]
    cells: tuple[Cell, ...]
    wrong: float = 0.0


def read_rooms(words: Sequence[str]) -> tuple[RoomKind, ...]:
    """The rooms that words ask for: a number from 2 to 7, or kinds, separated by commas or blanks; by default
    four.

    Raises:
        ArtigenError: If a word is no kind of room, their number is not from 2 to 7, or none leads to others.
    """
    names = [name for word in words for name in word.replace(",", " ").split()]
    names = names or ["4"]
    if len(names) == 1 and names[0].isdecimal():
        if int(names[0]) not in ROOMS:
            raise ArtigenError(f"rooms {names[0]}: a flat has 2 to 7; say how many, or which")
        return ROOMS[int(names[0])]
    known: dict[str, RoomKind] = {kind: kind for kind in EXTENTS}
    unknown = [name for name in names if name not in known]
    if unknown:
        raise ArtigenError(f"rooms {' '.join(names)}: {unknown[0]!r} is none of {', '.join(known)}")
    kinds: tuple[RoomKind, ...] = tuple(known[name] for name in names)
    if len(kinds) not in ROOMS:
        raise ArtigenError(f"rooms {' '.join(names)}: a flat has 2 to 7 rooms, not {len(kinds)}")
    if not set(HUBS) & set(kinds):
        raise ArtigenError(
            f"rooms {' '.join(names)}: one of them must lead to the others; add a {' or a '.join(HUBS)}"
        )
    return kinds


@dataclass(frozen=True, kw_only=True)
class _Cuts:
    """A slicing floorplan: rooms in order, and for each cut, before those within its halves, the place in
    this order (as a share) and whether it runs along y. ``areas`` (m^2) are those of the rooms, with walls.
    """

    order: tuple[int, ...]
    places: tuple[float, ...]
    upright: tuple[bool, ...]
    areas: tuple[float, ...]
    aspect: float


def draw_plans(kinds: Sequence[RoomKind], seed: int, door: float) -> Iterator[FlatPlan]:
    """Plans of the rooms, the best first; deterministic.

    Args:
        door: Width (m) of a door with its frame.

    Raises:
        ArtigenError: If no plan gives every room a size that people build and a door.
    """
    names, door = _name_rooms(kinds), door + LINTEL_SPAN
    hub = next(kinds.index(kind) for kind in HUBS if kind in kinds)
    rated: list[tuple[float, int, FlatPlan]] = []
    for start in range(STARTS):
        rng = np.random.default_rng([seed, start, len(kinds)])
        cuts = _draw_cuts(kinds, rng)
        cost = _cost(plan := _connect(_zones(cuts, kinds, names), hub, door), hub)
        for _ in range(STEPS):
            changed = _change(cuts, kinds, rng)
            other = _connect(_zones(changed, kinds, names), hub, door)
            if (now := _cost(other, hub)) <= cost:
                cuts, cost, plan = changed, now, other
        if plan.wrong == 0.0:
            rated.append((cost, start, plan))
    if not rated:
        raise ArtigenError(
            f"no plan for {', '.join(names)} with {door:.2f} m of wall for each door was found; ask for "
            "other rooms, or for a smaller radius of the robot"
        )
    return (plan for _, _, plan in sorted(rated, key=lambda each: each[:2]))


def _draw_cuts(kinds: Sequence[RoomKind], rng: np.random.Generator) -> _Cuts:
    """Random cuts of rooms with usual areas."""
    cuts = len(kinds) - 1
    return _Cuts(
        order=tuple(rng.permutation(len(kinds)).tolist()),
        places=tuple(rng.random(cuts).tolist()),
        upright=tuple((rng.random(cuts) < 0.5).tolist()),
        areas=tuple(float(rng.uniform(*EXTENTS[kind].area)) for kind in kinds),
        aspect=float(rng.uniform(*ASPECTS)),
    )


def _change(cuts: _Cuts, kinds: Sequence[RoomKind], rng: np.random.Generator) -> _Cuts:
    """The cuts with one change: rooms swapped, a cut moved or turned, an area or the outline drawn anew."""
    fresh, what = _draw_cuts(kinds, rng), int(rng.integers(5))
    if what == 0:
        order, (one, other) = list(cuts.order), rng.choice(len(kinds), 2, replace=False)
        order[one], order[other] = order[other], order[one]
        return replace(cuts, order=tuple(order))
    if what == 4:
        return replace(cuts, aspect=fresh.aspect)
    name = ("places", "upright", "areas")[what - 1]
    values = list(getattr(cuts, name))
    index = int(rng.integers(len(values)))
    values[index] = getattr(fresh, name)[index]
    return replace(cuts, **{name: tuple(values)})


def _zones(cuts: _Cuts, kinds: Sequence[RoomKind], names: Sequence[str]) -> list[Zone]:
    """The floors between the walls, from the inner corner of the flat, to the millimetre."""
    total = sum(cuts.areas)
    width = float(np.sqrt(total * cuts.aspect))
    steps = iter(zip(cuts.places, cuts.upright, strict=True))
    found = dict(_cut(cuts.order, cuts.areas, (0.0, 0.0, width, total / width), steps))
    zones = []
    for index, (name, kind) in enumerate(zip(names, kinds, strict=True)):
        x0, y0, x1, y1 = (round(value, 2) for value in found[index])
        low, high = (round(x0, 3), round(y0, 3)), (round(x1 - THICKNESS, 3), round(y1 - THICKNESS, 3))
        zones.append(Zone(name=name, kind=kind, low=low, high=high))
    return zones


def _name_rooms(kinds: Sequence[RoomKind]) -> list[str]:
    """The kind of each room, with a number where there are several."""
    return [
        kind if kinds.count(kind) == 1 else f"{kind}_{kinds[: index + 1].count(kind)}"
        for index, kind in enumerate(kinds)
    ]


def _cut(
    members: Sequence[int],
    areas: Sequence[float],
    whole: Rectangle,
    steps: Iterator[tuple[float, bool]],
) -> Iterator[tuple[int, Rectangle]]:
    """Rectangles of the members, which divide the whole by their areas."""
    if len(members) == 1:
        yield members[0], whole
        return
    (place, upright), (x0, y0, x1, y1) = next(steps), whole
    first = 1 + int(place * (len(members) - 1))
    share = sum(areas[index] for index in members[:first]) / sum(areas[index] for index in members)
    if upright:
        middle = x0 + share * (x1 - x0)
        halves = (x0, y0, middle, y1), (middle, y0, x1, y1)
    else:
        middle = y0 + share * (y1 - y0)
        halves = (x0, y0, x1, middle), (x0, middle, x1, y1)
    yield from _cut(members[:first], areas, halves[0], steps)
    yield from _cut(members[first:], areas, halves[1], steps)


def _lacking(zone: Zone) -> float:
    """Length (m) that the shorter side of a room lacks."""
    width, depth = zone.high[0] - zone.low[0], zone.high[1] - zone.low[1]
    extent = EXTENTS[zone.kind]
    return max(0.0, max(extent.least, max(width, depth) / extent.slender) - min(width, depth))


def _connect(zones: Sequence[Zone], hub: int, door: float) -> FlatPlan:
    """The plan in which every room has a door to the hub or, if it does not touch it, to the nearest room
    that leads there."""
    size = max(zone.high[0] for zone in zones), max(zone.high[1] for zone in zones)
    span = zones[hub].low[0], zones[hub].high[0]
    entered: dict[int, tuple[int | None, Side, tuple[float, float]]] = {hub: (None, "front", span)}
    for parent in (waiting := [hub]):
        for index in range(len(zones)):
            shared = None if index in entered else _shared_wall(zones[index], zones[parent])
            if shared is not None and shared[1][1] - shared[1][0] >= door:
                entered[index] = (parent, *shared)
                if zones[index].kind in HUBS:
                    waiting.append(index)
    wrong = sum(map(_lacking, zones)) + max(0.0, door - span[1] + span[0]) + zones[hub].low[1]
    cells = [
        Cell(
            zone=zones[index],
            parent=parent,
            side=side,
            span=span,
            outer=tuple(each for each in SIDES if _is_outer(zones[index], each, size)),
        )
        for index, (parent, side, span) in sorted(entered.items())
    ]
    return FlatPlan(size=size, cells=tuple(cells), wrong=wrong + len(zones) - len(entered))


def _shared_wall(zone: Zone, other: Zone) -> tuple[Side, tuple[float, float]] | None:
    """The wall of a room behind which the other one lies, and the stretch that both share, if any."""
    sides: tuple[tuple[Side, float], ...] = (
        ("front", zone.low[1] - other.high[1]), ("back", other.low[1] - zone.high[1]),
        ("left", zone.low[0] - other.high[0]), ("right", other.low[0] - zone.high[0]),
    )  # fmt: skip
    for side, gap in sides:
        axis = wall_axis(side)
        span = max(zone.low[axis], other.low[axis]), min(zone.high[axis], other.high[axis])
        if abs(gap - THICKNESS) < 1e-6 and span[1] > span[0]:
            return side, span
    return None


def _is_outer(zone: Zone, side: Side, size: tuple[float, float]) -> bool:
    """Whether a wall of a room is one of the flat."""
    axis = 1 - wall_axis(side)
    return zone.low[axis] < 1e-6 if side in ("front", "left") else zone.high[axis] > size[axis] - 1e-6


def _cost(plan: FlatPlan, hub: int) -> float:
    """Cost of a plan: what is wrong, long rooms, dark ones, and those that are entered through others."""
    cost = WRONG * plan.wrong
    for cell in plan.cells:
        short, long = sorted(high - low for low, high in zip(cell.zone.low, cell.zone.high, strict=True))
        cost += long / max(short, 0.1) - 1.0
        cost += DARK * (cell.zone.kind in DAYLIGHT and not cell.outer)
        cost += PRIVATE * (cell.parent not in (None, hub) and cell.zone.kind not in ("kitchen", *HUBS))
    return cost
