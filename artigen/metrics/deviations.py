"""Standard deviations of cell attributes within a part: the rows of the paper's Table 4."""

import numpy as np
from jaxtyping import Float, Int


def part_deviations(
    values: Float[np.ndarray, "N C"], part_ids: Int[np.ndarray, "N"]
) -> tuple[Int[np.ndarray, "P"], Float[np.ndarray, "P C"]]:
    """Population standard deviation of every channel over the cells of each part.

    Args:
        values: What each cell says, in any units.
        part_ids: The part that owns the cell; any integers.

    Returns:
        The parts that own a cell, and their deviations; zero where all cells agree, or there is one.
    """
    ids, at = np.unique(part_ids, return_inverse=True)
    counts = np.bincount(at)[:, None]
    means = _sums(values, at) / counts
    return ids, np.sqrt(_sums((values - means[at]) ** 2, at) / counts)


def _sums(values: Float[np.ndarray, "N C"], at: Int[np.ndarray, "N"]) -> Float[np.ndarray, "P C"]:
    return np.stack([np.bincount(at, weights=column) for column in values.T.astype(np.float64)], axis=1)
