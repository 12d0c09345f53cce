"""Vessels are round, and their walls thin."""

import numpy as np
import pytest

from envs.rooms.things import thing_hulls, thing_solids

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
