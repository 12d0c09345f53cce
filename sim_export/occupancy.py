"""A part's cells as a solid that can be meshed: shared, enclosed and ill-connected cells settled.

Three things stand between labelled surface cells and a solid. A cell that two parts touch is owned
by one of them, which leaves pits where owners alternate; a closed box is hollow; and cells that
meet only along an edge or in a corner have no manifold surface. Every cell added is counted.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool
from scipy import ndimage

from artigen.types import VoxelGrid
from sim_export.errors import DegeneratePart

_CORNERS = [np.array(np.unravel_index(n, (2, 2, 2))) for n in range(8)]


@dataclass(frozen=True, kw_only=True, eq=False)
class PartOccupancy:
    """The solid cells of one part, on the asset's whole grid.

    ``shared`` cells belong to another part in the voxel grid but lie in pits of this one;
    ``enclosed`` cells were cavities without a way out; ``joined`` cells connect cells that touched
    only along an edge or in a corner. All three are counts of added cells.
    """

    occupancy: Bool[np.ndarray, "X Y Z"]
    shared: int
    enclosed: int
    joined: int


def part_occupancy(voxels: VoxelGrid, part_id: int) -> PartOccupancy:
    """Solid cells of a part: its own ones, one-cell pits shared with others, enclosed cavities.

    The result is well-composed: its boundary is a 2-manifold. Cavities that are open, like a
    drawer's, stay open; disconnected pieces stay apart. Raises `DegeneratePart` for a part
    without cells.
    """
    mine = voxels.part_ids == part_id
    if not mine.any():
        raise DegeneratePart(f"part {part_id}: owns 0 of {len(mine)} voxels, expected at least 1")
    whole = np.zeros((2, *(voxels.resolution,) * 3), dtype=bool)
    whole[0][tuple(voxels.coords[mine].T)] = True
    whole[1][tuple(voxels.coords[~mine].T)] = True
    low = np.maximum(voxels.coords[mine].min(axis=0) - 1, 0)
    high = voxels.coords[mine].max(axis=0) + 2
    window = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    own, others = (np.pad(grid[window], 2) for grid in whole)

    shared = own | (_close_in_planes(own) & others)
    filled = _fill_cavities(shared)
    joined = join_cells(filled, others)
    solid = _fill_cavities(joined)
    inside = tuple(slice(2, -2) for _ in range(3))
    out = np.zeros(whole.shape[1:], dtype=bool)
    out[window] = solid[inside]
    return PartOccupancy(
        occupancy=out,
        shared=int(shared.sum() - own.sum()),
        enclosed=int(filled.sum() - shared.sum() + solid.sum() - joined.sum()),
        joined=int(joined.sum() - filled.sum()),
    )


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


def _close_in_planes(own: np.ndarray) -> np.ndarray:
    """Closing by 3 x 3 squares in each of the three axis planes, joined."""
    out = np.zeros_like(own)
    for normal in range(3):
        grid = own
        for axis in [a for a in range(3) if a != normal]:
            grid = grid | np.roll(grid, 1, axis) | np.roll(grid, -1, axis)
        for axis in [a for a in range(3) if a != normal]:
            grid = grid & np.roll(grid, 1, axis) & np.roll(grid, -1, axis)
        out |= grid
    return out


def _fill_cavities(grid: np.ndarray) -> np.ndarray:
    """Fills empty cells from which no way of cells sharing faces leads out."""
    return np.asarray(ndimage.binary_fill_holes(grid), dtype=bool)


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
