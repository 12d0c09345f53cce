"""Depths of outlines: what lies behind a door does not reach into it, and doors that slide pass each other.

Thresholds are those of procedural objects: of a fridge's drawers, the front lies at least 2.5 cells behind
that of the door and, where bins make the door deep, past 0.47 of its depth; of all other objects, what is
inside starts behind the door. Of doors that slide, one runs behind the other with a sixth of a cell between.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, name_joints, name_rows
from artigen.models.outline.boxes import CELL, box_views
from artigen.models.outline.inside import INSIDE, find_doors_before


@dataclass(frozen=True, kw_only=True)
class OutlineDepthsConfig:
    """How deep is deep enough, in unit-cube lengths."""

    behind: float = 2.5 * CELL
    """Distance of the front of what lies inside from the front of a deep door, at least."""
    share: float = 0.47
    """The same as a share of the depth of the door."""
    flat: float = 1.1
    """The same for a door thinner than ``behind``: nothing reaches into it."""
    before: float = 2.0 * CELL
    """What lies inside may have been drawn so far before the front of the door."""
    least: float = 2.0 * CELL
    """Depth that is left of it."""
    slit: float = 0.2 * CELL
    """What is between doors that slide past each other."""


def order_depths(
    rows: Float[np.ndarray, "N C"],
    cfg: OutlineDepthsConfig | None = None,
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> str:
    """Orders the boxes of an outline in depth, in place, and says what was done.

    Args:
        rows: the channels after occupancy, one row per part.
        cfg: tolerances.
        layout: channels.
    """
    cfg, labels = cfg or OutlineDepthsConfig(), np.array(name_rows(rows, layout))
    kinds = np.array(name_joints(rows, layout))
    tucked = _tuck_inside(rows, labels, kinds, cfg, layout)
    parted = _part_sliding(rows, (labels == "door") & (kinds == "prismatic"), cfg, layout)
    said = [
        f"{len(moved)} {called} by {max(moved) / CELL:.1f} cells at most"
        for moved, called in (
            (tucked, "parts put behind their doors"),
            (parted, "pairs of sliding doors parted"),
        )
        if moved
    ]
    return f"outline: {'; '.join(said)}" if said else ""


def _tuck_inside(
    rows: np.ndarray, labels: np.ndarray, kinds: np.ndarray, cfg: OutlineDepthsConfig, layout: FieldLayout
) -> list[float]:
    """What lies inside starts behind its door, or behind both of a pair: its front moves, its back stays."""
    center, size = box_views(rows, layout)
    doors = np.flatnonzero((labels == "door") & (kinds == "revolute"))
    moved = []
    for row in np.flatnonzero(np.isin(labels, INSIDE)):
        for door in find_doors_before(int(row), doors, center, size):
            front, depth = center[door, 0] - size[door, 0] / 2, size[door, 0]
            needed = max(cfg.share * depth, min(cfg.flat * depth, cfg.behind))
            near, far = center[row, 0] - size[row, 0] / 2, center[row, 0] + size[row, 0] / 2
            if -cfg.before < near - front < needed and far - front > needed + cfg.least:
                moved.append(float(front + needed - near))
                near = front + needed
                center[row, 0], size[row, 0] = (near + far) / 2, far - near
    return moved


def _part_sliding(
    rows: np.ndarray, sliding: Bool[np.ndarray, "N"], cfg: OutlineDepthsConfig, layout: FieldLayout
) -> list[float]:
    """Doors that share their depth move apart, each by half of it, the nearer one to the front."""
    center, size = box_views(rows, layout)
    moved = []
    for pair in combinations(np.flatnonzero(sliding), 2):
        near, far = sorted(pair, key=lambda row: center[row, 0])
        beside = np.abs(center[near, 1:] - center[far, 1:]) - (size[near, 1:] + size[far, 1:]) / 2
        shared = center[near, 0] + size[near, 0] / 2 - center[far, 0] + size[far, 0] / 2
        if beside[1] < 0 and shared > 0:  # at one height, they meet when one opens
            by = float(shared + cfg.slit) / 2
            center[near, 0], center[far, 0] = center[near, 0] - by, center[far, 0] + by
            moved.append(by)
    return moved
