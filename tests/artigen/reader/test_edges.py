"""Sides of boxes move to the edges of a picture, wherever these are near, and in all directions alike."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from artigen.reader.edges import NEAR, snap_boxes

TRUE = np.array([30.0, 20.0, 90.0, 80.0])


def panel(value: int = 200) -> np.ndarray:
    pixels = np.full((120, 140, 3), 90, np.uint8)
    x0, y0, x1, y1 = TRUE.astype(int)
    pixels[y0:y1, x0:x1] = value
    return pixels


@settings(deadline=None, max_examples=30)
@given(st.lists(st.floats(-5.0, 5.0), min_size=4, max_size=4), st.sampled_from([60, 110, 250]))
def test_near_sides_move_to_the_edges(off: list[float], value: int):
    found = snap_boxes(panel(value), TRUE[None] + np.array(off))
    np.testing.assert_allclose(found[0], TRUE, atol=1.0)


FARTHEST = 60.0 * 2 * NEAR / (1 + 2 * NEAR)
"""Distance of a side of 60 pixels that is twice the spread of the narrower box."""


@pytest.mark.parametrize(("off", "moves"), [(FARTHEST - 1.0, True), (FARTHEST + 2.0, False)])
def test_a_side_moves_by_twice_its_spread_at_most(off: float, *, moves: bool):
    found = snap_boxes(panel(), np.add(TRUE, [off, 0, 0, 0])[None])[0]
    assert bool(abs(found[0] - TRUE[0]) <= 1.0) == moves


def test_without_edges_boxes_stay():
    boxes = np.array([[10.2, 12.7, 60.1, 90.9], [-5.0, 3.0, 20.0, 119.0]])
    np.testing.assert_array_equal(snap_boxes(np.full((120, 140, 3), 77, np.uint8), boxes), boxes)


def mirror(box: np.ndarray) -> np.ndarray:
    return np.array([140 - box[2], box[1], 140 - box[0], box[3]])


def test_turned_and_mirrored_pictures_give_turned_and_mirrored_boxes():
    noisy = np.random.default_rng(0).integers(0, 60, (120, 140, 3)).astype(np.uint8) + panel() // 2
    box = np.add(TRUE, [3.0, -2.0, 4.0, 1.0])
    found = snap_boxes(noisy, box[None])[0]
    turned = snap_boxes(noisy.transpose(1, 0, 2), box[None, [1, 0, 3, 2]])[0]
    np.testing.assert_allclose(turned[[1, 0, 3, 2]], found)
    np.testing.assert_allclose(mirror(snap_boxes(noisy[:, ::-1], mirror(box)[None])[0]), found)
