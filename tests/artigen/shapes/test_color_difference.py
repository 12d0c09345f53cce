"""CIEDE2000 by the pairs that its authors published, and by its symmetry."""

import numpy as np
import pytest

from artigen.shapes.surfaces.color_difference import ciede2000, convert_to_lab

SHARMA = [
    ((50, 2.6772, -79.7751), (50, 0, -82.7485), 2.0425),
    ((50, -1.3802, -84.2814), (50, 0, -82.7485), 1.0),
    ((50, 0, 0), (50, -1, 2), 2.3669),
    ((50, 2.49, -0.001), (50, -2.49, 0.0009), 7.1792),
    ((50, 2.49, -0.001), (50, -2.49, 0.0011), 7.2195),
    ((50, -0.001, 2.49), (50, 0.0011, -2.49), 4.7461),
    ((50, 2.5, 0), (73, 25, -18), 27.1492),
    ((50, 2.5, 0), (58, 24, 15), 19.4535),
    ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
    ((22.7233, 20.0904, -46.694), (23.0331, 14.973, -42.5619), 2.0373),
    ((90.8027, -2.0831, 1.441), (91.1528, -1.6435, 0.0447), 1.4441),
    ((2.0776, 0.0795, -1.135), (0.9033, -0.0636, -0.5514), 0.9082),
]
"""Pairs of Sharma, Wu and Dalal (2005), table 1, with their differences."""


@pytest.mark.parametrize(("one", "other", "difference"), SHARMA)
def test_published_pairs(one: tuple[float, ...], other: tuple[float, ...], difference: float):
    first, last = np.array(one, dtype=np.float64), np.array(other, dtype=np.float64)
    assert ciede2000(first, last) == pytest.approx(difference, abs=1e-4)
    assert ciede2000(last, first) == pytest.approx(difference, abs=1e-4)


def test_colours_of_srgb():
    shown = convert_to_lab(np.array([(1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]))
    np.testing.assert_allclose(shown, [(100, 0, 0), (0, 0, 0), (53.24, 80.09, 67.20)], atol=0.02)
