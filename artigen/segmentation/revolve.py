"""Parts that turn without end have room to: a stage of its own for drums, turntables and dials.

What turns about an axis sweeps rings. A drum drawn with a dent here and a bulge there meets the tub that it
turns in; so each ring of it becomes whole or goes, by what most of its cells say, and the body leaves the
rings that a part sweeps. A dial sits on its panel, not in it.
"""

import numpy as np
from jaxtyping import Bool, Float

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_rows
from artigen.segmentation.rows import Owners
from artigen.types import PartLabel

TURNED: frozenset[PartLabel] = frozenset({"tray"})
"""Parts that are bodies of revolution where they turn without end: drums and turntables. Paddles go."""
CLEARED: frozenset[PartLabel] = frozenset({"tray", "knob"})
"""Parts that the body makes room for; a wheel is held by what it turns in."""
WIDTH = 0.5
"""Half the width of a ring, in cells: what is nearer than this to a radius speaks for it."""
ROOM = 0.75
"""Cells that stay free around what turns: convex hulls of the body round off what is hollow."""
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
    before, owners, labels = owners, owners.copy(), name_rows(rows, layout)
    kinds = rows[:, after_occupancy(layout.joint_type)].argmax(axis=1)
    endless = kinds == layout.joint_types.index("continuous")
    base = np.array([label == "base" for label in labels])
    for number in np.flatnonzero(endless & np.isin(labels, list(CLEARED))):
        mine = owners == number
        if not mine.any():
            continue
        along = int(np.abs(rows[number, after_occupancy(layout.axis)]).argmax())
        radii = _radii(owners.shape, rows[number, after_occupancy(layout.origin)], along)
        if labels[number] in TURNED:
            whole = _make_round(mine, radii, along)
            free = (owners < 0) | base[owners]
            owners[mine & ~whole] = -1
            owners[whole & free] = number
        else:
            _lift_off_panel(owners, number, base, radii, along)
        swept = _find_swept(owners == number, radii, along)
        owners[swept & (owners >= 0) & base[owners]] = -1
    changed = int((owners != before).sum())
    if not changed:
        return owners, ()
    return owners, (f"{changed} cells were changed so that parts turn freely",)


def _lift_off_panel(
    owners: Owners, number: int, base: Bool[np.ndarray, "N"], radii: Float[np.ndarray, "X Y Z"], along: int
) -> None:
    """Gives the layers of a dial that lie within its panel to the panel, in place, where others are left."""
    mine, panel = owners == number, (owners >= 0) & base[owners]
    sides = tuple(axis for axis in range(3) if axis != along)
    most = radii[mine].max()
    around = (radii > most) & (radii <= most + AROUND)
    held = (panel & around).sum(axis=sides) / around.sum(axis=sides)
    within = (held >= 0.5) & mine.any(axis=sides)
    if within.any() and (mine.any(axis=sides) & ~within).any():
        layers = [slice(None)] * 3
        layers[along] = np.flatnonzero(within)
        chosen = np.zeros_like(mine)
        chosen[tuple(layers)] = True
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
    """In every layer of a part, all from the least distance of its cells there from the axis to the greatest
    anywhere, and what stays free around: hulls reach over many layers."""
    sides = tuple(axis for axis in range(3) if axis != along)
    least = np.where(mine, radii, np.inf).min(axis=sides, keepdims=True)
    return (radii >= least) & (radii <= np.max(radii[mine], initial=-np.inf) + ROOM)
