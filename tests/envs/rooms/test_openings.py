"""Openings of walls are a little larger than what hangs in them."""

import numpy as np

from envs.rooms.openings import find_openings
from envs.rooms.room import along_wall


def test_half_a_millimetre_is_around_a_window():
    size = (4.0, 5.0, 2.6)
    window = along_wall("left", size, (1.0, -0.09, 0.9), (2.0, 0.1, 1.9))
    (found,) = find_openings(window[None], "left", size)
    np.testing.assert_allclose((found.start, found.stop), (0.9995, 2.0005), atol=1e-9)
    np.testing.assert_allclose((found.bottom, found.top), (0.8995, 1.9005), atol=1e-9)
