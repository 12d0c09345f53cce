"""The floor on which a robot can stand."""

import numpy as np
import pytest

from envs.rooms.map import free_map
from envs.rooms.room import Opening, Room
from envs.rooms.solids import make_solid
from sim_export.geometry.hulls import box_hull

ROOM = Room(
    kind="office", seed=0, attempt=0, size=(4.0, 3.0, 2.6), standing_radius=0.32, fixtures=(), placements=(),
    entrance=Opening(side="front", start=1.5, width=0.9, height=2.0),
)  # fmt: skip


@pytest.mark.parametrize(("height", "free"), [(1.09, False), (1.11, True)])
def test_a_robot_drives_below_what_hangs_a_metre_and_ten_above_the_floor(height: float, free: object):
    lamp = make_solid("lamp", [box_hull(np.array([1.9, 1.4, height]), np.array([2.1, 1.6, 2.0]))])
    assert free_map(ROOM, [lamp])[40, 30] == free


def test_cells_of_the_map_are_five_centimetres():
    """And a robot's radius of free floor is around each."""
    floor = make_solid("floor", [box_hull(np.array([0.0, 0.0, -0.1]), np.array([4.0, 3.0, 0.0]))])
    found = free_map(ROOM, [floor])
    assert found.shape == (80, 60)
    assert found[6:-6, 6:-6].all()
    assert found.sum() == 68 * 48
