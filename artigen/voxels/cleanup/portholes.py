"""Rounds doors before drums, and the openings that they close.

A network draws the mean of a ring and its box: doors with cut corners over ragged holes. A tray that rotates
continuously about a front-to-back axis is a drum. All procedural machines with a drum behind a door have a
round door, whose opening has 0.72 to 0.80 of its radius. So have kinds with round doors whose drum does not
rotate.
"""

import numpy as np
from jaxtyping import Bool, Float

from artigen.kind import find_kind
from artigen.voxels.cleanup.boxes import reach_box
from artigen.voxels.cleanup.panel import find_panel
from artigen.voxels.cleanup.rows import Owners, note_changes
from artigen.voxels.fields import ROW, name_category, name_joints, name_rows

OBLONG = 1.25
"""Largest ratio of width and height of a round door, either way."""
MOUTH, RIM = 0.72, 0.80
"""Shares of the door's radius: the opening is clear within the first, the plate whole beyond the second."""
PLATE = 7
"""Layers behind the panel of the door in which the plate of the body is sought; the fullest is taken."""
WHOLE = 0.7
"""Share of the rim of a door from which on a layer's rim is completed."""
AROUND = 3
"""Cells beyond the door in which the plate is sought."""


def round_portholes(owners: Owners, rows: Float[np.ndarray, "N C"]) -> tuple[Owners, tuple[str, ...]]:
    """Rounds doors before drums; returns owners and a note of how many cells changed."""
    before, owners = owners, owners.copy()
    labels, kinds = np.array(name_rows(rows)), np.array(name_joints(rows))
    boxes, axes = rows[:, ROW.box], rows[:, ROW.axis]
    kind = find_kind(name_category(rows) or "")
    rounded = kind is not None and kind.channel is not None and kind.channel.round_door
    drums = boxes[(labels == "tray") & (kinds == "continuous") & (np.abs(axes).argmax(axis=1) == 0)]
    for door in np.flatnonzero((labels == "door") & (kinds == "revolute")):
        center, size = boxes[door, :3], boxes[door, 3:]
        near = (np.abs(drums[:, 1:3] - center[1:]) < size[1:] / 4).all(axis=1) & (drums[:, 0] > center[0])
        upright = size[0] < size[1:].min() and max(size[1] / size[2], size[2] / size[1]) <= OBLONG
        if upright and (near.any() or rounded):
            _round_door(owners, int(door), labels == "base", boxes[door])
    return note_changes(before, owners, "cells were changed to make a door and its opening round")


def _round_door(
    owners: Owners, door: int, bodies: Bool[np.ndarray, "N"], box: Float[np.ndarray, "6"]
) -> None:
    """Rounds a door that faces -x, and the opening in the body's plate behind its panel, in place."""
    _, *sides = reach_box(box, len(owners), AROUND)
    y, z = (  # offsets from the door's centre, in half edges
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
