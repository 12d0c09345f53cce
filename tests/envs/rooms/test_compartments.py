"""Floors of drawers: how level they are, and how many compartments one has."""

import pytest
from box_drawer import box_drawer

from envs.rooms.compartments import find_compartments


@pytest.mark.parametrize(("slope", "count"), [(0.9e-4, 1), (1.1e-4, 0)])
def test_a_floor_is_level_to_a_tenth_of_a_millimetre(slope: float, count: int):
    assert len(find_compartments(box_drawer(depth=0.3, slope=slope))) == count


@pytest.mark.parametrize(("parts", "found"), [(2, 2), (3, 3), (4, 3), (5, 3)])
def test_a_floor_has_up_to_three_compartments(parts: int, found: int):
    assert len(find_compartments(box_drawer(depth=0.2 * parts, dividers=parts - 1))) == found
