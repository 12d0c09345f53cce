"""Skirting boards, and tiles behind worktops, where nothing stands, moves or opens before the wall."""

from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from .patterns import Pattern
from .room import (
    SIDES,
    Fixture,
    Room,
    Side,
    along_wall,
    corner,
    from_wall,
    wall_length,
)
from .solids import fixture_solids, place_solid
from .taken import kept_free
from .worktops import HOOD_BOTTOM, WORKTOP

SKIRTING = (0.07, 0.012)
"""Height and thickness (m) of skirting boards."""
TILES = (1.445, 0.008)
"""Height to which tiles behind worktops reach, and their thickness (m)."""
WORKTOPS = (0.75, 1.05)
"""Range of heights (m) of worktops."""
NEAR_WALL = 0.12
"""Largest distance (m) of a worktop from its wall."""
SHORTEST = 0.08
"""Length (m) of the shortest piece."""
GAP = 0.001
"""Distance (m) of trim from what is beside it."""
LOOKS: dict[str, tuple[tuple[float, float, float], Pattern]] = {
    "skirting": ((0.93, 0.93, 0.91), "plain"), "tiles": ((0.90, 0.91, 0.89), "small_tiles"),
}  # fmt: skip
"""Colour and pattern of each trim."""


def trim_room(room: Room) -> Room:
    """The room with skirting boards and, in kitchens, tiles behind worktops."""
    shell = ("floor", "wall_")
    bodies = np.array(
        [
            *(box for placement in room.placements for box in kept_free(placement)),
            *((each.low, each.high) for each in room.fixtures if not each.name.startswith(shell)),
            np.zeros((2, 3)),
        ]
    )
    added: list[Fixture] = []
    for side in SIDES:
        boxes = from_wall(side, room.size, bodies)
        height, thickness = SKIRTING
        # The boards of the front and back wall end before those of the side walls.
        inset = 0.0 if side in ("left", "right") else thickness + GAP
        whole = (inset, wall_length(side, room.size) - inset)
        spans = _free_spans(room, side, boxes, whole, (0.0, height), thickness)
        added += _pieces(room, side, "skirting", spans, (0.0, height), thickness)
        worktop = _find_worktop(room, side) if room.kind == "kitchen" else None
        if worktop is not None:
            (start, stop, bottom), (top, thickness) = worktop, TILES
            rows = [((start, stop), (bottom + GAP, top)), *_above_ranges(room, side)]
            for number, (whole, up) in enumerate(rows):
                spans = _free_spans(room, side, boxes, whole, up, thickness)
                added += _pieces(room, side, "tiles", spans, up, thickness, number)
    return replace(room, fixtures=(*room.fixtures, *added))


def _above_ranges(room: Room, side: Side) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Ends along a wall and heights of what is bare between the ranges before it and their hoods."""
    found = []
    for placement in room.placements:
        boxes = from_wall(side, room.size, place_solid(placement).boxes)
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        if placement.role == "range" and low[1] < NEAR_WALL:
            found.append(((float(low[0]), float(high[0])), (float(high[2]) + GAP, HOOD_BOTTOM - GAP)))
    return found


def _find_worktop(room: Room, side: Side) -> tuple[float, float, float] | None:
    """Ends along a wall and height of the worktops before it: those of runs, else of sinks."""
    solids = [solid.boxes for solid in fixture_solids(room) if solid.id.startswith(WORKTOP)]
    tops = []
    sinks = [place_solid(placement).boxes for placement in room.placements if placement.role == "sink"]
    for around in solids or sinks:
        boxes = from_wall(side, room.size, around)
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        stands = bool(solids) or low[2] < WORKTOPS[0]
        if stands and WORKTOPS[0] <= high[2] <= WORKTOPS[1] and low[1] < NEAR_WALL:
            tops.append((low[0], high[0], high[2]))
    if not tops:
        return None
    starts, stops, heights = np.array(tops).T
    return float(starts.min()), float(stops.max()), float(heights.max())


def _free_spans(
    room: Room,
    side: Side,
    boxes: Float[np.ndarray, "B 2 3"],
    whole: tuple[float, float],
    up: tuple[float, float],
    thickness: float,
) -> list[tuple[float, float]]:
    """Parts of a span along a wall before which a slab meets no box and covers no opening."""
    meets = (
        (boxes[:, 0, 1] < thickness + GAP)
        & (boxes[:, 1, 1] > 0.0)
        & (boxes[:, 0, 2] < up[1] + GAP)
        & (boxes[:, 1, 2] > up[0] - GAP)
    )
    taken = [(low, high) for low, high in boxes[meets][:, :, 0].tolist()]
    for hole in (room.entrance, *room.openings):
        if hole.side == side and hole.bottom < up[1] and hole.top > up[0]:
            taken.append((hole.start, hole.stop))
    spans, at = [], whole[0]
    for low, high in [*sorted(taken), (whole[1] + GAP, whole[1])]:
        end = min(low - GAP, whole[1])
        if end - at >= SHORTEST:
            spans.append((at, end))
        at = max(at, high + GAP)
    return spans


def _pieces(
    room: Room,
    side: Side,
    name: Literal["skirting", "tiles"],
    spans: list[tuple[float, float]],
    up: tuple[float, float],
    thickness: float,
    number: int = 0,
) -> list[Fixture]:
    """Slabs on a wall along some spans, whose names have ``number`` unless it is 0."""
    color, pattern = LOOKS[name]
    pieces = []
    for index, (start, stop) in enumerate(spans):
        low, high = along_wall(side, room.size, (start, 0.0, up[0]), (stop, thickness, up[1]))
        place = f"{name}_{side}_{index}" + (f"_{number}" if number else "")
        pieces.append(Fixture(name=place, low=corner(low), high=corner(high), color=color, pattern=pattern))
    return pieces
