"""Vessels are round, and their walls thin."""

import numpy as np
import pytest

from envs.rooms.things import THINGS, thing_hulls, thing_solids

BOWL = (0.16, 0.16, 0.06)


def test_a_bowl_has_walls_and_a_bottom_of_five_millimetres():
    for solid, _ in thing_solids("bowl", BOWL):
        thickness = solid.sizes[1] if solid.kind == "cylinder" else min(solid.sizes)
        assert thickness == pytest.approx(0.005)


def test_a_bowl_has_twelve_sides():
    """Which are all around, as wide as the twelfth part of its rim."""
    sides = thing_hulls("bowl", BOWL)[1:]
    middles = np.array([hull.vertices.mean(axis=0)[:2] for hull in sides])
    angles = np.sort(np.degrees(np.arctan2(*middles.T)) % 360.0)
    np.testing.assert_allclose(np.diff(angles), 30.0)
    assert len(sides) == 12


@pytest.mark.parametrize("name", ["cup", "bowl", "plate", "basket"])
def test_of_a_vessel_only_the_bottom_touches_the_ground(name: str):
    thing = next(thing for thing in THINGS if thing.name == name)
    bottom, *walls = thing_hulls(name, thing.high)
    assert bottom.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    assert min(wall.vertices[:, 2].min() for wall in walls) > 5e-4
