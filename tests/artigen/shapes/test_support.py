"""Overhang of a centre of mass beyond its support, in closed form."""

import numpy as np
import pytest

from artigen.shapes.support import measure_overhang

SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


@pytest.mark.parametrize(
    ("feet", "center", "overhang"),
    [
        (SQUARE, (0.0, 0.0), -1.0),
        (SQUARE, (0.7, 0.2), -0.3),
        (SQUARE, (1.5, 0.0), 0.5),
        (SQUARE[:2], (0.0, -1.0), 1.0),
        (SQUARE[:1], (2.0, 3.0), 5.0),
        (np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), (1.0, 0.25), 0.25),
    ],
)
def test_overhang_is_the_distance_from_the_support(feet, center, overhang):
    assert measure_overhang(feet, np.array(center)) == pytest.approx(overhang)
