"""Numbering rows agrees with `numpy.unique`."""

import numpy as np
import pytest

from sim_export.geometry.rows import number_rows


@pytest.mark.parametrize("largest", [2, 1000, 2**21, 2**40])
@pytest.mark.parametrize("columns", [1, 2, 3, 4])
def test_rows_are_numbered_in_order_wherever_they_first_occur(columns, largest):
    random = np.random.default_rng(columns)
    distinct = random.integers(-largest, largest, (50, columns))
    rows = distinct[random.integers(0, len(distinct), 400)]
    _, first, slot = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    found = number_rows(rows)
    np.testing.assert_array_equal(found[0], first)
    np.testing.assert_array_equal(found[1], slot.ravel())


def test_no_rows_have_no_numbers():
    assert [len(part) for part in number_rows(np.zeros((0, 3), dtype=np.int64))] == [0, 0]
