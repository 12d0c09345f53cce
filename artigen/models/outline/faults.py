"""Faults of outlines: what no object has, told from boxes and joints before a single cell is drawn.

An outline takes a fraction of a second to draw, what is made of it half a minute to export and check. So
one with a fault is drawn again at once (`artigen.generate`). Thresholds are such that procedural objects
have none.
"""

from collections import Counter
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_joints, name_rows
from artigen.models.outline.boxes import CELL, FRONTS, box_views
from artigen.segmentation.tree import ALLOWED_PARENTS
from artigen.types import JointType, PartLabel

APART = (
    {"drawer"},
    {"tray"},
    {"handle"},
    {"knob"},
    {"shelf"},
    {"drawer", "tray"},
    {"drawer", "shelf"},
    {"shelf", "tray"},
    {"handle", "knob"},
)
"""Labels of pairs of which neither may reach into the other."""


@dataclass(frozen=True, kw_only=True)
class OutlineFaultsConfig:
    """How far off is no longer possible, in unit-cube lengths."""

    overlap: float = 1.0 * CELL
    """What two parts that lie apart may reach into each other."""
    level: float = 2.0 * CELL
    """Fronts less than this behind each other are side by side, so that neither may cover the other."""
    gap: float = 2.0 * CELL
    """What may lie between a part and the nearest that could carry it."""
    hinge: float = 0.05
    """Distance of a hinge from the edge of its door, as a share of the door's width."""


@dataclass(frozen=True, kw_only=True)
class Fault:
    """Something that cannot be: a sentence, and how far off it is in cells of a 64th of the unit cube."""

    what: str
    cells: float


@dataclass(frozen=True, kw_only=True, eq=False)
class _Boxes:
    names: tuple[str, ...]
    labels: tuple[PartLabel, ...]
    kinds: tuple[JointType, ...]
    low: Float[np.ndarray, "N 3"]
    high: Float[np.ndarray, "N 3"]
    axis: Float[np.ndarray, "N 3"]
    origin: Float[np.ndarray, "N 3"]


def find_faults(
    rows: Float[np.ndarray, "N C"],
    cfg: OutlineFaultsConfig | None = None,
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> tuple[Fault, ...]:
    """What is wrong with an outline that has been regularised; nothing, if nothing is.

    Args:
        rows: the channels after occupancy, one row per part.
        cfg: tolerances.
        layout: channels.
    """
    cfg, boxes = cfg or OutlineFaultsConfig(), _read(rows, layout)
    return (*_overlaps(boxes, cfg), *_gaps(boxes, cfg), *_hinges(boxes, cfg), *_straddles(boxes, cfg))


def _overlaps(boxes: _Boxes, cfg: OutlineFaultsConfig) -> list[Fault]:
    found = []
    for one, other in combinations(range(len(boxes.names)), 2):
        labels = {boxes.labels[one], boxes.labels[other]}
        shared = np.minimum(boxes.high[one], boxes.high[other]) - np.maximum(boxes.low[one], boxes.low[other])
        if labels in APART:
            depth = shared.min()
        elif labels <= set(FRONTS) and _side_by_side(boxes, one, other, cfg):
            depth = shared[1:].min()
        else:
            continue
        if depth > cfg.overlap:
            cells = float(depth) / CELL
            said = f"{boxes.names[one]} and {boxes.names[other]} share {cells:.1f} cells"
            found.append(Fault(what=said, cells=cells))
    return found


def _side_by_side(boxes: _Boxes, one: int, other: int, cfg: OutlineFaultsConfig) -> bool:
    """Whether two fronts are level; of sliding doors one runs behind the other."""
    slide = all(boxes.kinds[row] == "prismatic" and boxes.labels[row] == "door" for row in (one, other))
    return not slide and bool(abs(boxes.low[one, 0] - boxes.low[other, 0]) < cfg.level)


def _gaps(boxes: _Boxes, cfg: OutlineFaultsConfig) -> list[Fault]:
    found = []
    for row, label in enumerate(boxes.labels):
        allowed = ALLOWED_PARENTS.get(label, {})
        carriers = [k for k, other in enumerate(boxes.labels) if other in allowed and k != row]
        if not carriers:
            continue
        apart = np.maximum(boxes.low[row] - boxes.high[carriers], boxes.low[carriers] - boxes.high[row])
        gap = float(np.linalg.norm(apart.clip(min=0.0), axis=1).min())
        if gap > cfg.gap:
            said = f"{boxes.names[row]} is {gap / CELL:.1f} cells from all that could carry it"
            found.append(Fault(what=said, cells=gap / CELL))
    return found


def _hinges(boxes: _Boxes, cfg: OutlineFaultsConfig) -> list[Fault]:
    found = []
    for row, (label, kind) in enumerate(zip(boxes.labels, boxes.kinds, strict=True)):
        size = boxes.high[row] - boxes.low[row]
        if label != "door" or kind != "revolute" or size.min() >= 0.5 * np.sort(size)[1]:
            continue
        across = np.flatnonzero(np.abs(boxes.axis[row]) < 0.5)
        width = int(across[size[across].argmax()])
        edges = np.array([boxes.low[row, width], boxes.high[row, width]])
        off = float(np.abs(edges - boxes.origin[row, width]).min())
        if off > max(cfg.hinge * size[width], size.min() / 2):
            said = f"the hinge of {boxes.names[row]} is {off / CELL:.1f} cells from its edge"
            found.append(Fault(what=said, cells=off / CELL))
    return found


def _straddles(boxes: _Boxes, cfg: OutlineFaultsConfig) -> list[Fault]:
    """What slides out behind two doors, one above the other, passes through the rail between them."""
    found = []
    labels, kinds = np.array(boxes.labels), np.array(boxes.kinds)
    doors = np.flatnonzero((labels == "door") & (kinds == "revolute"))
    for row in np.flatnonzero(np.isin(labels, ("drawer", "tray")) & (kinds == "prismatic")):
        shared = np.minimum(boxes.high[row], boxes.high[doors]) - np.maximum(boxes.low[row], boxes.low[doors])
        behind = boxes.low[row, 0] - boxes.low[doors, 0] > cfg.overlap
        covering = doors[behind & (shared[:, 1:] > cfg.overlap).all(axis=1)]
        heights = sorted((float(boxes.low[door, 2]), float(boxes.high[door, 2])) for door in covering)
        if len(heights) > 1 and heights[-1][0] > heights[0][1] - cfg.overlap:
            inside = min(boxes.high[row, 2] - heights[-1][0], heights[0][1] - boxes.low[row, 2])
            cells = float(inside) / CELL
            found.append(
                Fault(what=f"{boxes.names[row]} lies {cells:.1f} cells behind a second door", cells=cells)
            )
    return found


def _read(rows: np.ndarray, layout: FieldLayout) -> _Boxes:
    labels = name_rows(rows, layout)
    before: Counter[str] = Counter()
    names = []
    for label in labels:
        names.append(f"{label}_{before[label]}")
        before[label] += 1
    center, size = box_views(rows, layout)
    return _Boxes(
        names=tuple(names),
        labels=labels,
        kinds=name_joints(rows, layout),
        low=center - size / 2,
        high=center + size / 2,
        axis=rows[:, after_occupancy(layout.axis)],
        origin=rows[:, after_occupancy(layout.origin)],
    )
