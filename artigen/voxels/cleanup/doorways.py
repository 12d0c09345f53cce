"""Removes cells of open doors that block what slides out behind them.

A drawer in a fridge slides out past the open door. Door bins, or the edge at the hinge, may have been sampled
so deep that they block it then. Such cells are removed, except in the front layer of the door's panel.
"""

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from artigen.types import FULL_TURN
from artigen.voxels.cleanup.panel import find_panel
from artigen.voxels.cleanup.rows import Owners, note_changes
from artigen.voxels.fields import ROW, name_joints, name_rows

SLACK = 0.25
"""Cells of overlap with an open door that a drawer tolerates on each side."""
BESIDE = 1 / 64
"""Unit-cube lengths by which a part beside a door may reach behind it."""


def clear_doorways(owners: Owners, rows: Float[np.ndarray, "N C"]) -> tuple[Owners, tuple[str, ...]]:
    """Removes cells of open doors before drawers and trays behind them; returns owners and a note."""
    before, owners = owners, owners.copy()
    labels, kinds, boxes = np.array(name_rows(rows)), np.array(name_joints(rows)), rows[:, ROW.box]
    for door in np.flatnonzero((labels == "door") & (kinds == "revolute")):
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
        opened = _open(cells, rows[door], len(owners))
        blocking = np.zeros(len(cells), dtype=bool)
        for row in behind:
            there = np.argwhere(owners == row)
            low, high = there.min(axis=0) + SLACK, there.max(axis=0) + 1 - SLACK
            blocking |= ((opened > low - 0.5) & (opened < high + 0.5))[:, 1:].all(axis=1) & (
                opened[:, 0] < high[0]
            )
        owners[tuple(cells[blocking].T)] = -1
    what = "cells on the inside of doors were removed that would stand before a drawer when open"
    return note_changes(before, owners, what)


def _is_behind(inner: Float[np.ndarray, "6"], door: Float[np.ndarray, "6"]) -> bool:
    """Whether a part lies behind a door, alone or as one of a pair."""
    apart = np.abs(inner[1:3] - door[1:3])
    shared = (inner[4] + door[4]) / 2 - apart[0]
    return bool(shared > BESIDE and apart[1] <= door[5] / 2 and inner[0] > door[0])


def _open(cells: np.ndarray, row: Float[np.ndarray, "C"], resolution: int) -> Float[np.ndarray, "K 3"]:
    """Centres of a door's cells when it is fully open, in cells."""
    origin = (row[ROW.origin] + 0.5) * resolution
    turn = row[ROW.range.start] * FULL_TURN
    rotation = Rotation.from_rotvec(turn * row[ROW.axis])
    return rotation.apply(cells + 0.5 - origin) + origin
