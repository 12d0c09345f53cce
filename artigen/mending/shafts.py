"""Handles and knobs drawn a few cells off what carries them reach it: a stage of its own.

A knob in front of a panel that was drawn a cell too deep floats, and no tree holds it. It gets a shaft: its
own cells go on, straight, until they meet a part that may carry it.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, name_rows
from artigen.mending.rows import Owners
from artigen.segmentation.tree import ALLOWED_PARENTS
from artigen.types import PartLabel

REACHING: frozenset[PartLabel] = frozenset({"handle", "knob"})
"""Parts that may stand on a shaft."""
LONGEST = 5
"""Cells of a shaft; what is farther away belongs somewhere else."""
DIRECTIONS = ((0, 1), (2, -1), (2, 1), (1, -1), (1, 1), (0, -1))
"""Axis and sign, the likeliest first: to the back, down, up, to the sides."""


def extend_shafts(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which handles and knobs touch what may carry them, where it is near, and a note of how many.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    owners, labels = owners.copy(), name_rows(rows, layout)
    lengths = []
    for number, label in enumerate(labels):
        own = owners == number
        if label not in REACHING or not own.any():
            continue
        carriers = np.isin(owners, [k for k, other in enumerate(labels) if other in ALLOWED_PARENTS[label]])
        around = np.asarray(ndimage.binary_dilation(own, np.ones((3, 3, 3))), dtype=bool)
        if (around & carriers & ~own).any():
            continue
        cells = np.argwhere(own)
        shafts = [_find_shaft(cells, carriers, owners, axis, sign) for axis, sign in DIRECTIONS]
        reaching = [shaft for shaft in shafts if len(shaft)]
        if reaching:
            shaft = min(reaching, key=lambda shaft: shaft.shape[1])
            owners[tuple(shaft.reshape(-1, 3).T)] = number
            lengths.append(shaft.shape[1])
    if not lengths:
        return owners, ()
    note = (
        f"{len(lengths)} handles or knobs reach what carries them by shafts, of {max(lengths)} cells at most"
    )
    return owners, (note,)


def _find_shaft(
    cells: Int[np.ndarray, "K 3"],
    carriers: Bool[np.ndarray, "X Y Z"],
    owners: Owners,
    axis: int,
    sign: int,
) -> Int[np.ndarray, "S L 3"]:
    """Free cells between a part's and the nearest carrier's, in one direction: S rows of L, or none."""
    step = sign * np.eye(3, dtype=int)[axis]
    for length in range(1, LONGEST + 1):
        inside = ((cells + (length + 1) * step >= 0) & (cells + (length + 1) * step < len(owners))).all(
            axis=1
        )
        cells = cells[inside]
        cells = cells[owners[tuple((cells + length * step).T)] < 0]
        met = cells[carriers[tuple((cells + (length + 1) * step).T)]]
        if len(met):
            return met[:, None] + np.arange(1, length + 1)[None, :, None] * step
    return np.empty((0, 0, 3), dtype=int)
