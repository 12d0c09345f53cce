"""Handles of outlines: a second one on a hinged door is meant for the front next to it that has none.

A network draws handles one by one, and now and then puts that of a drawer, or of the other door of a pair,
over the edge to a neighbour. No hinged door of a procedural object has two handles beside a bare front.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, name_joints, name_rows
from artigen.models.outline.boxes import CELL, FRONTS, box_views


@dataclass(frozen=True, kw_only=True)
class OutlineHandlesConfig:
    """What counts as next to each other, in unit-cube lengths."""

    near: float = 4.0 * CELL
    """Distance of a handle from the front that it is given to, at most."""
    level: float = 2.0 * CELL
    """Fronts less than this behind the foremost are in view, so that they are held by a handle."""


def hand_out_handles(
    rows: Float[np.ndarray, "N C"],
    cfg: OutlineHandlesConfig | None = None,
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> str:
    """Moves second handles of hinged doors to bare fronts next to them, in place, and says what was done.

    Args:
        rows: the channels after occupancy, one row per part.
        cfg: tolerances.
        layout: channels.
    """
    cfg = cfg or OutlineHandlesConfig()
    center, size = box_views(rows, layout)
    names, kinds = np.array(name_rows(rows, layout)), np.array(name_joints(rows, layout))
    face = center[:, 0] - size[:, 0] / 2
    fronts = np.flatnonzero(np.isin(names, FRONTS))
    held, knobs = (
        {int(row): find_panel(int(row), fronts, center, size) for row in np.flatnonzero(names == label)}
        for label in ("handle", "knob")
    )
    given = 0
    for bare in fronts:
        seen = list(held.values())
        if bare in (*seen, *knobs.values()) or face[bare] - face[fronts].min() >= cfg.level:
            continue
        spare = [
            (_distance(row, int(bare), center, size), row)
            for row, front in held.items()
            if front is not None
            and seen.count(front) > 1
            and (names[front], kinds[front]) == ("door", "revolute")
        ]
        gap, row = min(spare, default=(np.inf, 0))
        if gap > cfg.near:
            continue
        keep_within(row, int(bare), center, size)
        center[row, 0] = face[bare] - size[row, 0] / 2
        held[row], given = int(bare), given + 1
    return f"outline: {given} second handles of doors given to fronts that had none" if given else ""


def find_panel(row: int, panels: np.ndarray, center: np.ndarray, size: np.ndarray) -> int | None:
    """Which of the panels the middle of a handle or knob lies before, the nearest in depth; None, if before
    none."""
    within = (np.abs(center[panels, 1:] - center[row, 1:]) <= size[panels, 1:] / 2).all(axis=1)
    if not within.any():
        return None
    behind = panels[within]
    gaps = center[behind, 0] - size[behind, 0] / 2 - center[row, 0] - size[row, 0] / 2
    return int(behind[np.abs(gaps).argmin()])


def keep_within(row: int, panel: int, center: np.ndarray, size: np.ndarray) -> None:
    """Moves and shrinks a box, in place, so that from the front it reaches over no edge of a panel."""
    size[row, 1:] = np.minimum(size[row, 1:], size[panel, 1:])
    room = (size[panel, 1:] - size[row, 1:]) / 2
    center[row, 1:] = center[row, 1:].clip(center[panel, 1:] - room, center[panel, 1:] + room)


def _distance(one: int, other: int, center: np.ndarray, size: np.ndarray) -> float:
    """Between two boxes as seen from the front."""
    apart = np.abs(center[one, 1:] - center[other, 1:]) - (size[one, 1:] + size[other, 1:]) / 2
    return float(np.linalg.norm(apart.clip(min=0.0)))
