"""The share of a link that gets into another one."""

import numpy as np
import pytest

from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.overlap import swept_overlap


def box_set(low, high) -> HullSet:
    return HullSet(hulls=(box_hull(np.array(low, dtype=float), np.array(high, dtype=float)),))


@pytest.mark.parametrize(("depth", "share"), [(0.9e-4, 0.0), (1.1e-4, 0.11)])
def test_what_enters_by_more_than_a_tenth_of_a_millimetre_counts(depth: float, share: float):
    """A sheet of a millimetre, of which a tenth or so sinks into a floor."""
    sheet, floor = box_set((0, 0, 0.1), (0.1, 0.1, 0.101)), box_set((-1, -1, -1), (1, 1, 0))
    T = np.eye(4)
    T[2, 3] = -0.1 - depth
    near = signed_distances(sheet, floor, T[None], np.eye(4))
    assert swept_overlap(sheet, floor, T[None], np.eye(4), near) == pytest.approx(share, abs=0.005)
