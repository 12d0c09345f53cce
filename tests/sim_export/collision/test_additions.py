"""Laws of late additions: a full link stretches a hull over what is added, within the limits or not."""

import numpy as np
import pytest

from sim_export.collision import attachment
from sim_export.collision.attachment import add_hull
from sim_export.collision.hull_limits import MAX_ASPECT, hull_aspect
from sim_export.geometry.contacts import HullSet
from sim_export.geometry.hulls import box_hull
from sim_export.package import Hull

FOOT = box_hull(np.array([0.0, 0.0, -0.1]), np.array([0.009, 0.01, 0.0]))


def column(thick: float) -> Hull:
    return box_hull(np.zeros(3), np.array([thick, thick, 0.55]))


@pytest.mark.parametrize(("thick", "hulls"), [(0.01, 0), (0.02, 1)])
def test_a_hull_is_not_stretched_to_a_needle(thick: float, hulls: int, monkeypatch):
    monkeypatch.setattr(attachment, "MOST_OF_LINK", 1)
    stand = column(thick)
    made = add_hull([HullSet(hulls=(stand,))], [], 0, FOOT, stand)
    found = () if made is None else made.hulls
    assert len(found) == hulls
    assert all(hull_aspect(hull) <= MAX_ASPECT for hull in found)


def test_where_there_is_room_a_hull_of_its_own_is_added():
    stand = column(0.01)
    made = add_hull([HullSet(hulls=(stand,))], [], 0, FOOT, stand)
    assert made is not None
    assert made.hulls == (stand, FOOT)
