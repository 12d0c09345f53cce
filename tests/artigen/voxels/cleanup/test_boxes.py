"""The box of a part reaches the cells that it enters by more than a thousandth."""

import numpy as np
import pytest

from artigen.voxels.cleanup.boxes import reach_box


@pytest.mark.parametrize(("into", "more"), [(0.0009, 0), (0.0011, 1)])
def test_a_box_that_enters_a_cell_by_a_thousandth_is_not_in_it(into: float, more: int):
    low, high = np.array([4.0, 6.0, 8.0]) - into, np.array([10.0, 11.0, 12.0]) + into
    box = np.concatenate([(low + high) / 2 / 32 - 0.5, (high - low) / 32])
    wanted = [slice(a - more, b + more) for a, b in ((4, 10), (6, 11), (8, 12))]
    assert list(reach_box(box, 32)) == wanted
