"""Removes cells of open doors that block what slides out behind them.

A drawer in a fridge comes out past the open door. Where bins, or the edge at the hinge, were drawn at its
height so deep that they stand before it then, they make way: all but the front of the panel does.
"""

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from artigen.voxels.cleanup.panel import find_panel
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_joints, name_rows


def clear_doorways(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which doors, open, do not stand before what slides out behind them, and a note of what went.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    owners, labels = owners.copy(), name_rows(rows, layout)
    kinds = np.array(name_joints(rows, layout))
    boxes = rows[:, after_occupancy(layout.box)]
    gone = 0
    for door in np.flatnonzero((np.array(labels) == "door") & (kinds == "revolute")):
        behind = [
            row
            for row in np.flatnonzero(np.isin(labels, ("drawer", "tray")) & (kinds == "prismatic"))
            if _is_behind(boxes[row], boxes[door]) and (owners == row).any()
        ]
        mine = owners == door
        if not behind or not mine.any():
            continue
        cells = np.argwhere(mine)
        cells = cells[cells[:, 0] > find_panel(mine).start]  # doors face -x
        opened = _open(cells, rows[door], len(owners), layout)
        blocking = np.zeros(len(cells), dtype=bool)
        for row in behind:
            there = np.argwhere(owners == row)
            low, high = there.min(axis=0) + SLACK, there.max(axis=0) + 1 - SLACK
            blocking |= ((opened > low - 0.5) & (opened < high + 0.5))[:, 1:].all(axis=1) & (
                opened[:, 0] < high[0]
            )
        owners[tuple(cells[blocking].T)] = -1
        gone += int(blocking.sum())
    if not gone:
        return owners, ()
    note = f"{gone} cells on the inside of doors were removed that would stand before a drawer when open"
    return owners, (note,)


SLACK = 0.25
"""Cells that a drawer may be missed by."""
BESIDE = 1 / 64
"""Unit-cube lengths by which what lies beside a door may reach behind it."""


def _is_behind(inner: Float[np.ndarray, "6"], door: Float[np.ndarray, "6"]) -> bool:
    """Whether a part lies behind a door, or behind that and the other of a pair."""
    apart = np.abs(inner[1:3] - door[1:3])
    shared = (inner[4] + door[4]) / 2 - apart[0]
    return bool(shared > BESIDE and apart[1] <= door[5] / 2 and inner[0] > door[0])


def _open(
    cells: np.ndarray, row: Float[np.ndarray, "C"], resolution: int, layout: FieldLayout
) -> Float[np.ndarray, "K 3"]:
    """The middles of cells of a door when it stands open, in cells."""
    origin = (row[after_occupancy(layout.origin)] + 0.5) * resolution
    turn = row[layout.range.start - 1] * layout.rotation_unit
    rotation = Rotation.from_rotvec(turn * row[after_occupancy(layout.axis)])
    return rotation.apply(cells + 0.5 - origin) + origin
