"""Clears the path of sliding parts.

A drawer whose back was drawn a cell too wide, or a rail that hangs in front of it, keeps it shut. In every
line of cells along the way, either what of the part lies behind the obstacle goes, or the obstacle does:
whichever fewer and less certain cells speak for.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_erosion

from artigen.types import PartLabel
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_joints, name_rows

SLIDING: frozenset[PartLabel] = frozenset({"drawer", "tray"})
"""Parts that are to come out."""
OBSTACLES: frozenset[PartLabel] = frozenset({"base", "shelf"})
"""Parts that stay where they are; doors open first."""
FITTINGS: frozenset[PartLabel] = frozenset({"handle", "knob"})
"""Parts that come along with what they sit on."""
NEAR = 3 / 64
"""Unit-cube lengths between the front of a part and what sits on it, at most."""


def clear_paths(
    owners: Owners,
    logits: Float[np.ndarray, "X Y Z"],
    rows: Float[np.ndarray, "N C"],
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which what slides meets nothing that stays, and a note of how many cells went.

    Args:
        owners: a row per cell, -1 where nothing is.
        logits: of occupancy, of all cells.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    owners, labels = owners.copy(), name_rows(rows, layout)
    slides = (np.array(name_joints(rows, layout)) == "prismatic") & np.isin(labels, list(SLIDING))
    stays = np.isin(owners, np.flatnonzero(np.isin(labels, list(OBSTACLES))))
    boxes, fittings = rows[:, after_occupancy(layout.box)], np.flatnonzero(np.isin(labels, list(FITTINGS)))
    weights = np.abs(logits) + 1.0  # cells that no logit speaks for count, too
    own = blocking = 0
    for number in np.flatnonzero(slides):
        axis = rows[number, after_occupancy(layout.axis)]
        along = int(np.abs(axis).argmax())
        travel = rows[number, layout.range.start] * layout.length_unit * len(owners)
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
    """The cells that go so that a part can move by ``travel`` cells along an axis: the cheapest of all ways.

    In a line, the part keeps what lies beyond some place and the obstacle what lies before it.
    """

    def as_lines(cells: np.ndarray) -> np.ndarray:
        """Lines along the way: the last axis points where the part goes."""
        return np.swapaxes(np.flip(cells, along) if travel < 0 else cells, along, 2)

    part, other, weight = as_lines(mine), as_lines(ahead), as_lines(weights)
    places = np.arange(part.shape[2])
    first = np.where(part.any(axis=2), part.argmax(axis=2), len(places))
    last = len(places) - 1 - part[..., ::-1].argmax(axis=2)
    within = binary_erosion(part.any(axis=2))  # lines along the rim are a matter of rounding
    met = other & (places > first[..., None]) & (places <= last[..., None] + np.ceil(abs(travel)))
    met &= within[..., None]
    # Keep the part from place t on and the obstacle before it, t from 0 to the end: the part may go whole.
    kept = np.pad(np.cumsum(part * weight, axis=2), ((0, 0), (0, 0), (1, 0)))
    lost = np.pad(np.cumsum((met * weight)[..., ::-1], axis=2)[..., ::-1], ((0, 0), (0, 0), (0, 1)))
    cut = (kept + lost).argmin(axis=2)[..., None]
    gone = (part & (places < cut)) | (met & (places >= cut))
    cells = np.swapaxes(gone & met.any(axis=2, keepdims=True), 2, along)
    return np.flip(cells, along) if travel < 0 else cells
