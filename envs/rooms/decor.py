"""What is fixed to walls and ceiling, and lies on the floor: curtains and sky at windows, pictures, mirrors,
towels, switches and sockets, lamps, rugs.

Everything is a box or cylinder with collision, where nothing stands, moves or opens.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice, pairwise, product

import numpy as np
from jaxtyping import Float

from artigen.types import SceneKind
from sim_export.geometry.triangles import bounds_of

from .patterns import Color, Pattern
from .room import SIDES, THICKNESS, Fixture, Room, Side, along_wall, corner, wall_length
from .solids import place_solid
from .taken import Taken, find_taken
from .views import PENDANT

GAP = 0.004
"""Distance (m) of decoration from what is beside it."""
BESIDE = 0.04
"""Distance (m) of what hangs on a wall from what is beside it."""
OFF = 5e-4
"""Distance (m) between a wall and what hangs on it."""
STEP = 0.1
"""Step (m) of places along a wall."""
FRAMES: tuple[Color, ...] = ((0.16, 0.15, 0.15), (0.55, 0.40, 0.28), (0.92, 0.91, 0.88))
CLOTHS: tuple[Color, ...] = (
    (0.80, 0.77, 0.70), (0.55, 0.62, 0.66), (0.72, 0.66, 0.60), (0.60, 0.64, 0.55), (0.74, 0.60, 0.52),
)  # fmt: skip
PAINTS: tuple[tuple[Color, Color], ...] = (
    ((0.90, 0.88, 0.82), (0.30, 0.42, 0.50)), ((0.86, 0.80, 0.70), (0.62, 0.36, 0.27)),
    ((0.88, 0.90, 0.88), (0.36, 0.48, 0.38)), ((0.22, 0.28, 0.36), (0.85, 0.72, 0.45)),
)  # fmt: skip
"""Ground and shape of pictures."""
COATS: tuple[Color, ...] = ((0.20, 0.24, 0.32), (0.55, 0.30, 0.24), (0.62, 0.56, 0.44), (0.30, 0.34, 0.28))
TOOLS: tuple[tuple[float, float, float, Color], ...] = (
    (0.03, 0.28, 0.12, (0.50, 0.31, 0.20)), (0.02, 0.24, 0.05, (0.62, 0.63, 0.64)),
    (0.10, 0.42, 0.07, (0.70, 0.71, 0.73)), (0.03, 0.20, 0.03, (0.78, 0.33, 0.23)),
    (0.035, 0.3, 0.15, (0.88, 0.75, 0.40)),
)  # fmt: skip
"""Width and length of handles, width of heads (m), and colours of tools on a board."""
BLACK, SCREEN = (0.09, 0.09, 0.10), (0.05, 0.06, 0.08)
WHITE, METAL, GLASS, SKY = (0.95, 0.95, 0.94), (0.62, 0.63, 0.64), (0.80, 0.86, 0.89), (0.66, 0.80, 0.95)
RUGS: dict[SceneKind, tuple[tuple[float, float], ...]] = {
    "living_room": ((2.4, 1.7), (2.0, 1.4), (1.6, 1.0), (1.2, 0.7)),
    "bedroom": ((1.6, 1.0), (1.3, 0.7), (1.0, 0.6)),
    "office": ((2.0, 1.4), (1.4, 0.9)),
    "bathroom": ((0.8, 0.5), (0.6, 0.45)),
    "hall": ((1.4, 0.7), (1.0, 0.6), (0.7, 0.45)),
    "kitchen": ((1.2, 0.55), (0.8, 0.5)),
}
"""Length and width (m) of rugs, the largest first."""
PICTURES: dict[SceneKind, int] = {
    "living_room": 4, "bedroom": 3, "office": 2, "hall": 2, "kitchen": 1,
}  # fmt: skip
CURTAINED = ("living_room", "bedroom", "office")
LAMPS: dict[SceneKind, int] = {"living_room": 1, "bedroom": 1, "kitchen": 2, "office": 2, "hall": 1}
"""Pendants; other rooms have a flat lamp."""
NEAR = 8
"""Number of places near a lowboard at which a television may hang."""
ON_WALLS = (
    "curtain",
    "picture",
    "mirror",
    "towel",
    "switch",
    "socket",
    "sky",
    "television",
    "coats",
    "tools",
)
"""Beginnings of the names of what hangs on a wall; its side follows."""


@dataclass(frozen=True, kw_only=True)
class _Part:
    """A box on a wall: name, from and to (along the wall, out of it, up), looks."""

    name: str
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    color: Color
    pattern: Pattern = "plain"


Hung = tuple[Side, list[_Part]]
"""Parts on a wall."""


def decorate_room(room: Room) -> Room:
    """The room with what hangs on its walls and ceiling and lies on its floor, selected by its seed."""
    rng = np.random.default_rng([room.seed, room.attempt, 4])
    taken, added = find_taken(room), []
    cloth = CLOTHS[int(rng.integers(len(CLOTHS)))]
    frame = FRAMES[int(rng.integers(len(FRAMES)))]

    def hang(side: Side, parts: Sequence[_Part]) -> bool:
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
            _first(hang, _curtains(side, (start, stop, bottom, top), cloth))
    _first(hang, _switches(room))
    if room.kind in ("bathroom", "hall"):
        sinks = [np.array(each.position[:2]) for each in room.placements if each.role == "sink"]
        near = sinks[0] if sinks else None
        _first(hang, _spots(room, rng, (0.5, 0.7), 1.6, lambda at: _mirror(at, frame), near))
    if room.kind in ("bathroom", "kitchen"):
        _first(hang, _spots(room, rng, (0.5, 0.5), 1.15, lambda at: _towel(at, cloth)))
    for board in (each for each in room.placements if each.role == "lowboard"):
        at = np.array(board.position[:2])
        above = _spots(room, rng, (1.14, 0.66), board.size[2] + 0.55, _television, at)
        _first(hang, islice(above, NEAR))
    for bench in (each for each in room.placements if room.kind == "workshop" and each.role == "desk"):
        at = np.array(bench.position[:2])
        _first(hang, islice(_spots(room, rng, (1.0, 0.64), 1.5, _tools, at), NEAR))
    if room.kind == "hall":
        _first(hang, _spots(room, rng, (0.9, 1.0), 1.2, lambda at: _coats(at, rng)))
    for _ in range(PICTURES.get(room.kind, 0)):
        wide, high, share = rng.uniform((0.35, 0.35, 0.25), (0.8, 0.6, 0.7)).tolist()
        paint = PAINTS[int(rng.integers(len(PAINTS)))]
        draw = partial(_picture, size=(wide, high), frame=frame, paint=paint, share=share)
        _first(hang, _spots(room, rng, (wide, high), 1.58, draw))
    for _ in range(3):
        _first(hang, _spots(room, rng, (0.08, 0.08), 0.3, _socket))
    room, floor = _lay_rug(room, taken, cloth, rng)
    lamps = _lamps(room, taken, cloth)
    return replace(room, fixtures=(*room.fixtures, *added, *floor, *lamps))


def _first(hang: Callable[[Side, list[_Part]], bool], candidates: Iterator[Hung]) -> None:
    """Hangs up the first that fits."""
    for side, parts in candidates:
        if hang(side, parts):
            return


def _on_wall(
    room: Room, side: Side, parts: Sequence[_Part], number: int
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


def _is_free(room: Room, side: Side, parts: Sequence[_Part]) -> bool:
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
    draw: Callable[[float], list[_Part]],
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


def _lifted(part: _Part, height: float) -> _Part:
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    return replace(part, low=(x0, y0, z0 + height), high=(x1, y1, z1 + height))


def _picture(
    at: float, size: tuple[float, float], frame: Color, paint: tuple[Color, Color], share: float
) -> list[_Part]:
    (w, h), rim = (size[0] / 2, size[1] / 2), 0.02
    ground, shape = paint
    return [
        _Part(name="picture_frame", low=(at - w, OFF, -h), high=(at + w, 0.018, h), color=frame),
        _Part(
            name="picture_ground", low=(at - w + rim, 0.018, rim - h), high=(at + w - rim, 0.02, h - rim),
            color=ground,
        ),
        _Part(
            name="picture_shape", low=(at - 0.6 * w, 0.02, -0.7 * h),
            high=(at + 0.6 * w, 0.021, h * (2 * share - 0.7)), color=shape,
        ),
    ]  # fmt: skip


def _mirror(at: float, frame: Color) -> list[_Part]:
    return [
        _Part(name="mirror_frame", low=(at - 0.25, OFF, -0.35), high=(at + 0.25, 0.018, 0.35), color=frame),
        _Part(
            name="mirror_glass", low=(at - 0.235, 0.018, -0.335), high=(at + 0.235, 0.02, 0.335), color=GLASS
        ),
    ]


def _television(at: float) -> list[_Part]:
    low, high = (at - 0.57, 0.03, -0.33), (at + 0.57, 0.06, 0.33)
    return [
        _Part(name="television_mount", low=(at - 0.2, OFF, -0.1), high=(at + 0.2, 0.03, 0.1), color=BLACK),
        _Part(name="television_body", low=low, high=high, color=BLACK),
        _Part(
            name="television_screen", low=(at - 0.555, 0.06, -0.315), high=(at + 0.555, 0.061, 0.315),
            color=SCREEN,
        ),
    ]  # fmt: skip


def _tools(at: float) -> list[_Part]:
    """A board with tools that hang by their heads."""
    low, high = (at - 0.5, OFF, -0.32), (at + 0.5, 0.015, 0.32)
    parts = [_Part(name="tools_board", low=low, high=high, color=FRAMES[1])]
    for index, (wide, long, head, color) in enumerate(TOOLS):
        x = at - 0.4 + 0.2 * index
        low, high = (x - wide / 2, 0.015, 0.2 - long), (x + wide / 2, 0.035, 0.2)
        parts.append(_Part(name="tools_handle", low=low, high=high, color=color))
        low, high = (x - head / 2, 0.015, 0.2), (x + head / 2, 0.04, 0.25)
        parts.append(_Part(name="tools_head", low=low, high=high, color=METAL))
    return parts


FOLDS = (
    ("loop", -0.02, 0.02, 0.07, 0.45, 0.52), ("collar", -0.045, 0.045, 0.09, 0.38, 0.47),
    ("middle", -0.035, 0.03, 0.12, -0.42, 0.4), ("left", -0.075, -0.03, 0.1, -0.4, 0.38),
    ("right", 0.025, 0.07, 0.105, -0.43, 0.37), ("left_sleeve", -0.105, -0.07, 0.08, -0.2, 0.33),
    ("right_sleeve", 0.065, 0.1, 0.09, -0.23, 0.32),
)  # fmt: skip
"""Folds of a coat on a hook: from and to along the wall, out of it, and up (m)."""


def _coats(at: float, rng: np.random.Generator) -> list[_Part]:
    """A board with four hooks and coats on two or three of them."""
    low, high = (at - 0.45, OFF, 0.48), (at + 0.45, 0.02, 0.58)
    parts = [_Part(name="coats_board", low=low, high=high, color=FRAMES[1])]
    coats = rng.permutation(4)[: int(rng.integers(2, 4))]
    for hook in range(4):
        x = at - 0.33 + 0.22 * hook
        low, high = (x - 0.01, 0.02, 0.51), (x + 0.01, 0.08, 0.53)
        parts.append(_Part(name="coats_hook", low=low, high=high, color=METAL))
        if hook in coats:
            cloth = COATS[int(rng.integers(len(COATS)))]
            parts += [
                _Part(
                    name=f"coats_{name}", low=(x + left, 0.03, foot - 0.08 * (hook % 2) * (foot < 0.0)),
                    high=(x + right, depth, top), color=cloth, pattern="cloth",
                )
                for name, left, right, depth, foot, top in FOLDS
            ]  # fmt: skip
    return parts


def _towel(at: float, cloth: Color) -> list[_Part]:
    return [
        _Part(name="towel_rail", low=(at - 0.25, 0.06, 0.18), high=(at + 0.25, 0.075, 0.195), color=METAL),
        _Part(name="towel_left", low=(at - 0.25, OFF, 0.18), high=(at - 0.235, 0.06, 0.195), color=METAL),
        _Part(name="towel_right", low=(at + 0.235, OFF, 0.18), high=(at + 0.25, 0.06, 0.195), color=METAL),
        _Part(
            name="towel_cloth", low=(at - 0.2, 0.045, -0.25), high=(at + 0.1, 0.06, 0.18), color=cloth,
            pattern="cloth",
        ),
    ]  # fmt: skip


def _socket(at: float) -> list[_Part]:
    return [_Part(name="socket", low=(at - 0.04, OFF, -0.04), high=(at + 0.04, 0.01, 0.04), color=WHITE)]


def _switches(room: Room) -> Iterator[Hung]:
    """A switch on either side of the entrance."""
    side = room.entrance.side
    for at in (room.entrance.stop + 0.18, room.entrance.start - 0.18, room.entrance.stop + 0.3):
        yield (
            side,
            [_Part(name="switch", low=(at - 0.04, OFF, 1.06), high=(at + 0.04, 0.01, 1.14), color=WHITE)],
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


def _curtains(side: Side, hole: tuple[float, float, float, float], cloth: Color) -> Iterator[Hung]:
    """Ways to dress a window: a rod with a curtain on both sides, to the floor or else to below the sill, as
    near as the window opens past them; or else a blind, rolled up above it."""
    start, stop, bottom, top = hole
    for wide, beside, foot in product((0.29, 0.17), (0.05, 0.13, 0.21), (0.09, bottom - 0.1)):
        reach = beside + wide + 0.02
        parts = [
            _Part(
                name="curtain_rod", low=(start - reach, 0.06, top + 0.1),
                high=(stop + reach, 0.08, top + 0.12), color=METAL,
            )
        ]  # fmt: skip
        for name, near in (("left", start - beside - wide), ("right", stop + beside)):
            folds = np.linspace(near, near + wide, 6).tolist()
            parts += [
                _Part(
                    name=f"curtain_{name}", low=(a, 0.045 + 0.02 * (index % 2), foot),
                    high=(b, 0.075 + 0.02 * (index % 2), top + 0.095), color=cloth, pattern="cloth",
                )
                for index, (a, b) in enumerate(pairwise(folds))
            ]  # fmt: skip
        yield side, parts
    low, high = (start, OFF, top + 0.06), (stop, 0.07, top + 0.13)
    yield side, [_Part(name="curtain_blind", low=low, high=high, color=cloth, pattern="cloth")]


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


def _lay_rug(room: Room, taken: Taken, cloth: Color, rng: np.random.Generator) -> tuple[Room, list[Fixture]]:
    """A rug under the low table, which then stands on it; else at the free place nearest to what people sit
    and lie on, or to the middle of the room."""
    color = corner(np.clip(np.array(cloth) * rng.uniform(0.6, 0.95), 0.0, 1.0))
    for table in (each for each in room.placements if each.role == "low table"):
        others = tuple(each for each in room.placements if each.id != table.id)
        body = bounds_of(place_solid(table).boxes.reshape(-1, 3))
        free = find_taken(replace(room, placements=others))
        rug = _rug(room, free, body[:, :2].mean(axis=0)[None], color, body)
        if rug is not None:
            lift = np.array([0.0, 0.0, rug.high[2]])
            placements = tuple(
                replace(each, position=corner(each.position + lift))
                if table.id in (each.id, each.support)
                else each
                for each in room.placements
            )
            return replace(room, placements=placements), [rug]
    seats = ("bed", "sofa", "bench", "armchair")
    boxes = np.array([(f.low, f.high) for f in room.fixtures if f.name.startswith(seats)]).reshape(-1, 2, 3)
    toilets = [p.position for p in room.placements if p.role in ("toilet", "sink")]
    middle = np.array(room.size[:2]) / 2.0
    points = [*boxes.mean(axis=1)[:, :2], *(np.array(point[:2]) for point in toilets)] or [middle]
    rug = _rug(room, taken, np.array(points), color)
    return room, [] if rug is None else [rug]


def _rug(
    room: Room,
    taken: Taken,
    points: Float[np.ndarray, "P 2"],
    color: Color,
    below: Float[np.ndarray, "2 3"] | None = None,
) -> Fixture | None:
    """The largest rug with a free place, as near to one of the points as can be, and all ``below`` a box."""
    middle = np.array(room.size[:2]) / 2.0
    low = Taken(solid=taken.solid[taken.solid[:, 0, 2] < 0.01 + GAP], stands=taken.stands)
    for length, width in RUGS.get(room.kind, ()):
        found = []
        for x, y in ((length, width), (width, length)):
            for left in np.arange(0.05, room.size[0] - x - 0.05, STEP):
                for front in np.arange(0.4, room.size[1] - y - 0.05, STEP):
                    at, half = np.array([left + x / 2, front + y / 2]), np.array([x, y]) / 2
                    if below is None or (np.abs(below[:, :2] - at) < half).all():
                        far = float(np.linalg.norm(points - at, axis=1).min())
                        found.append((far + 0.3 * float(np.linalg.norm(at - middle)), left, front, x, y))
        for _, left, front, x, y in sorted(found):
            box = np.array([[left, front, OFF], [left + x, front + y, 0.006]])
            if low.admits(box[None], GAP, stands=False):
                return Fixture(
                    name="rug", low=corner(box[0]), high=corner(box[1]), color=color, pattern="cloth"
                )
    return None


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
