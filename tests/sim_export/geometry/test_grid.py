"""What can be reached from outside is exposed, on the side from which it can."""

import numpy as np
import pytest
from triangle_box import box

from sim_export.geometry.grid import find_outside, is_exposed, make_grid, mark_surface


@pytest.mark.parametrize(("lid", "inner"), [(True, False), (False, True)])
def test_the_inside_of_a_box_is_exposed_without_its_lid_only(lid, inner):
    walls = box((0, 0, 0), (1, 1, 1))
    walls = walls if lid else walls[(walls[..., 2] < 1.0).any(axis=1)]
    grid = make_grid(np.array([[-0.01, -0.01, -0.01], [1.02, 1.02, 1.02]]), 64)
    outside = find_outside(mark_surface(walls, grid))
    point, up = np.array([[0.5, 0.5, 0.0]]), np.array([[0.0, 0.0, 1.0]])
    assert is_exposed(point, -up, outside, grid)[0]
    assert is_exposed(point, up, outside, grid)[0] == inner
