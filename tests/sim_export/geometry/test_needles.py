"""Flips of needles: a flat surface keeps its points, area and edges between regions."""

import numpy as np
import pytest

from sim_export.geometry.needles import flip_needles
from sim_export.geometry.triangles import area_normals, find_slivers

STRIP = np.array(
    [(0.0, 0.0, 0.0), (0.05, 0.0, 0.0), (0.85, 0.0, 0.0), (0.85, 0.0007, 0.0), (0.0, 0.0007, 0.0)]
)
"""The round of a long edge with a corner near one end, whose triangles meet in the far one."""
SOLID = np.vstack([STRIP, [(0.4, 0.0003, -0.5)]])
TOP, RIM = [(0, 1, 3), (1, 2, 3), (0, 3, 4)], [0, 1, 2, 3, 4]
FACES = np.array([*TOP, *((b, a, 5) for a, b in zip(RIM, [*RIM[1:], 0], strict=True))])


def test_flips_remove_needles_and_keep_points_area_and_regions():
    assert find_slivers(SOLID[FACES], 1e-4)[:3].tolist() == [True, False, False]
    flipped = flip_needles(SOLID, FACES, np.zeros(len(FACES), dtype=np.int64))
    doubled = area_normals(SOLID[flipped])[:3, 2]
    assert not find_slivers(SOLID[flipped[:3]], 5e-4).any()
    assert (doubled > 0).all()
    assert doubled.sum() == pytest.approx(2 * 0.85 * 0.0007)
    assert np.array_equal(flip_needles(SOLID, FACES, np.arange(len(FACES))), FACES)


def test_flips_bend_and_pinch_nothing():
    """A corner a tenth of a millimetre above the strip; the edge that a flip would make is there."""
    bent = SOLID.copy()
    bent[4, 2] = 1e-4
    assert np.array_equal(flip_needles(bent, FACES, np.zeros(len(FACES), dtype=np.int64)), FACES)
    sheet = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-5, 0.0], [0.5, -1.0, 0.0]])
    sides = np.array([[0, 1, 2], [1, 0, 3], [1, 3, 2], [3, 0, 2]])
    assert np.array_equal(flip_needles(sheet, sides, np.zeros(4, dtype=np.int64)), sides)
