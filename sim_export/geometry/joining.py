"""Makes a set of cells well-composed: adds cells where two touch only along an edge or at a corner."""

import numpy as np
from jaxtyping import Bool
from scipy import ndimage

_CORNERS = [np.array(np.unravel_index(n, (2, 2, 2))) for n in range(8)]


def join_cells(
    occupancy: Bool[np.ndarray, "X Y Z"], avoid: Bool[np.ndarray, "X Y Z"]
) -> Bool[np.ndarray, "X Y Z"]:
    """Adds cells until no two cells touch only along an edge or in a corner (nor do two empty ones).

    Of the cells that would connect a pair, the one with most occupied neighbours is added, and of
    equals one outside ``avoid``; remaining ties are all added, so that the result does not depend
    on the order of axes. The outermost cells of the grid must be empty.
    """
    out = occupancy.copy()
    while True:
        wanted = _joining_cells(out, avoid)
        if not wanted.any():
            return out
        out |= wanted


def _joining_cells(occupancy: np.ndarray, avoid: np.ndarray) -> np.ndarray:
    """The cells to add in one round; all False when the grid is well-composed."""
    shape = occupancy.shape
    views = [occupancy[tuple(slice(c, n - 1 + c) for c, n in zip(corner, shape, strict=True))]
             for corner in _CORNERS]  # fmt: skip
    code = np.zeros(views[0].shape, dtype=np.uint8)
    for bit, view in enumerate(views):
        code |= view.astype(np.uint8) << np.uint8(bit)
    bad = np.argwhere(_BAD_BLOCK[code])
    wanted = np.zeros(shape, dtype=bool)
    if not len(bad):
        return wanted
    neighbours = ndimage.uniform_filter(occupancy.astype(np.float64), 3) * 54 + ~avoid
    blocks = bad[:, None] + np.array(_CORNERS)  # B 8 3
    score = np.rint(neighbours[tuple(np.moveaxis(blocks, 2, 0))])
    options = _OPTIONS[code[tuple(bad.T)]]
    score = np.where(options, score, -1)
    chosen = options & (score == score.max(axis=1, keepdims=True))
    wanted[tuple(blocks[chosen].T)] = True
    return wanted


def _block_tables() -> np.ndarray:
    """Cells that would mend each of the 256 states of a 2 x 2 x 2 block; none where it is well-composed."""
    options = np.zeros((256, 8), dtype=bool)
    for code in range(256):
        full = [bool(code >> bit & 1) for bit in range(8)]
        for one in range(8):
            for axis_bits in (3, 5, 6):  # the cell across one edge differs in two coordinates
                edge = [one ^ bit for bit in (1, 2, 4) if bit & axis_bits]
                if full[one] and full[one ^ axis_bits] and not any(full[cell] for cell in edge):
                    options[code, edge] = True
        if not options[code].any() and sum(full) in (2, 6):
            rare = [cell for cell in range(8) if full[cell] == (sum(full) == 2)]
            if rare[0] ^ rare[1] == 7:
                options[code, [cell for cell in range(8) if not full[cell]]] = True
    return options


_OPTIONS = _block_tables()
_BAD_BLOCK = _OPTIONS.sum(axis=1) > 0
