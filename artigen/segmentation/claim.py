"""Cells for parts that a network drew none for: a stage of its own for handles and knobs of few cells.

A push button of half a cell is easily decoded as a piece of the panel that it sits on. Where an outline says
that there is one, it claims the cells of its box, as in the truth a part smaller than a cell does.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.fields import VoxelFields
from artigen.types import PartLabel

CLAIMING: frozenset[PartLabel] = frozenset({"handle", "knob"})
"""Parts that are as good as their box; a drawer is not."""
SAME = 1e-4
"""Unit-cube lengths by which the boxes of one part may differ."""


def claim_cells(found: VoxelFields, rows: Float[np.ndarray, "N C"]) -> tuple[VoxelFields, tuple[str, ...]]:
    """Fields in which every handle and knob of an outline has a cell, and a note if one had none.

    Where nothing at all was drawn, there is nothing for them to sit on, and the fields stay empty.

    Args:
        found: cells that say the attributes of their part exactly, as they do when decoded in view of an
            outline.
        rows: that outline, the channels after occupancy, one row per part.
    """
    layout, count = found.layout, 0
    box = slice(layout.box.start - 1, layout.box.stop - 1)
    for row in rows if len(found.coords) else ():
        label = layout.labels[int(row[layout.label.start - 1 : layout.label.stop - 1].argmax())]
        if label not in CLAIMING or (np.abs(found.box - row[box]).max(axis=1) < SAME).any():
            continue
        found = _claim(found, row, _cells_of_box(row[box], found.resolution))
        count += 1
    if not count:
        return found, ()
    return found, (f"{count} handles or knobs without cells were given those of their boxes",)


def _cells_of_box(box: Float[np.ndarray, "6"], resolution: int) -> np.ndarray:
    """Cells whose centres lie in a box; where it is thinner than a cell, the one that holds its middle."""
    center, size = (box[:3] + 0.5) * resolution, box[3:] * resolution
    low, high = np.ceil(center - size / 2 - 0.5), np.floor(center + size / 2 - 0.5)
    thin = low > high
    low[thin] = high[thin] = np.floor(center[thin])
    low, high = low.clip(0, resolution - 1).astype(int), high.clip(0, resolution - 1).astype(int)
    axes = [np.arange(a, b + 1) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _claim(found: VoxelFields, row: Float[np.ndarray, "C"], cells: np.ndarray) -> VoxelFields:
    """The fields with these cells, which say what a row of an outline says, whatever they said before."""
    side, layout = found.resolution, found.layout
    taken = np.isin(_flatten(found.coords, side), _flatten(cells, side))
    coords = np.concatenate([found.coords[~taken], cells])
    order = np.argsort(_flatten(coords, side))
    said = {
        "label_probs": row[layout.label.start - 1 : layout.label.stop - 1],
        "joint_probs": row[layout.joint_type.start - 1 : layout.joint_type.stop - 1],
        "axis": row[layout.axis.start - 1 : layout.axis.stop - 1],
        "origin": row[layout.origin.start - 1 : layout.origin.stop - 1],
        "ranges": row[layout.range.start - 1 : layout.range.stop - 1]
        * (layout.rotation_unit, layout.length_unit),
        "box": row[layout.box.start - 1 : layout.box.stop - 1],
        "category_probs": row[layout.category.start - 1 : layout.category.stop - 1],
    }
    columns = {
        name: np.concatenate([getattr(found, name)[~taken], np.tile(value, (len(cells), 1))])[order]
        for name, value in said.items()
    }
    return replace(found, coords=coords[order], **columns)


def _flatten(coords: np.ndarray, side: int) -> np.ndarray:
    return coords.astype(np.int64) @ (side * side, side, 1)
