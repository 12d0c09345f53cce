"""What a make adds to the mass of an object."""

import numpy as np
import pytest

from sim_export.package import Inertial
from sim_export.physics.makes import fill_base, find_make


@pytest.mark.parametrize(("category", "hidden"), [("Lectern", 0.0), ("ChestFreezer", 6.0)])
def test_nothing_is_hidden_in_a_base_unless_its_make_says_so(category, hidden):
    drawn = Inertial(mass=2.0, com=np.zeros(3), inertia=np.eye(3))
    box = np.array([[0.0, 0.0, 0.0], [0.5, 0.5, 1.0]])
    assert fill_base(find_make(category), drawn, box).mass == pytest.approx(2.0 + hidden)
