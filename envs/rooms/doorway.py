"""Hangs a door in the entrance of a room."""

from dataclasses import replace

import numpy as np

from .arrange import Place, Plan
from .footprints import bounds_of
from .pieces import GAP, line_up, move_boxes, shift_boxes
from .recipes import DOOR
from .room import THICKNESS, YAWS, turn_matrix
from .runs import Chooser

LINTEL = 0.1
"""Least height (m) of the wall above a door."""
AWAY = (0.25, 0.75)
"""Share of the free wall on one side of a door: the corners are left to furniture along the side walls."""


def hang_door(plan: Plan, chooser: Chooser, span: tuple[float, float] | None = None) -> Plan:
    """The plan with a door in the middle of the front wall's thickness, opening into the room.

    The entrance becomes as large as the frame. Without a door that fits, the plan stays as it is.

    Args:
        span: Stretch of the wall (m along it) for the frame; default: all of it.
    """
    entries = chooser.shortlists[DOOR.name]
    if not entries:
        return plan
    piece = chooser.piece(entries[int(chooser.rng.integers(len(entries)))], DOOR.name)
    cluster = line_up("door", [piece])
    turn = turn_matrix(YAWS["front"])
    boxes = move_boxes(cluster.boxes, turn)
    low, high = bounds_of(boxes.all)
    frame = bounds_of(boxes.bodies)[:, 0]
    _, width, height = piece.box[1] - piece.box[0]
    first, last = (0.0, plan.size[0]) if span is None else (span[0] + GAP, span[1] - GAP)
    # Neither the frame may leave its stretch of the wall, nor the swing the room.
    start, stop = max(first - frame[0], -low[0]), min(last - frame[1], plan.size[0] - high[0])
    shift = np.array([start + chooser.rng.uniform(*AWAY) * (stop - start), 0.0, 0.0])
    shift[1] = -(THICKNESS + float(piece.box[1, 0]) - piece.face) / 2.0
    if stop < start or high[1] + shift[1] > plan.size[1] or height + 2 * GAP > plan.size[2] - LINTEL:
        return plan
    T = turn.copy()
    T[:3, 3] = shift
    entrance = replace(
        plan.entrance,
        start=float(frame[0] + shift[0]) - GAP,
        width=float(width) + 2 * GAP,
        height=float(height) + 2 * GAP,
    )
    place = Place(cluster=cluster, T=T, boxes=shift_boxes(boxes, shift), side=None)
    return replace(plan, entrance=entrance).with_place(place)
