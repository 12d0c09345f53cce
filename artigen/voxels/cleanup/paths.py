"""Clears the path of sliding parts.

A drawer whose back was sampled a cell too wide, or a rail that hangs in front of it, keeps it shut. In every
line of cells along the travel, cells of the part behind the obstacle or cells of the obstacle are removed,
whichever are fewer and less certain.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_erosion

from artigen.types import PartLabel
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import ROW, name_joints, name_rows

SLIDING: frozenset[PartLabel] = frozenset({"drawer", "tray"})
"""Labels of parts that must slide out."""
OBSTACLES: frozenset[PartLabel] = frozenset({"base", "shelf"})
"""Labels of static parts that may block them; doors open first."""
FITTINGS: frozenset[PartLabel] = frozenset({"handle", "knob"})
"""Labels of parts that move with the part they sit on."""
NEAR = 3 / 64
"""Largest gap, in unit-cube lengths, between the front of a part and a fitting on it."""


def clear_paths(
    owners: Owners, logits: Float[np.ndarray, "X Y Z"], rows: Float[np.ndarray, "N C"]
) -> tuple[Owners, tuple[str, ...]]:
    """Removes cells that keep sliding parts from coming out; returns owners and a note of how many.

    Args:
        owners: Row of the outline per cell, -1 where empty.
        logits: Occupancy logits of all cells.
        rows: The outline: channels after occupancy, one row per part.
    """
    owners, labels = owners.copy(), name_rows(rows)
    slides = (np.array(name_joints(rows)) == "prismatic") & np.isin(labels, list(SLIDING))
    stays = np.isin(owners, np.flatnonzero(np.isin(labels, list(OBSTACLES))))
    boxes, fittings = rows[:, ROW.box], np.flatnonzero(np.isin(labels, list(FITTINGS)))
    weights = np.abs(logits) + 1.0  # cells with a logit of 0 have a cost as well
    own = blocking = 0
    for number in np.flatnonzero(slides):
        axis = rows[number, ROW.axis]
        along = int(np.abs(axis).argmax())
        travel = rows[number, ROW.range.start + 1] * len(owners)
        carried = [row for row in fittings if _carries(boxes[number], boxes[row], along)]
        mine, ahead = np.isin(owners, [number, *carried]), stays & (owners >= 0)
        gone = _find_blocked(mine, ahead, weights, along, float(axis[along] * travel))
        own, blocking = own + int((gone & mine).sum()), blocking + int((gone & ahead).sum())
        owners[gone] = -1
    if not own + blocking:
        return owners, ()
    note = f"{own} cells of sliding parts and {blocking} before them were removed, so that they come out"
    return owners, (note,)


def _carries(box: Float[np.ndarray, "6"], fitting: Float[np.ndarray, "6"], along: int) -> bool:
    """Whether a fitting sits on the front or the back of a part that slides along an axis."""
    off, sizes = np.abs(fitting[:3] - box[:3]), (box[3:] + fitting[3:]) / 2
    sides = [axis for axis in range(3) if axis != along]
    return bool((off[sides] <= box[3:][sides] / 2).all() and abs(off[along] - sizes[along]) <= NEAR)


def _find_blocked(
    mine: Bool[np.ndarray, "X Y Z"],
    ahead: Bool[np.ndarray, "X Y Z"],
    weights: Float[np.ndarray, "X Y Z"],
    along: int,
    travel: float,
) -> Bool[np.ndarray, "X Y Z"]:
    """The cheapest cells to remove so that a part can move by ``travel`` cells along an axis.

    In every line, the part keeps its cells beyond a cut and the obstacle keeps its cells before it.
    """

    def as_lines(cells: np.ndarray) -> np.ndarray:
        """Lines along the travel: the last axis points in the direction of motion."""
        return np.swapaxes(np.flip(cells, along) if travel < 0 else cells, along, 2)

    part, other, weight = as_lines(mine), as_lines(ahead), as_lines(weights)
    places = np.arange(part.shape[2])
    first = np.where(part.any(axis=2), part.argmax(axis=2), len(places))
    last = len(places) - 1 - part[..., ::-1].argmax(axis=2)
    within = binary_erosion(part.any(axis=2))  # at the rim, parts overlap by rounding
    met = other & (places > first[..., None]) & (places <= last[..., None] + np.ceil(abs(travel)))
    met &= within[..., None]
    # Keep the part from cut t on and the obstacle before it. The last cut removes all of the part.
    kept = np.pad(np.cumsum(part * weight, axis=2), ((0, 0), (0, 0), (1, 0)))
    lost = np.pad(np.cumsum((met * weight)[..., ::-1], axis=2)[..., ::-1], ((0, 0), (0, 0), (0, 1)))
    cut = (kept + lost).argmin(axis=2)[..., None]
    gone = (part & (places < cut)) | (met & (places >= cut))
    cells = np.swapaxes(gone & met.any(axis=2, keepdims=True), 2, along)
    return np.flip(cells, along) if travel < 0 else cells
