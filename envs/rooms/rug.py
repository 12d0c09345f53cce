"""Rugs: where one of a room lies."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.types import SceneKind
from sim_export.geometry.triangles import bounds_of

from .hangings import OFF
from .patterns import Color
from .room import Fixture, Room, corner
from .solids import place_solid
from .taken import Taken, find_taken

GAP = 0.004
"""Distance (m) of decoration from what is beside it."""
STEP = 0.1
"""Step (m) of places along a wall."""
RUGS: dict[SceneKind, tuple[tuple[float, float], ...]] = {
    "living_room": ((2.4, 1.7), (2.0, 1.4), (1.6, 1.0), (1.2, 0.7)),
    "bedroom": ((1.6, 1.0), (1.3, 0.7), (1.0, 0.6)),
    "office": ((2.0, 1.4), (1.4, 0.9)),
    "bathroom": ((0.8, 0.5), (0.6, 0.45)),
    "hall": ((1.4, 0.7), (1.0, 0.6), (0.7, 0.45)),
    "kitchen": ((1.2, 0.55), (0.8, 0.5)),
}
"""Length and width (m) of rugs, the largest first."""


def lay_rug(room: Room, taken: Taken, cloth: Color, rng: np.random.Generator) -> tuple[Room, list[Fixture]]:
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
