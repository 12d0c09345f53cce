"""Makes continuously rotating parts axisymmetric and clears their swept volume.

A rotating part sweeps rings. A drum that was sampled with dents and bulges collides with its tub. Each ring
of a drum is therefore filled or removed by majority of its cells, and the body and the inside of doors are
cut back from the rings that a part sweeps. A dial sits on its panel, not in it.
"""

import numpy as np
from jaxtyping import Bool, Float

from artigen.types import PartLabel
from artigen.voxels.cleanup.panel import find_panel
from artigen.voxels.cleanup.rows import Owners, note_changes
from artigen.voxels.fields import ROW, name_joints, name_rows

DRUM: PartLabel = "tray"
"""Label of drums and turntables: solids of revolution where they rotate continuously. Paddles are removed."""
DIAL: PartLabel = "knob"
"""Label of dials, which keep their shape. Wheels are left alone: the part that they turn in holds them."""
CENTRED = 1 / 64
"""Largest distance (unit-cube length) from the centre of a dial to its axis; levers turn about their end."""
WIDTH = 0.5
"""Half the width of a ring in cells: cells this near to a radius vote for it."""
ROOM = 0.75
"""Clearance in cells around rotating parts: convex hulls of the body fill some of its concavities."""
ALIKE = 0.8
"""Share of the largest radius from which a layer counts as having that radius."""
AROUND = 1.5
"""Width in cells of the ring around a dial in which its panel is sought."""


def revolve_parts(owners: Owners, rows: Float[np.ndarray, "N C"]) -> tuple[Owners, tuple[str, ...]]:
    """Makes drums round and clears what drums and dials sweep; returns owners and a note."""
    before, owners, labels = owners, owners.copy(), np.array(name_rows(rows))
    base = labels == "base"
    for number in np.flatnonzero(_find_turning(rows, labels)):
        mine = owners == number
        if not mine.any():
            continue
        along = int(np.abs(rows[number, ROW.axis]).argmax())
        radii = _radii(owners.shape, rows[number, ROW.origin], along)
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
    return note_changes(before, owners, "cells were changed so that parts turn freely")


def _find_turning(rows: np.ndarray, labels: np.ndarray) -> Bool[np.ndarray, "N"]:
    """Mask of continuously rotating drums and of dials that turn about their centre."""
    kinds = np.array(name_joints(rows))
    off = rows[:, ROW.origin] - rows[:, ROW.box][:, :3]
    across = np.where(np.abs(rows[:, ROW.axis]) < 0.5, np.abs(off), 0.0).max(axis=1)
    dials = (labels == DIAL) & np.isin(kinds, ("continuous", "revolute")) & (across <= CENTRED)
    return dials | ((labels == DRUM) & (kinds == "continuous"))


def _clear_doors(owners: Owners, labels: np.ndarray, swept: Bool[np.ndarray, "X Y Z"]) -> None:
    """Removes cells of doors that a drum or turntable sweeps, in place, except those of their fronts."""
    for door in np.flatnonzero(labels == "door"):
        mine = owners == door
        if (mine & swept).any():
            behind = np.arange(len(owners)) > find_panel(mine).start  # doors face -x
            owners[mine & swept & behind[:, None, None]] = -1


def _part_dials(
    owners: Owners, number: np.intp, dials: Bool[np.ndarray, "N"], swept: Bool[np.ndarray, "X Y Z"]
) -> None:
    """Removes cells of other dials that a dial sweeps, in place, where more than half of each remains."""
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
    """Gives the layers of a dial that lie within its panel to the panel, in place, if other layers remain."""
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
    """Distance of every cell's centre from an axis, in cells."""
    sides = [axis for axis in range(3) if axis != along]
    off = np.indices(shape) + 0.5 - ((np.asarray(origin) + 0.5) * shape[0])[:, None, None, None]
    return np.hypot(off[sides[0]], off[sides[1]])


def _make_round(
    mine: Bool[np.ndarray, "X Y Z"], radii: Float[np.ndarray, "X Y Z"], along: int
) -> Bool[np.ndarray, "X Y Z"]:
    """The part made of whole rings about its axis: those of which it holds at least half in a layer."""
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
    """The cells that a part sweeps in every layer, with clearance around them.

    They reach from the least to the greatest distance of the layer's cells from the axis, plus `ROOM`. Layers
    of nearly the largest radius get that radius, because a hull spans several layers.
    """
    sides = tuple(axis for axis in range(3) if axis != along)
    least = np.where(mine, radii, np.inf).min(axis=sides, keepdims=True)
    most = np.where(mine, radii, -np.inf).max(axis=sides, keepdims=True)
    most = np.where(most >= ALIKE * most.max(), most.max(), most)
    return (radii >= least) & (radii <= most + ROOM)
