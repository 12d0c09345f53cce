"""The slots of the vocabulary of rows: one for every field of every kind of row."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Int

from artigen.sketch.rows import FIELDS, ROW_KINDS, WIDTH


@dataclass(frozen=True, kw_only=True, eq=False)
class Slots:
    """One slot for every field of every kind of row; slot 0 is the kind itself."""

    of_cell: Int[np.ndarray, "K W"]
    """Slot of each column by kind of row, -1 for none."""
    base: Int[np.ndarray, "S"]
    """First symbol of each slot in the vocabulary; -1 for numbers."""
    size: Int[np.ndarray, "S"]
    total: int
    """Total number of symbols."""


@cache
def slots() -> Slots:
    """The slots of the vocabulary of rows."""
    of_cell = np.full((len(ROW_KINDS), WIDTH), -1)
    of_cell[:, 0] = 0
    base, size, total = [0], [len(ROW_KINDS)], len(ROW_KINDS)
    for index, kind in enumerate(ROW_KINDS):
        for at, told in enumerate(FIELDS[kind], start=1):
            of_cell[index, at] = len(base)
            base.append(total if told.size else -1)
            size.append(told.size)
            total += told.size
    return Slots(of_cell=of_cell, base=np.array(base), size=np.array(size), total=total)
