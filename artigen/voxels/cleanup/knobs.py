"""Completes buttons and dials of which only fragments were sampled.

A true button fills its box, as far as that sticks out of the panel. A dial fills about the disc in its box.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_dilation

from artigen.types import PartLabel
from artigen.voxels.cleanup.boxes import reach_box
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_joints, name_rows

KNOB: PartLabel = "knob"
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
        place, box = reach_box(boxes[number], len(owners)), np.zeros(owners.shape, dtype=bool)
        box[place] = True
        panel = (owners >= 0) & base[owners]
        room = mine | (owners < 0) | (panel & ~_find_within(panel, box, along))
        whole = box & room
        if kinds[number] in ("continuous", "revolute"):
            disc = _fill_disc(boxes[number], place[along], along, owners.shape) & room
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


def _find_within(
    panel: Bool[np.ndarray, "X Y Z"], cells: Bool[np.ndarray, "X Y Z"], along: int
) -> Bool[np.ndarray, "X Y Z"]:
    """The layers across an axis in which what surrounds the cells of a box is panel."""
    across = tuple(axis for axis in range(3) if axis != along)
    square = np.ones([1 if axis == along else 3 for axis in range(3)])
    around = binary_dilation(cells, square) & ~cells
    share = (panel & around).sum(axis=across, keepdims=True) / around.sum(axis=across, keepdims=True).clip(1)
    return np.broadcast_to(share >= SURROUNDED, cells.shape)


def _fill_disc(
    box: Float[np.ndarray, "6"], layers: slice, along: int, shape: tuple[int, ...]
) -> Bool[np.ndarray, "X Y Z"]:
    """The cells of the disc (an ellipse) that a box holds, in given layers across an axis."""
    shares = []
    for axis in (axis for axis in range(3) if axis != along):
        away = np.abs(np.arange(shape[axis]) + 0.5 - (box[axis] + 0.5) * shape[0])
        shares.append((away - RIM).clip(0.0) / max(box[3 + axis] * shape[0] / 2.0, 0.5))
    out = np.zeros(shape, dtype=bool)
    np.moveaxis(out, along, 0)[layers] = np.hypot.outer(*shares) <= 1.0
    return out


def _overlap(one: Bool[np.ndarray, "X Y Z"], other: Bool[np.ndarray, "X Y Z"]) -> float:
    return float((one & other).sum() / max((one | other).sum(), 1))
