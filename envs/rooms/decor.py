"""Where curtains, sky, pictures, mirrors, towels, switches, sockets and lamps are in a room, and its rug.

Everything is a box or cylinder with collision, where nothing stands, moves or opens.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice

import numpy as np
from jaxtyping import Float

from artigen.types import SceneKind

from .hangings import (
    FRAMES,
    METAL,
    OFF,
    PAINTS,
    SKY,
    WHITE,
    Part,
    draw_coats,
    draw_curtains,
    draw_mirror,
    draw_picture,
    draw_socket,
    draw_television,
    draw_tools,
    draw_towel,
)
from .patterns import Color
from .room import SIDES, THICKNESS, Fixture, Room, Side, along_wall, corner, wall_length
from .rug import GAP, STEP, lay_rug
from .taken import Taken, find_taken
from .views import PENDANT

BESIDE = 0.04
"""Distance (m) of what hangs on a wall from what is beside it."""
CLOTHS: tuple[Color, ...] = (
    (0.80, 0.77, 0.70), (0.55, 0.62, 0.66), (0.72, 0.66, 0.60), (0.60, 0.64, 0.55), (0.74, 0.60, 0.52),
)  # fmt: skip
PICTURES: dict[SceneKind, int] = {
    "living_room": 4, "bedroom": 3, "office": 2, "hall": 2, "kitchen": 1,
}  # fmt: skip
CURTAINED = ("living_room", "bedroom", "office")
LAMPS: dict[SceneKind, int] = {"living_room": 1, "bedroom": 1, "kitchen": 2, "office": 2, "hall": 1}
"""Pendants; other rooms have a flat lamp."""
NEAR = 8
"""Number of places near a lowboard at which a television may hang."""
ON_WALLS = (
    "curtain", "picture", "mirror", "towel", "switch", "socket", "sky",
    "television", "coats", "tools",
)  # fmt: skip
"""Beginnings of the names of what hangs on a wall; its side follows."""
Hung = tuple[Side, list[Part]]
"""Parts on a wall."""


def decorate_room(room: Room) -> Room:
    """The room with what hangs on its walls and ceiling and lies on its floor, selected by its seed."""
    rng = np.random.default_rng([room.seed, room.attempt, 4])
    taken, added = find_taken(room), []
    cloth = CLOTHS[int(rng.integers(len(CLOTHS)))]
    frame = FRAMES[int(rng.integers(len(FRAMES)))]

    def hang(side: Side, parts: Sequence[Part]) -> bool:
        nonlocal taken
        fixtures, boxes = _on_wall(room, side, parts, len(added))
        gap = GAP if parts[0].name.startswith("curtain") else BESIDE
        if not _is_free(room, side, parts) or not taken.admits(boxes, gap, stands=False):
            return False
        added.extend(fixtures)
        taken = taken.add(boxes)
        return True

    for hole in room.windows:
        added.append(_sky(room, hole.side, (hole.start, hole.stop, hole.bottom, hole.top), len(added)))
    if room.kind in CURTAINED:
        for side, start, stop, bottom, top in _windows(room):
            ways = draw_curtains((start, stop, bottom, top), cloth)
            _first(hang, ((side, parts) for parts in ways))
    _first(hang, _switches(room))
    if room.kind in ("bathroom", "hall"):
        sinks = [np.array(each.position[:2]) for each in room.placements if each.role == "sink"]
        near = sinks[0] if sinks else None
        _first(hang, _spots(room, rng, (0.5, 0.7), 1.6, lambda at: draw_mirror(at, frame), near))
    if room.kind in ("bathroom", "kitchen"):
        _first(hang, _spots(room, rng, (0.5, 0.5), 1.15, lambda at: draw_towel(at, cloth)))
    for board in (each for each in room.placements if each.role == "lowboard"):
        at = np.array(board.position[:2])
        above = _spots(room, rng, (1.14, 0.66), board.size[2] + 0.55, draw_television, at)
        _first(hang, islice(above, NEAR))
    for bench in (each for each in room.placements if room.kind == "workshop" and each.role == "desk"):
        at = np.array(bench.position[:2])
        _first(hang, islice(_spots(room, rng, (1.0, 0.64), 1.5, draw_tools, at), NEAR))
    if room.kind == "hall":
        _first(hang, _spots(room, rng, (0.9, 1.0), 1.2, lambda at: draw_coats(at, rng)))
    for _ in range(PICTURES.get(room.kind, 0)):
        wide, high, share = rng.uniform((0.35, 0.35, 0.25), (0.8, 0.6, 0.7)).tolist()
        paint = PAINTS[int(rng.integers(len(PAINTS)))]
        draw = partial(draw_picture, size=(wide, high), frame=frame, paint=paint, share=share)
        _first(hang, _spots(room, rng, (wide, high), 1.58, draw))
    for _ in range(3):
        _first(hang, _spots(room, rng, (0.08, 0.08), 0.3, draw_socket))
    room, floor = lay_rug(room, taken, cloth, rng)
    lamps = _lamps(room, taken, cloth)
    return replace(room, fixtures=(*room.fixtures, *added, *floor, *lamps))


def _first(hang: Callable[[Side, list[Part]], bool], candidates: Iterator[Hung]) -> None:
    """Hangs up the first that fits."""
    for side, parts in candidates:
        if hang(side, parts):
            return


def _on_wall(
    room: Room, side: Side, parts: Sequence[Part], number: int
) -> tuple[list[Fixture], Float[np.ndarray, "P 2 3"]]:
    fixtures, boxes = [], []
    for index, part in enumerate(parts):
        low, high = along_wall(side, room.size, part.low, part.high)
        boxes.append((low, high))
        kind, _, rest = part.name.partition("_")
        fixtures.append(
            Fixture(
                name=f"{kind}_{side}_{number}{index}_{rest}".rstrip("_"), low=corner(low), high=corner(high),
                color=part.color, pattern=part.pattern,
            )
        )  # fmt: skip
    return fixtures, np.array(boxes)


def _is_free(room: Room, side: Side, parts: Sequence[Part]) -> bool:
    """Whether parts are on their wall and on none of its openings."""
    low = np.min([part.low for part in parts], axis=0)
    high = np.max([part.high for part in parts], axis=0)
    if low[0] < 0.03 or high[0] > wall_length(side, room.size) - 0.03 or high[2] > room.size[2] - 0.02:
        return False
    if parts[0].name.startswith("curtain"):
        return True
    return all(
        hole.side != side
        or high[0] < hole.start - 0.03
        or low[0] > hole.stop + 0.03
        or high[2] < hole.bottom - 0.03
        or low[2] > hole.top + 0.03
        for hole in (room.entrance, *room.openings)
    )


def _spots(
    room: Room,
    rng: np.random.Generator,
    size: tuple[float, float],
    height: float,
    draw: Callable[[float], list[Part]],
    near: Float[np.ndarray, "2"] | None = None,
) -> Iterator[Hung]:
    """A thing at all places along all walls, its middle at a height (m), in random order or from a point."""
    places: list[tuple[Side, float]] = [
        (side, float(at))
        for side in SIDES
        for at in np.arange(size[0] / 2 + 0.1, wall_length(side, room.size) - size[0] / 2 - 0.1, STEP)
    ]
    order = rng.permutation(len(places))
    if near is not None:
        points = [along_wall(side, room.size, (at, 0.0, 0.0), (at, 0.0, 0.0))[0, :2] for side, at in places]
        order = np.linalg.norm(np.array(points) - near, axis=1).argsort()
    for index in order.tolist():
        side, at = places[index]
        yield side, [_lifted(part, height) for part in draw(at)]


def _lifted(part: Part, height: float) -> Part:
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    return replace(part, low=(x0, y0, z0 + height), high=(x1, y1, z1 + height))


def _switches(room: Room) -> Iterator[Hung]:
    """A switch on either side of the entrance."""
    side = room.entrance.side
    for at in (room.entrance.stop + 0.18, room.entrance.start - 0.18, room.entrance.stop + 0.3):
        yield (
            side,
            [Part(name="switch", low=(at - 0.04, OFF, 1.06), high=(at + 0.04, 0.01, 1.14), color=WHITE)],
        )


def _windows(room: Room) -> list[tuple[Side, float, float, float, float]]:
    """Side, start, stop, bottom and top of windows: openings that touch are of one window."""
    found: list[list] = []
    for hole in room.windows:
        for window in found:
            if window[0] == hole.side and hole.start < window[2] + 0.05 and hole.stop > window[1] - 0.05:
                window[1:] = [
                    min(window[1], hole.start), max(window[2], hole.stop), min(window[3], hole.bottom),
                    max(window[4], hole.top),
                ]  # fmt: skip
                break
        else:
            found.append([hole.side, hole.start, hole.stop, hole.bottom, hole.top])
    return [(side, start, stop, bottom, top) for side, start, stop, bottom, top in found]


def _sky(room: Room, side: Side, hole: tuple[float, float, float, float], number: int) -> Fixture:
    """A plate with the colours of the sky outside of a window."""
    start, stop, bottom, top = hole
    away = -THICKNESS - 0.3
    low, high = along_wall(
        side,
        room.size,
        (start - 0.8, away - 0.02, bottom - 0.6),
        (stop + 0.8, away, min(top + 0.6, room.size[2] - 0.02)),
    )
    return Fixture(name=f"sky_{side}_{number}", low=corner(low), high=corner(high), color=SKY, pattern="sky")


def _lamps(room: Room, taken: Taken, cloth: Color) -> list[Fixture]:
    """Pendants in a row along the longer side of the room, where nothing opens, or flat lamps."""
    width, depth, height = room.size
    count = LAMPS.get(room.kind, 1)
    drop = 0.45 if room.kind in LAMPS else 0.03
    lamps = []
    for index in range(count):
        share = (index + 1) / (count + 1)
        x, y = (share * width, depth / 2) if width > depth else (width / 2, share * depth)
        radius, low = (0.19, height - drop - 0.2) if drop > 0.1 else (0.2, height - drop - 0.06)
        shade = Fixture(
            name=f"{PENDANT}_shade_{index}", low=corner(np.array([x - radius, y - radius, low])),
            high=corner(np.array([x + radius, y + radius, height - drop])),
            color=WHITE if drop < 0.1 else cloth, shape="cylinder",
        )  # fmt: skip
        cable = Fixture(
            name=f"{PENDANT}_cable_{index}", low=corner(np.array([x - 0.008, y - 0.008, height - drop])),
            high=corner(np.array([x + 0.008, y + 0.008, height - 1e-3])), color=METAL, shape="cylinder",
        )  # fmt: skip
        pair = [shade, cable]
        if taken.admits(np.array([(each.low, each.high) for each in pair]), GAP, stands=False):
            lamps += pair
    return lamps
