"""What a link encloses is not seen, unless there is a hole in the wall around it."""

import numpy as np
import pytest
from triangle_box import box

from sim_export.geometry.islands import visual_islands


def holed_square(low: float, high: float) -> np.ndarray:
    """Triangles of a unit square at z = 1 with a square hole between these coordinates."""
    ticks = [0.0, low, high, 1.0]
    cells = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    quads = np.array(
        [[(ticks[i + a], ticks[j + b], 1.0) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))] for i, j in cells]
    )
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


@pytest.mark.parametrize(("cells", "seen"), [(64.5, 1), (64.0, 0)])
def test_a_piece_is_seen_through_a_hole_at_the_middle_of_a_cell_of_which_there_are_128(
    cells: float, seen: int
):
    """In a box with edges of 1 m; the hole is as wide as a quarter of a cell."""
    walls = box((0, 0, 0), (1, 1, 1))
    walls = walls[walls[:, :, 2].min(axis=1) < 1.0]
    middle, half = cells / 128, 0.125 / 128
    piece = box((0.4, 0.4, 0.4), (0.6, 0.6, 0.6))
    surface = np.concatenate([walls, holed_square(middle - half, middle + half), piece])
    assert len(visual_islands(surface, 0.005)) == seen


@pytest.mark.parametrize(
    ("low", "high", "floor", "apart"),
    [(0.0, 0.6, 0.0, 0), (0.0, 0.4, 0.0, 1), (0.1, 0.9, 0.0, 1), (0.0, 0.6, -np.inf, 1)],
)
def test_a_post_that_stands_on_the_floor_holds_itself(low: float, high: float, floor: float, apart: int):
    surface = np.concatenate([box((0, 0, 0), (0.1, 0.1, 1)), box((0.5, 0, low), (0.6, 0.1, high))])
    assert len(visual_islands(surface, 0.005, floor)) == apart
