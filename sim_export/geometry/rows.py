"""Rows of arrays: their numbers, their connections, and which are all true; faster than numpy with axes."""

import numpy as np
from jaxtyping import Bool, Int

_MOST = 2**62
"""Keys are smaller than this, to fit into 64 bits."""


def number_rows(rows: Int[np.ndarray, "N K"]) -> tuple[Int[np.ndarray, "M"], Int[np.ndarray, "N"]]:
    """First place of every distinct row, in lexicographic order, and the number of each row in that order."""
    if not len(rows):
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    key, size = np.zeros(len(rows), dtype=np.int64), 1
    for column in rows.astype(np.int64).T:
        digit = column - column.min()
        base = int(digit.max()) + 1
        if size * base >= _MOST:
            key = np.unique(key, return_inverse=True)[1]
            digit = np.unique(digit, return_inverse=True)[1]
            size, base = int(key.max()) + 1, int(digit.max()) + 1
        key, size = key * base + digit, size * base
    _, first, slot = np.unique(key, return_index=True, return_inverse=True)
    return first, slot


def connect_rows(pairs: Int[np.ndarray, "2 P"], count: int) -> Int[np.ndarray, "N"]:
    """Number of the connected component of each of ``count`` rows, of which ``pairs`` are joined."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    graph = coo_matrix((np.ones(len(pairs[0]), dtype=bool), tuple(pairs)), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def all_three(marks: Bool[np.ndarray, "N 3"]) -> Bool[np.ndarray, "N"]:
    """Rows whose three entries are all true."""
    return marks[:, 0] & marks[:, 1] & marks[:, 2]
