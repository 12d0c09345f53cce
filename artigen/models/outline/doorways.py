"""Doorways of outlines: what slides out behind a door has room to pass it when it stands open.

A door that turns about the edge of its front comes to stand in its doorway, as far as its panel is thick.
Drawers and trays behind it are narrower than the doorway, therefore; of 120 procedural objects of each
category, all are by at least two cells of panel, and a seventh of a cell.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_joints, name_rows
from artigen.models.outline.boxes import CELL, box_views
from artigen.models.outline.inside import find_doors_before

ROUNDING = 1e-6
"""Lengths that are none."""


@dataclass(frozen=True, kw_only=True)
class OutlineDoorwaysConfig:
    """How much room is enough, in unit-cube lengths."""

    panel: float = 2.0 * CELL
    """Thickness of the panel of a door that has more behind it, such as bins."""
    upright: float = 0.9
    """Share of an axis that is vertical, at least: doors that fall open stand in no one's way."""
    least: float = 4.0 * CELL
    """Width that is left of what slides."""


def free_doorways(
    rows: Float[np.ndarray, "N C"],
    cfg: OutlineDoorwaysConfig | None = None,
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> str:
    """Narrows what slides out behind hinged doors at their hinges, in place, and says what was done.

    Args:
        rows: the channels after occupancy, one row per part.
        cfg: tolerances.
        layout: channels.
    """
    cfg = cfg or OutlineDoorwaysConfig()
    center, size = box_views(rows, layout)
    names, kinds = np.array(name_rows(rows, layout)), np.array(name_joints(rows, layout))
    axes, origins = rows[:, after_occupancy(layout.axis)], rows[:, after_occupancy(layout.origin)]
    turns = np.abs(rows[:, layout.range.start - 1]) * layout.rotation_unit
    upright = np.abs(axes[:, 2]) >= cfg.upright
    doors = np.flatnonzero((names == "door") & (kinds == "revolute") & upright)
    moved = []
    for row in np.flatnonzero(np.isin(names, ("drawer", "tray")) & (kinds == "prismatic")):
        for door in find_doors_before(int(row), doors, center, size):
            side = np.sign(origins[door, 1] - center[door, 1])
            needed = min(cfg.panel, size[door, 0]) * np.sin(max(turns[door], np.pi / 2))
            beyond = side * (center[row, 1] - center[door, 1]) + (size[row, 1] - size[door, 1]) / 2
            over = float(beyond + needed)
            if ROUNDING < over < size[row, 1] - cfg.least:
                size[row, 1] -= over
                center[row, 1] -= side * over / 2
                moved.append(over)
    if not moved:
        return ""
    return f"outline: {len(moved)} doorways freed by {max(moved) / CELL:.1f} cells at most"
