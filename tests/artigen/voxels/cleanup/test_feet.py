"""Feet: what stands stays, what would fall over gets feet under its corners."""

import numpy as np
import pytest
from cupboard import EDGE, row

from artigen.voxels.cleanup.feet import MARGIN, extend_feet, measure_stand

ROWS = row("base", (slice(4, 28), slice(4, 28), slice(2, 28)))[None]
LEGS = [(x, y) for x in (4, 26) for y in (4, 26)]


def make_stool(heights: list[int]) -> np.ndarray:
    """A block on four legs, each of which ends so many cells above the floor."""
    owners = np.full((EDGE,) * 3, -1)
    owners[4:28, 4:28, 8:28] = 0
    for (x, y), height in zip(LEGS, heights, strict=True):
        owners[x : x + 2, y : y + 2, 2 + height : 8] = 0
    return owners


def stand(owners: np.ndarray) -> float:
    return measure_stand(np.argwhere(owners >= 0))


@pytest.mark.parametrize("heights", [[0, 0, 0, 0], [0, 1, 2, 0]])
def test_what_stands_stays(heights: list[int]):
    stool = make_stool(heights)
    made, notes = extend_feet(stool, ROWS)
    assert (made == stool).all()
    assert notes == ()


@pytest.mark.parametrize("heights", [[0, 0, 0, 6], [0, 0, 4, 4], [0, 6, 6, 6]])
def test_what_would_fall_over_stands_on_four_feet(heights: list[int]):
    stool, whole = make_stool(heights), make_stool([0, 0, 0, 0])
    assert stand(stool) < MARGIN
    made, notes = extend_feet(stool, ROWS)
    assert (made == whole).all()
    short = sum(height > 0 for height in heights)
    assert notes == (f"{short} feet were added or made longer, by {max(heights)} cells at most",)


def test_a_body_without_an_underside_near_the_floor_is_left_as_it_is():
    lamp = np.full((EDGE,) * 3, -1)
    lamp[4:6, 4:6, 2:20] = 0
    lamp[4:28, 4:28, 20:28] = 0
    made, notes = extend_feet(lamp, ROWS)
    assert (made == lamp).all()
    assert notes == ()
