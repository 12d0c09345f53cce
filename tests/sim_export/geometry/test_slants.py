"""Stairs of terraces are slanted planes if they are long, wide and gentle enough; panels between are flat."""

import numpy as np
import pytest

from sim_export.geometry.face_planes import fit_face_planes
from sim_export.geometry.slants import find_slants

UP = 1
"""The direction +x, in which the terraces look."""


def terraces(*runs: int, width: int = 8, rise: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Planes of stairs with terraces of so many cells, and mask of the top faces that are flat."""
    heights = np.repeat(4 + rise * np.arange(len(runs)), runs)
    solid = np.arange(heights.max())[:, None, None] < heights[:, None]
    solid = np.pad(np.broadcast_to(solid, (*solid.shape[:2], width)), 3)
    cells = np.argwhere(solid)
    planes = fit_face_planes(solid, np.stack([cells.min(axis=0), cells.max(axis=0) + 1.0]))
    found = find_slants(planes)
    return found.planes, found.flat[UP][planes.patch[UP] >= 0]


@pytest.mark.parametrize("length", [3, 5, 9, 20])
def test_the_slope_of_long_stairs_is_that_of_their_steps(length: int):
    planes, _ = terraces(*[length] * 8)
    assert planes.shape == (1, 3)
    assert planes[0, :2] == pytest.approx([1 / length, 0.0], abs=0.1 / length)


@pytest.mark.parametrize(
    ("runs", "width", "slants"),
    [
        ([5] * 3, 8, 1), ([5] * 2, 8, 0),  # three heights
        ([6] * 6, 1, 1), ([5] * 7, 1, 0),  # 36 cells
        ([3] * 4, 8, 1), ([2] * 6, 8, 0),  # a slope of 0.4
        ([5] * 6, 8, 1), ([5, 26, 5], 8, 0),  # most of it rises by a cell per terrace
    ],
)  # fmt: skip
def test_stairs_are_a_slant_if(runs: list[int], width: int, slants: int):
    assert len(terraces(*runs, width=width)[0]) == slants


@pytest.mark.parametrize(("wide", "flat"), [(14, 1.0), (13, 80 / 106)])
def test_a_panel_of_fourteen_cells_between_steps_is_flat(wide: int, flat: float):
    planes, top = terraces(40, wide, wide, 40, width=20)
    assert len(planes) == 0
    assert top.mean() == pytest.approx(flat)
