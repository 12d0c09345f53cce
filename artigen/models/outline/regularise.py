"""Regularising of drawn outlines, a stage of its own: what hardly differs from what is meant becomes it.

A network draws an axis a degree off the vertical, a hinge half a cell off the edge of its door,
neighbouring drawers that overlap by half a cell, and a knob a cell in front of its panel. Cells are drawn
in view of the outline, so it is put right before them. A true outline stays as it is, to two thirds of a
cell.
"""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_joints, name_rows
from artigen.models.outline.align import OutlineAlignConfig, align_outline
from artigen.models.outline.boxes import CELL, FRONTS, box_views
from artigen.models.outline.depths import OutlineDepthsConfig, order_depths
from artigen.models.outline.doorways import OutlineDoorwaysConfig, free_doorways
from artigen.models.outline.handles import OutlineHandlesConfig, find_panel, hand_out_handles, keep_within
from artigen.types import PartLabel


@dataclass(frozen=True, kw_only=True)
class OutlineRegulariseConfig:
    """How far off counts as meant."""

    align: OutlineAlignConfig = field(default_factory=OutlineAlignConfig)
    """What is in line."""
    depths: OutlineDepthsConfig = field(default_factory=OutlineDepthsConfig)
    """What lies behind what."""
    handles: OutlineHandlesConfig = field(default_factory=OutlineHandlesConfig)
    """Which front has which handle."""
    doorways: OutlineDoorwaysConfig = field(default_factory=OutlineDoorwaysConfig)
    """How much room what slides behind a door has."""
    angle: float = 25.0
    """Degrees between an axis and the principal direction that it becomes."""
    reach: float = 0.75 * CELL
    """Unit-cube lengths between an axis and the face or the centre that it is put to."""
    hinge_reach: float = 4.0 * CELL
    """The same between a hinge and the edge of its door: there is no other place for it."""
    gap: float = 2.5 * CELL
    """Unit-cube lengths between a handle or knob and its panel that are closed."""
    sunk: float = 2.5 * CELL
    """Unit-cube lengths that a handle or knob may be sunk into its panel for it to be put before it."""
    recess: float = 1.0 * CELL
    """What a handle or knob may be sunk by as it is meant: some sit in a recess."""
    overlap: float = 0.4
    """Share of the smaller of two fronts, knobs or handles that may overlap for them to be parted at the
    middle of it."""
    thinnest: float = 0.2 * CELL
    """Least edge of a box, in unit-cube lengths."""
    shortest: float = 0.1 * CELL
    """Least travel of a sliding part, in unit-cube lengths."""
    least_turn: float = 1 / 36
    """Least range of a turning part, in turns."""


def regularise_outline(
    rows: Float[np.ndarray, "N C"],
    cfg: OutlineRegulariseConfig | None = None,
    layout: FieldLayout = DEFAULT_LAYOUT,
    *,
    extents: Float[np.ndarray, "3"] | None = None,
) -> tuple[Float[np.ndarray, "N C"], tuple[str, ...]]:
    """An outline whose parts are what they nearly were, and a note for each kind of change.

    Args:
        rows: the channels after occupancy, one row per part.
        cfg: tolerances.
        layout: channels.
        extents: edges of the object that is asked for, up to a factor; None keeps the ratios drawn.
    """
    cfg, out = cfg or OutlineRegulariseConfig(), rows.copy()
    notes = [
        _clip_boxes(out, cfg, layout),
        _straighten_axes(out, cfg, layout),
        _settle_ranges(out, cfg, layout),
        align_outline(out, cfg.align, layout),
        order_depths(out, cfg.depths, layout),
        _part_neighbours(out, FRONTS, "fronts", cfg, layout),
        _part_neighbours(out, ("knob",), "knobs", cfg, layout),
        _part_neighbours(out, ("handle",), "handles", cfg, layout),
        hand_out_handles(out, cfg.handles, layout),
        _rest_on_panels(out, cfg, layout),
        _fit_extents(out, extents, layout),
        free_doorways(out, cfg.doorways, layout),
        _place_axes(out, cfg, layout),
    ]
    return out, tuple(note for note in notes if note)


def _clip_boxes(rows: np.ndarray, cfg: OutlineRegulariseConfig, layout: FieldLayout) -> str:
    """Boxes within the unit cube, and no thinner than allowed."""
    center, size = box_views(rows, layout)
    thin = size < cfg.thinnest
    size[thin] = cfg.thinnest
    low, high = (center - size / 2).clip(-0.5, 0.5), (center + size / 2).clip(-0.5, 0.5)
    moved = (np.abs(high - low - size) > 1e-6).any(axis=1) | thin.any(axis=1)
    center[:], size[:] = (low + high) / 2, np.maximum(high - low, cfg.thinnest)
    return (
        f"outline: {int(moved.sum())} boxes brought into the unit cube or to the least thickness"
        if moved.any()
        else ""
    )


def _straighten_axes(rows: np.ndarray, cfg: OutlineRegulariseConfig, layout: FieldLayout) -> str:
    axis = rows[:, after_occupancy(layout.axis)]
    fixed = np.array(name_joints(rows, layout)) == "fixed"
    axis[fixed] = 0.0
    length = np.linalg.norm(axis, axis=1)
    turned = []
    for row in np.flatnonzero(~fixed & (length > 0)):
        axis[row] /= length[row]
        main = int(np.abs(axis[row]).argmax())
        straight = np.eye(3)[main] * np.sign(axis[row, main])
        angle = float(np.degrees(np.arccos(np.clip(axis[row] @ straight, -1.0, 1.0))))
        if 0 < angle <= cfg.angle:
            axis[row] = straight
            turned.append(angle)
    if not turned:
        return ""
    return (
        f"outline: {len(turned)} axes turned to a principal direction, by {max(turned):.1f} degrees at most"
    )


def _settle_ranges(rows: np.ndarray, cfg: OutlineRegulariseConfig, layout: FieldLayout) -> str:
    """Ranges that their joints have, at least a little; fixed parts have none, wheels a full turn."""
    turn, travel = (rows[:, layout.range.start - 1 + offset] for offset in (0, 1))
    kinds = np.array(name_joints(rows, layout))
    turn[np.isin(kinds, ("fixed", "prismatic"))] = 0.0
    travel[np.isin(kinds, ("fixed", "revolute", "continuous"))] = 0.0
    turn[kinds == "continuous"] = 1.0
    slides, turns = kinds == "prismatic", np.isin(kinds, ("revolute", "screw"))
    small = (slides & (travel < cfg.shortest)) | (turns & (turn < cfg.least_turn))
    travel[slides] = travel[slides].clip(cfg.shortest)
    turn[turns] = turn[turns].clip(cfg.least_turn)
    return f"outline: {int(small.sum())} ranges raised to what can be seen" if small.any() else ""


def _part_neighbours(
    rows: np.ndarray,
    labels: tuple[PartLabel, ...],
    called: str,
    cfg: OutlineRegulariseConfig,
    layout: FieldLayout,
) -> str:
    """Fronts, or knobs, that overlap a little are parted at the middle of what they share."""
    center, size = box_views(rows, layout)
    fronts = np.flatnonzero(np.isin(name_rows(rows, layout), labels))
    parted = []
    for number, one in enumerate(fronts):
        for other in fronts[number + 1 :]:
            low = np.maximum(center[one] - size[one] / 2, center[other] - size[other] / 2)
            high = np.minimum(center[one] + size[one] / 2, center[other] + size[other] / 2)
            shared = (high - low) / np.minimum(size[one], size[other])
            if shared.min() <= 0.0 or shared[1:].min() > cfg.overlap:
                continue
            axis = 1 + int(shared[1:].argmin())  # beside or above each other, never behind
            middle = (low[axis] + high[axis]) / 2
            for part, sign in ((one, 1.0), (other, -1.0)):
                sign *= 1.0 if center[one, axis] <= center[other, axis] else -1.0
                far = center[part, axis] - sign * size[part, axis] / 2
                center[part, axis], size[part, axis] = (far + middle) / 2, abs(middle - far)
            parted.append(high[axis] - low[axis])
    if not parted:
        return ""
    return f"outline: {len(parted)} pairs of {called} parted, {max(parted) / CELL:.1f} cells at most"


def _rest_on_panels(rows: np.ndarray, cfg: OutlineRegulariseConfig, layout: FieldLayout) -> str:
    """Handles and knobs near their panel, or sunk into it, are put before it and within its edges."""
    center, size = box_views(rows, layout)
    names = np.array(name_rows(rows, layout))
    front = center[:, 0] - size[:, 0] / 2
    panels = np.flatnonzero(np.isin(names, ("door", "drawer", "tray")))
    bases = np.flatnonzero(names == "base")
    moved = []
    for row in np.flatnonzero(np.isin(names, ("handle", "knob"))):
        panel = find_panel(int(row), panels, center, size)
        carriers = bases if panel is None else np.array([panel])
        if not len(carriers):
            continue
        gaps = front[carriers] - center[row, 0] - size[row, 0] / 2
        gap = gaps[np.abs(gaps).argmin()]
        if not -cfg.sunk <= gap <= cfg.gap:
            continue
        before = np.concatenate([center[row], size[row]])
        if gap > 0 or gap < -cfg.recess:
            center[row, 0] += gap
        if panel is not None:
            keep_within(int(row), panel, center, size)
        off = np.abs(np.concatenate([center[row], size[row]]) - before).max()
        if off > 0:
            moved.append(off)
    if not moved:
        return ""
    worst = max(moved) / CELL
    return f"outline: {len(moved)} handles and knobs put to their panels, by {worst:.1f} cells at most"


def _fit_extents(rows: np.ndarray, extents: np.ndarray | None, layout: FieldLayout) -> str:
    """The object is centred and stretched to what is asked for, its longest edge to the unit cube's."""
    center, size = box_views(rows, layout)
    low, high = (center - size / 2).min(axis=0), (center + size / 2).max(axis=0)
    drawn = high - low
    wanted = drawn / drawn.max() if extents is None else np.asarray(extents) / np.max(extents)
    factor, middle = wanted / drawn, (low + high) / 2
    center[:], size[:] = (center - middle) * factor, size * factor
    origin, axis = (rows[:, after_occupancy(channels)] for channels in (layout.origin, layout.axis))
    origin[:] = (origin - middle) * factor
    rows[:, layout.range.start] *= np.where(axis.any(axis=1), np.abs(axis) @ factor, 1.0)
    worst = np.abs(factor - 1.0).max()
    return f"outline: stretched by {100 * worst:.1f} % at most to the size asked for" if worst > 1e-3 else ""


def _place_axes(rows: np.ndarray, cfg: OutlineRegulariseConfig, layout: FieldLayout) -> str:
    """Hinges to the edge of their door, axes of what turns freely to its centre, others to the box centre."""
    center, size = box_views(rows, layout)
    origin = rows[:, after_occupancy(layout.origin)]
    axis = rows[:, after_occupancy(layout.axis)]
    kinds = np.array(name_joints(rows, layout))
    names = name_rows(rows, layout)
    still = np.isin(kinds, ("fixed", "prismatic"))
    origin[still] = center[still]
    moved = []
    for row in np.flatnonzero(~still):
        flat = size[row].min() < 0.5 * np.sort(size[row])[1]
        hinged = flat and kinds[row] == "revolute" and names[row] not in ("knob", "wheel")
        sides = np.flatnonzero(np.abs(axis[row]) < 0.5)
        for across in sides:
            faces = center[row, across] + np.array([-0.5, 0.5]) * size[row, across]
            meant = faces if hinged else center[row, across : across + 1]
            nearest = meant[np.abs(meant - origin[row, across]).argmin()]
            off = abs(nearest - origin[row, across])
            is_width = names[row] == "door" and hinged and size[row, across] == size[row, sides].max()
            if 0 < off <= (cfg.hinge_reach if is_width else cfg.reach):
                origin[row, across] = nearest
                moved.append(off)
        along = np.abs(axis[row]) >= 0.5
        origin[row, along] = center[row, along]
    if not moved:
        return ""
    return f"outline: {len(moved)} axes put to an edge or a centre, {max(moved) / CELL:.1f} cells at most"
