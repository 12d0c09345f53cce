"""Completes buttons and dials of which only fragments were sampled.

A button fills its box as far as the box sticks out of the panel. A dial roughly fills the disc in its box.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_dilation

from artigen.types import PartLabel
from artigen.voxels.cleanup.boxes import reach_box
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import ROW, name_joints, name_rows

KNOB: PartLabel = "knob"
RIM = 0.25
"""Cells by which the centre of a cell may lie outside a disc that it belongs to."""
SURROUNDED = 0.5
"""Share of the ring around a knob that is panel from which a layer counts as within the panel."""
ALIKE = 0.5
"""Intersection over union with its disc or box below which a dial is a fragment; intact dials have more."""


def shape_knobs(owners: Owners, rows: Float[np.ndarray, "N C"]) -> tuple[Owners, tuple[str, ...]]:
    """Fills the boxes of buttons and the discs of fragmentary dials; returns owners and a note.

    A knob may take cells of the panel where it sticks out of it, but no cells of other parts.

    Args:
        owners: Row of the outline per cell, -1 where empty.
        rows: The outline: channels after occupancy, one row per part.
    """
    before, owners = owners, owners.copy()
    kinds = name_joints(rows)
    boxes, axes = rows[:, ROW.box], rows[:, ROW.axis]
    labels = np.array(name_rows(rows))
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
    """Mask of the layers along an axis in which most of the ring around a box is panel."""
    across = tuple(axis for axis in range(3) if axis != along)
    square = np.ones([1 if axis == along else 3 for axis in range(3)])
    around = binary_dilation(cells, square) & ~cells
    share = (panel & around).sum(axis=across, keepdims=True) / around.sum(axis=across, keepdims=True).clip(1)
    return np.broadcast_to(share >= SURROUNDED, cells.shape)


def _fill_disc(
    box: Float[np.ndarray, "6"], layers: slice, along: int, shape: tuple[int, ...]
) -> Bool[np.ndarray, "X Y Z"]:
    """The cells of the disc (an ellipse) inscribed in a box, in given layers along an axis."""
    shares = []
    for axis in (axis for axis in range(3) if axis != along):
        away = np.abs(np.arange(shape[axis]) + 0.5 - (box[axis] + 0.5) * shape[0])
        shares.append((away - RIM).clip(0.0) / max(box[3 + axis] * shape[0] / 2.0, 0.5))
    out = np.zeros(shape, dtype=bool)
    np.moveaxis(out, along, 0)[layers] = np.hypot.outer(*shares) <= 1.0
    return out


def _overlap(one: Bool[np.ndarray, "X Y Z"], other: Bool[np.ndarray, "X Y Z"]) -> float:
    return float((one & other).sum() / max((one | other).sum(), 1))
