"""Makes continuously rotating parts axisymmetric and clears their swept volume.

What turns about an axis sweeps rings. A drum drawn with a dent here and a bulge there meets the tub that it
turns in; so each ring of it becomes whole or goes, by what most of its cells say, and the body and the inside
of doors leave the rings that a part sweeps. A dial sits on its panel, not in it.
"""

import numpy as np
from jaxtyping import Bool, Float

from artigen.types import PartLabel
from artigen.voxels.cleanup.panel import find_panel
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_joints, name_rows

DRUM: PartLabel = "tray"
"""Bodies of revolution where they turn without end: drums and turntables. Paddles go."""
DIAL: PartLabel = "knob"
"""What keeps its shape and turns in its place, without end or not. A wheel is held by what it turns in."""
CENTRED = 1 / 64
"""Unit-cube lengths from the middle of a dial to its axis, at most: a lever turns about its end."""
WIDTH = 0.5
"""Half the width of a ring, in cells: what is nearer than this to a radius speaks for it."""
ROOM = 0.75
"""Cells that stay free around what turns: convex hulls of the body round off what is hollow."""
ALIKE = 0.8
"""Share of the greatest radius from which layers count as of one."""
AROUND = 1.5
"""Cells around a dial in which its panel shows."""


def revolve_parts(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which what turns without end is round and does not meet the body, and a note of the change.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    before, owners, labels = owners, owners.copy(), np.array(name_rows(rows, layout))
    base = labels == "base"
    for number in np.flatnonzero(_find_turning(rows, labels, layout)):
        mine = owners == number
        if not mine.any():
            continue
        along = int(np.abs(rows[number, after_occupancy(layout.axis)]).argmax())
        radii = _radii(owners.shape, rows[number, after_occupancy(layout.origin)], along)
        if labels[number] == DRUM:
            whole = _make_round(mine, radii, along)
            free = (owners < 0) | base[owners]
            owners[mine & ~whole] = -1
            owners[whole & free] = number
        else:
            _lift_off_panel(owners, number, base, radii, along)
        swept = _find_swept(owners == number, radii, along) & (owners >= 0)
        owners[swept & base[owners]] = -1
        if labels[number] == DRUM:
            _clear_doors(owners, labels, swept)
        else:
            _part_dials(owners, number, labels == DIAL, swept)
    changed = int((owners != before).sum())
    if not changed:
        return owners, ()
    return owners, (f"{changed} cells were changed so that parts turn freely",)


def _find_turning(rows: np.ndarray, labels: np.ndarray, layout: FieldLayout) -> Bool[np.ndarray, "N"]:
    """Drums that turn without end, and dials that turn about their middle."""
    kinds = np.array(name_joints(rows, layout))
    off = rows[:, after_occupancy(layout.origin)] - rows[:, after_occupancy(layout.box)][:, :3]
    across = np.where(np.abs(rows[:, after_occupancy(layout.axis)]) < 0.5, np.abs(off), 0.0).max(axis=1)
    dials = (labels == DIAL) & np.isin(kinds, ("continuous", "revolute")) & (across <= CENTRED)
    return dials | ((labels == DRUM) & (kinds == "continuous"))


def _clear_doors(owners: Owners, labels: np.ndarray, swept: Bool[np.ndarray, "X Y Z"]) -> None:
    """Takes what a drum or turntable sweeps from the doors before it, in place, but for their fronts."""
    for door in np.flatnonzero(labels == "door"):
        mine = owners == door
        if (mine & swept).any():
            behind = np.arange(len(owners)) > find_panel(mine).start  # doors face -x
            owners[mine & swept & behind[:, None, None]] = -1


def _part_dials(
    owners: Owners, number: np.intp, dials: Bool[np.ndarray, "N"], swept: Bool[np.ndarray, "X Y Z"]
) -> None:
    """Takes what a dial sweeps from other dials, in place, where it leaves them the greater part."""
    for other in np.flatnonzero(dials & (np.arange(len(dials)) != number)):
        met = swept & (owners == other)
        if 0 < 2 * np.count_nonzero(met) < np.count_nonzero(owners == other):
            owners[met] = -1


def _lift_off_panel(
    owners: Owners,
    number: np.intp,
    base: Bool[np.ndarray, "N"],
    radii: Float[np.ndarray, "X Y Z"],
    along: int,
) -> None:
    """Gives the layers of a dial that lie within its panel to the panel, in place, where others are left."""
    mine, panel = owners == number, (owners >= 0) & base[owners]
    sides = tuple(axis for axis in range(3) if axis != along)
    most = radii[mine].max()
    around = (radii > most) & (radii <= most + AROUND)
    held = (panel & around).sum(axis=sides) / around.sum(axis=sides)
    within = (held >= 0.5) & mine.any(axis=sides)
    if within.any() and (mine.any(axis=sides) & ~within).any():
        chosen = np.moveaxis(np.broadcast_to(within, mine.shape), 2, along)
        owners[mine & chosen] = int(np.flatnonzero(base)[0])


def _radii(shape: tuple[int, ...], origin: Float[np.ndarray, "3"], along: int) -> Float[np.ndarray, "X Y Z"]:
    """Distances of the middles of all cells from an axis, in cells."""
    sides = [axis for axis in range(3) if axis != along]
    off = np.indices(shape) + 0.5 - ((np.asarray(origin) + 0.5) * shape[0])[:, None, None, None]
    return np.hypot(off[sides[0]], off[sides[1]])


def _make_round(
    mine: Bool[np.ndarray, "X Y Z"], radii: Float[np.ndarray, "X Y Z"], along: int
) -> Bool[np.ndarray, "X Y Z"]:
    """In every layer, the rings of which a part holds the greater share."""
    layers, ring = np.moveaxis(mine, along, 0), np.moveaxis(radii, along, 0)[0]
    out = np.zeros_like(layers)
    order = np.argsort(ring, axis=None)
    sorted_radii = ring.ravel()[order]
    first = np.searchsorted(sorted_radii, sorted_radii - WIDTH, side="left")
    last = np.searchsorted(sorted_radii, sorted_radii + WIDTH, side="right")
    for layer in np.flatnonzero(layers.any(axis=(1, 2))):
        sums = np.concatenate([[0], np.cumsum(layers[layer].ravel()[order])])
        flat = np.zeros(ring.size, dtype=bool)
        flat[order] = 2 * (sums[last] - sums[first]) >= last - first
        out[layer] = flat.reshape(ring.shape)
    return np.moveaxis(out, 0, along)


def _find_swept(
    mine: Bool[np.ndarray, "X Y Z"], radii: Float[np.ndarray, "X Y Z"], along: int
) -> Bool[np.ndarray, "X Y Z"]:
    """In every layer, all from the least to the greatest distance of a part's cells from its axis, and what
    stays free around. Layers of nearly one radius have one: hulls reach over many."""
    sides = tuple(axis for axis in range(3) if axis != along)
    least = np.where(mine, radii, np.inf).min(axis=sides, keepdims=True)
    most = np.where(mine, radii, -np.inf).max(axis=sides, keepdims=True)
    most = np.where(most >= ALIKE * most.max(), most.max(), most)
    return (radii >= least) & (radii <= most + ROOM)
