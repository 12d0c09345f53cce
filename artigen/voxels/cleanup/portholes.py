"""Makes doors before drums, and the openings that they close, round.

A network draws the mean of a ring and its box: doors with cut corners over ragged holes. What turns without
end about an axis that faces the front is a drum; all procedural machines that are loaded there have a round
door, with an opening of 0.72 to 0.80 of its radius. So have washing machines whose drum does not turn.
"""

import numpy as np
from jaxtyping import Bool, Float

from artigen.voxels.cleanup.boxes import reach_box
from artigen.voxels.cleanup.panel import find_panel
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import (
    DEFAULT_LAYOUT,
    FieldLayout,
    after_occupancy,
    name_category,
    name_joints,
    name_rows,
)

OBLONG = 1.25
"""Largest ratio of width and height of a round door, either way."""
MOUTH, RIM = 0.72, 0.80
"""Shares of the door's radius within which the opening is free, and beyond which the plate around it is
whole."""
WASHING = "WashingMachine"
"""Category whose doors are round, with a drum or without."""
PLATE = 7
"""Layers behind the panel of the door in which the plate of the body is sought: the fullest of them."""
WHOLE = 0.7
"""Share of the rim of a door in a layer from which on all of it is there."""
AROUND = 3
"""Cells beyond the door in which the plate is looked at."""


def round_portholes(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which doors before drums are round, and a note of how many cells that changed.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    before, owners = owners, owners.copy()
    labels, kinds = np.array(name_rows(rows, layout)), np.array(name_joints(rows, layout))
    boxes, axes = rows[:, after_occupancy(layout.box)], rows[:, after_occupancy(layout.axis)]
    washing = name_category(rows, layout) == WASHING
    drums = boxes[(labels == "tray") & (kinds == "continuous") & (np.abs(axes).argmax(axis=1) == 0)]
    for door in np.flatnonzero((labels == "door") & (kinds == "revolute")):
        center, size = boxes[door, :3], boxes[door, 3:]
        near = (np.abs(drums[:, 1:3] - center[1:]) < size[1:] / 4).all(axis=1) & (drums[:, 0] > center[0])
        upright = size[0] < size[1:].min() and max(size[1] / size[2], size[2] / size[1]) <= OBLONG
        if upright and (near.any() or washing):
            _round_door(owners, int(door), labels == "base", boxes[door])
    changed = int((owners != before).sum())
    return owners, (f"{changed} cells were changed to make a door and its opening round",) if changed else ()


def _round_door(
    owners: Owners, door: int, bodies: Bool[np.ndarray, "N"], box: Float[np.ndarray, "6"]
) -> None:
    """Makes a door that faces -x, and the plate of the body behind its panel, round, in place."""
    _, *sides = reach_box(box, len(owners), AROUND)
    y, z = (  # from the middle of the door, in halves of its edges
        ((np.arange(side.start, side.stop) + 0.5) / len(owners) - 0.5 - box[axis]) / (box[3 + axis] / 2)
        for axis, side in enumerate(sides, start=1)
    )
    y, z = y[:, None], z[None]
    radius = np.hypot(y, z)
    view = owners[:, *sides]  # D H W, in place
    mine, inside = view == door, radius <= 1.0
    if not mine.any():
        return
    panel, square = find_panel(mine), (np.abs(y) <= 1.0) & (np.abs(z) <= 1.0)
    own = bodies[view] & (view >= 0)
    held = own[panel.stop : panel.stop + PLATE, ~square].mean(axis=1)
    plate = panel.stop + int(held.argmax()) if held.any() else len(view)
    kept = mine & inside
    kept[plate + 1 :] &= radius <= RIM
    kept[panel] |= inside & ~mine.any(axis=0) & (view[panel] < 0)
    rim = inside & (radius > RIM)
    whole = kept[:plate, rim].mean(axis=1) >= WHOLE
    kept[:plate][whole] |= rim & (view[:plate][whole] < 0)
    owners[owners == door] = -1
    view[kept] = door
    if plate < len(view):
        mouth = slice(panel.stop, plate + 1)
        view[mouth][own[mouth] & (radius < MOUTH)] = -1
        layer = view[plate]
        layer[(layer < 0) & (radius > RIM) & square] = bodies.argmax()
