"""Grids of cells about the origin."""

import numpy as np


def grid(size: int = 28) -> np.ndarray:
    """Centres of the cells."""
    return np.mgrid[:size, :size, :size] + 0.5 - size / 2


def tight_box(occupancy: np.ndarray) -> np.ndarray:
    """Lowest and highest corner of what is occupied."""
    cells = np.argwhere(occupancy)
    return np.stack([cells.min(axis=0), cells.max(axis=0) + 1]).astype(float)
