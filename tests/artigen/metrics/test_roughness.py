"""Roughness: closed forms of boxes, the same seen from any side, and more where cells are noisy."""

import numpy as np
import pytest
from roughness import measure_roughness


def make_box(*edges: int) -> np.ndarray:
    cells = np.zeros((20, 20, 20), dtype=bool)
    cells[tuple(slice(2, 2 + edge) for edge in edges)] = True
    return cells


@pytest.mark.parametrize(("x", "y", "z"), [(1, 1, 1), (10, 10, 10), (12, 3, 7)])
def test_a_box_bends_along_its_twelve_edges(x: int, y: int, z: int):
    found = measure_roughness(make_box(x, y, z))
    assert found == pytest.approx(4 * (x + y + z) / (2 * (x * y + y * z + z * x)))


def test_it_is_the_same_from_every_side():
    cells = np.random.default_rng(0).random((9, 9, 9)) < 0.3
    sides = [cells, cells.transpose(1, 2, 0), cells[::-1], cells[:, ::-1].transpose(2, 0, 1)]
    assert len({measure_roughness(side) for side in sides}) == 1


def test_noise_on_a_face_is_rough_and_nothing_is_smooth():
    noisy = make_box(10, 10, 10)
    noisy[12, 2:12, 2:12] = np.random.default_rng(0).random((10, 10)) < 0.5
    assert measure_roughness(noisy) > 1.5 * measure_roughness(make_box(10, 10, 10))
    assert measure_roughness(np.zeros((4, 4, 4), dtype=bool)) == 0.0
