"""Whole buttons and dials: a stage of its own for knobs, of which a few cells are easily drawn as fragments.

A true button fills its box, as far as that sticks out of the panel. A dial fills about the disc in its box.
"""

import numpy as np
from jaxtyping import Bool, Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_joints, name_rows
from artigen.mending.rows import Owners
from artigen.types import PartLabel

KNOB: PartLabel = "knob"
ROUNDING = 1e-3
"""Cells that a box may reach into a cell without being in it."""
RIM = 0.25
"""Cells that the middle of a cell may lie outside of a disc that it belongs to."""
SURROUNDED = 0.5
"""Share of the ring around a knob that is panel in the layers that lie within the panel."""
ALIKE = 0.5
"""Intersection over union with its disc or its box below which a dial was drawn as a fragment: true ones have
more than that."""


def shape_knobs(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which buttons fill their boxes and dials are no fragments, and a note of the change.

    Where it sticks out of its panel, a knob may take cells of the panel; those of other parts stay theirs.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    before, owners = owners, owners.copy()
    kinds = name_joints(rows, layout)
    boxes, axes = rows[:, after_occupancy(layout.box)], rows[:, after_occupancy(layout.axis)]
    labels = np.array(name_rows(rows, layout))
    base, changed = labels == "base", 0
    for number in np.flatnonzero(labels == KNOB):
        mine, along = owners == number, int(np.abs(axes[number]).argmax())
        box = _fill_box(boxes[number], owners.shape)
        panel = (owners >= 0) & base[owners]
        room = mine | (owners < 0) | (panel & ~_find_within(panel, box, along))
        whole = box & room
        if kinds[number] in ("continuous", "revolute"):
            disc = _fill_disc(boxes[number], along, owners.shape) & room
            if max(_overlap(mine, disc), _overlap(mine, whole)) >= ALIKE:
                continue
            whole = disc
        if not whole.any() or (whole == mine).all():
            continue
        owners[mine], owners[whole] = -1, number
        changed += 1
    if not changed:
        return before, ()
    cells = int((owners != before).sum())
    return owners, (f"{changed} knobs were made whole, by {cells} cells",)


def _fill_box(box: Float[np.ndarray, "6"], shape: tuple[int, ...]) -> Bool[np.ndarray, "X Y Z"]:
    """The cells that a box reaches into."""
    away, half = _measure(box, shape)
    return np.logical_and.reduce([np.abs(away[axis]) < half[axis] + 0.5 - ROUNDING for axis in range(3)])


def _find_within(
    panel: Bool[np.ndarray, "X Y Z"], box: Bool[np.ndarray, "X Y Z"], along: int
) -> Bool[np.ndarray, "X Y Z"]:
    """The layers across an axis in which what surrounds a box is panel."""
    across = tuple(axis for axis in range(3) if axis != along)
    around = box
    for axis in across:
        around = around | np.roll(around, 1, axis) | np.roll(around, -1, axis)
    around &= ~box
    share = (panel & around).sum(axis=across) / around.sum(axis=across).clip(min=1)
    shape = [1, 1, 1]
    shape[along] = len(share)
    return np.broadcast_to((share >= SURROUNDED).reshape(shape), box.shape)


def _fill_disc(box: Float[np.ndarray, "6"], along: int, shape: tuple[int, ...]) -> Bool[np.ndarray, "X Y Z"]:
    """The cells of the disc (an ellipse) that a box holds, about an axis."""
    away, half = _measure(box, shape)
    across = [axis for axis in range(3) if axis != along]
    shares = [(np.abs(away[axis]) - RIM).clip(0.0) / max(half[axis], 0.5) for axis in across]
    return (np.abs(away[along]) < half[along] + 0.5 - ROUNDING) & (np.hypot(*shares) <= 1.0)


def _measure(
    box: Float[np.ndarray, "6"], shape: tuple[int, ...]
) -> tuple[Float[np.ndarray, "3 X Y Z"], Float[np.ndarray, "3"]]:
    """How far the middles of cells are from that of a box, along each axis, and half the box, in cells."""
    middle = (box[:3] + 0.5) * shape[0]
    return np.indices(shape) + 0.5 - middle[:, None, None, None], box[3:] * shape[0] / 2.0


def _overlap(one: Bool[np.ndarray, "X Y Z"], other: Bool[np.ndarray, "X Y Z"]) -> float:
    return float((one & other).sum() / max((one | other).sum(), 1))
