"""The grid of a distance field."""

import numpy as np
import pytest

from envs.maniskill.solver.field import build_field, distances
from sim_export.geometry.hulls import box_hull


def test_a_grid_has_cells_of_eight_millimetres_and_a_margin_of_twelve_centimetres():
    field = build_field((box_hull(np.zeros(3), np.full(3, 0.05)),))
    assert field.cell == 0.008
    np.testing.assert_allclose(field.low, -0.12)
    assert distances(field, np.full((1, 3), 5.0))[0] == pytest.approx(0.12)


@pytest.mark.parametrize(("edge", "cell"), [(0.49, 0.008), (1.76, 0.02154434690031884)])
def test_larger_grids_have_eight_hundred_thousand_cells(edge, cell):
    """With its margin, the second box has an edge of 2 m."""
    assert build_field((box_hull(np.zeros(3), np.full(3, edge)),)).cell == pytest.approx(cell)


@pytest.mark.parametrize(("end", "last"), [(0.253, 0.0), (0.247, 0.1)])
def test_a_cell_is_solid_if_a_hull_ends_less_than_half_a_cell_before_its_centre(end, last):
    hull = box_hull(np.full(3, -1.0), np.array([end, 1.0, 1.0]))
    field = build_field((hull,), np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.5]]), 0.1)
    assert distances(field, np.array([[0.3, 0.2, 0.2]]))[0] == pytest.approx(last)
