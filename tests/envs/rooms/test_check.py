"""What the check of a room takes for rounding."""

import numpy as np
import pytest
from bare_room import ROOM

from envs.rooms import check
from envs.rooms.solids import make_solid
from sim_export.geometry.hulls import box_hull


@pytest.mark.parametrize(("past", "problems"), [(0.9e-6, 0), (1.1e-6, 1)])
def test_a_thousandth_of_a_millimetre_is_rounding(past: float, problems: int):
    box = make_solid("box", [box_hull(np.array([3.0, 1.0, 0.0]), np.array([4.0 + past, 2.0, 1.0]))])
    assert len(list(check._outside(ROOM, [box]))) == problems
    beside = make_solid("beside", [box_hull(np.array([3.0 + past, 2.0, 0.0]), np.array([3.4, 3.0, 1.0]))])
    into = make_solid("into", [box_hull(np.array([3.0, 2.0 - past, 0.0]), np.array([4.0, 3.0, 1.0]))])
    assert len(list(check._overlaps([box, beside], []))) == 0
    assert len(list(check._overlaps([box, into], []))) == problems
