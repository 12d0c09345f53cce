"""Alignment of outlines: what nearly is in line is in line, and what nearly has one size has one.

Furniture repeats itself. Of procedural objects, edges of fronts that lie within a cell of each other lie at
the same place in 96 of 100 cases; a network draws each anew, half a cell off.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, name_rows
from artigen.models.outline.boxes import CELL, FRONTS, box_views
from artigen.types import PartLabel

REPEATED: tuple[tuple[PartLabel, ...], ...] = (("handle",), ("knob",), ("tray",), ("shelf",), ("wheel",))
"""Parts of which an object has several of one size, in rows and columns."""


@dataclass(frozen=True, kw_only=True)
class OutlineAlignConfig:
    """How near is in line, in unit-cube lengths."""

    faces: float = 1.25 * CELL
    """Spread of the faces of fronts that come to one place."""
    rim: float = 0.6 * CELL
    """Distance of a front's face from the body's that comes to it."""
    gap: float = 4.0 * CELL
    """What may lie between two fronts side by side for them to be widened until only a slit is left."""
    slit: float = 0.2 * CELL
    """What is then left between them."""
    level: float = 1.5 * CELL
    """Spread of the depths of fronts that are side by side: what lies behind, in a drawer behind a door, is
    in line with other things."""
    sizes: float = 0.75 * CELL
    """Spread of the edges of small parts that become equal."""
    centres: float = 0.75 * CELL
    """Spread of the centres of small parts that come to one line; distance of a handle from the middle of
    its front that comes to it."""
    lines: float = 2.25 * CELL
    """Spread of the heights of knobs of one size that come to one line: of true ones, hardly any two differ
    by so little and are not level."""


def align_outline(
    rows: Float[np.ndarray, "N C"],
    cfg: OutlineAlignConfig | None = None,
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> str:
    """Aligns the boxes of an outline in place, and says what was done.

    Fronts side by side agree in their faces and widen until they meet; the foremost agree with the body's
    faces, too. Small parts agree in their sizes and centres; a handle or knob near the middle of its front
    comes to the middle.

    Args:
        rows: the channels after occupancy, one row per part.
        cfg: tolerances.
        layout: channels.
    """
    cfg = cfg or OutlineAlignConfig()
    center, size = box_views(rows, layout)
    names = np.array(name_rows(rows, layout))
    before = np.concatenate([center - size / 2, center + size / 2], axis=1)
    fronts = np.flatnonzero(np.isin(names, FRONTS))
    low, high = center[fronts] - size[fronts] / 2, center[fronts] + size[fronts] / 2
    for number, level in enumerate(_levels(low[:, 0], cfg.level)):
        sides = (low[level], high[level])
        for faces in sides:
            for axis in range(3):
                faces[:, axis] = _agree(faces[:, axis], cfg.faces)
        for body in np.flatnonzero(names == "base") if number == 0 else ():
            for faces, sign in zip(sides, (-1.0, 1.0), strict=True):
                rim = center[body] + sign * size[body] / 2
                near = np.abs(faces - rim) <= cfg.rim
                faces[:, 1:] = np.where(near, rim, faces)[:, 1:]
        for axis, other in ((1, 2), (2, 1)):
            _close_gaps(*sides, axis, other, cfg)
        low[level], high[level] = sides
    center[fronts], size[fronts] = (low + high) / 2, high - low
    for labels in REPEATED:
        alike = np.flatnonzero(np.isin(names, labels))
        for axis in range(3):
            size[alike, axis] = _agree(size[alike, axis], cfg.sizes)
            center[alike, axis] = _agree(center[alike, axis], cfg.centres)
    _level_knobs(np.flatnonzero(names == "knob"), center, size, cfg)
    _centre_handles(np.flatnonzero(np.isin(names, ("handle", "knob"))), fronts, center, size, cfg)
    after = np.concatenate([center - size / 2, center + size / 2], axis=1)
    moved = np.abs(after - before)
    many = int((moved.max(axis=1, initial=0.0) > 0.05 * CELL).sum())
    return f"outline: {many} parts aligned, by {moved.max() / CELL:.1f} cells at most" if many else ""


def _close_gaps(low: np.ndarray, high: np.ndarray, axis: int, other: int, cfg: OutlineAlignConfig) -> None:
    """Widens neighbouring fronts along an axis, both by the same."""
    shared = np.minimum(high[:, None, other], high[None, :, other])
    shared = shared - np.maximum(low[:, None, other], low[None, :, other])
    height = high[:, other] - low[:, other]
    beside = shared >= 0.5 * np.minimum(height[:, None], height[None, :])
    gap = low[None, :, axis] - high[:, None, axis]
    for one, two in np.argwhere(beside & (gap > 1.5 * cfg.slit) & (gap <= cfg.gap)):
        middle = (high[one, axis] + low[two, axis]) / 2
        if not (beside[one] & (low[:, axis] < middle) & (high[:, axis] > middle)).any():  # nobody between
            high[one, axis], low[two, axis] = middle - cfg.slit / 2, middle + cfg.slit / 2


def _levels(depths: Float[np.ndarray, "K"], spread: float) -> Sequence[Int[np.ndarray, "G"]]:
    """Numbers of the fronts side by side, the foremost first."""
    order = np.argsort(depths)
    return [order[group] for group in _groups(depths[order], spread)] if len(depths) else []


def _agree(values: Float[np.ndarray, "K"], spread: float) -> Float[np.ndarray, "K"]:
    """Values in groups no wider than ``spread``, each at the mean of its group."""
    out = values.copy()
    order = np.argsort(values)
    for group in _groups(values[order], spread):
        out[order[group]] = values[order[group]].mean()
    return out


def _groups(ordered: Float[np.ndarray, "K"], spread: float) -> Sequence[Int[np.ndarray, "G"]]:
    """Neighbours are joined, the nearest first, while what is joined is no wider than ``spread``."""
    groups = [np.array([number]) for number in range(len(ordered))]
    while len(groups) > 1:
        widths = [ordered[b[-1]] - ordered[a[0]] for a, b in pairwise(groups)]
        nearest = int(np.argmin(widths))
        if widths[nearest] > spread:
            break
        groups[nearest : nearest + 2] = [np.concatenate(groups[nearest : nearest + 2])]
    return groups


def _level_knobs(knobs: np.ndarray, center: np.ndarray, size: np.ndarray, cfg: OutlineAlignConfig) -> None:
    """Brings knobs of one size to one height, in place."""
    if not len(knobs):
        return
    kinds = np.unique(np.round(size[knobs] / CELL, 3), axis=0, return_inverse=True)[1].ravel()
    for kind in np.unique(kinds):
        alike = knobs[kinds == kind]
        center[alike, 2] = _agree(center[alike, 2], cfg.lines)


def _centre_handles(
    handles: np.ndarray,
    fronts: np.ndarray,
    center: np.ndarray,
    size: np.ndarray,
    cfg: OutlineAlignConfig,
) -> None:
    for row in handles:
        within = (np.abs(center[fronts, 1:] - center[row, 1:]) <= size[fronts, 1:] / 2).all(axis=1)
        if not within.any():
            continue
        face = center[fronts, 0] - size[fronts, 0] / 2
        ahead = np.where(within, np.abs(face - center[row, 0] - size[row, 0] / 2), np.inf)
        front = fronts[ahead.argmin()]
        for axis in (1, 2):
            if abs(center[row, axis] - center[front, axis]) <= cfg.centres:
                center[row, axis] = center[front, axis]
